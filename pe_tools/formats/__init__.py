"""Files of other programs: meshes, labelled boxes, tables of AP."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from .ap_fit import SATURATION, ApTable, CurveFit, fit_ap_curve, m_by_range, read_ap_table
    from .ap_fit import study_snippet
    from .boxes import read_boxes, write_boxes
    from .meshes import FoundMesh, Mesh, MeshAxes, axes_in_text, read_mesh, write_mesh
