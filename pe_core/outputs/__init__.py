"""The scene in other programs' files, out alone: solids, footprints, glTF, recordings."""

from .blind_volume import blind_volume
from .colors import BLIND, BODY, GLASS, Rgb, hex_color
from .exporting import export_scene, scene_files
from .footprints import GroundPlan, SeenGround
from .names import plain_names
from .request import OutputRequest
from .solid import Solid
from .table import SCENE_OUTPUTS, SceneOutput, scene_output
from .views import mounted_view
from .wires import view_wires

__all__ = [
    "BLIND",
    "BODY",
    "GLASS",
    "SCENE_OUTPUTS",
    "GroundPlan",
    "OutputRequest",
    "Rgb",
    "SceneOutput",
    "SeenGround",
    "Solid",
    "blind_volume",
    "export_scene",
    "hex_color",
    "mounted_view",
    "plain_names",
    "scene_files",
    "scene_output",
    "view_wires",
]
