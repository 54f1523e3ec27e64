"""The scene in other programs' files, out alone: solids, footprints, glTF, recordings."""

from .exporting import export_scene, scene_files
from .request import OutputRequest
from .table import SCENE_OUTPUTS, SceneOutput, scene_output

__all__ = [
    "SCENE_OUTPUTS",
    "OutputRequest",
    "SceneOutput",
    "export_scene",
    "scene_files",
    "scene_output",
]
