"""Files of other programs: meshes, labelled boxes, tables of AP."""

from ..text.files import MESH_BYTES
from .ap_table import read_ap_table
from .boxes import read_boxes, write_boxes
from .meshes import FoundMesh, Mesh, MeshAxes, read_mesh, write_mesh

__all__ = [
    "MESH_BYTES",
    "FoundMesh",
    "Mesh",
    "MeshAxes",
    "read_ap_table",
    "read_boxes",
    "read_mesh",
    "write_boxes",
    "write_mesh",
]
