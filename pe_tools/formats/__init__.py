"""Files of other programs: meshes, labelled boxes, tables of AP."""

from pe_core.base.files import MESH_BYTES

from .ap_by_range import m_by_range
from .ap_fit import SATURATION, ApTable, CurveFit, fit_ap_curve, read_ap_table, study_snippet
from .boxes import read_boxes, write_boxes
from .meshes import FoundMesh, Mesh, MeshAxes, axes_in_text, read_mesh, write_mesh

__all__ = [
    "MESH_BYTES",
    "SATURATION",
    "ApTable",
    "CurveFit",
    "FoundMesh",
    "Mesh",
    "MeshAxes",
    "axes_in_text",
    "fit_ap_curve",
    "m_by_range",
    "read_ap_table",
    "read_boxes",
    "read_mesh",
    "study_snippet",
    "write_boxes",
    "write_mesh",
]
