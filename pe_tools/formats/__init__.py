"""Files of other programs: meshes, labelled boxes, tables of AP."""

from .ap_fit import SATURATION as SATURATION
from .ap_fit import ApTable as ApTable
from .ap_fit import CurveFit as CurveFit
from .ap_fit import fit_ap_curve as fit_ap_curve
from .ap_fit import m_by_range as m_by_range
from .ap_fit import read_ap_table as read_ap_table
from .ap_fit import study_snippet as study_snippet
from .boxes import read_boxes as read_boxes
from .boxes import write_boxes as write_boxes
from .meshes import FoundMesh as FoundMesh
from .meshes import Mesh as Mesh
from .meshes import MeshAxes as MeshAxes
from .meshes import axes_in_text as axes_in_text
from .meshes import read_mesh as read_mesh
from .meshes import write_mesh as write_mesh
