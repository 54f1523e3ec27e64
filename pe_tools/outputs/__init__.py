"""Export of the scene: solids, footprints, glTF, recordings and ego masks (no import)."""

from .blind_volume import blind_volume
from .footprints import GroundFootprint, GroundPlan
from .glb import view_wires
from .output_formats import (
    FILES,
    SCENE_OUTPUTS,
    SceneOutput,
    export_scene,
    scene_files,
    scene_output,
)
from .request import BLIND, BODY, GLASS, OutputRequest, Rgb, hex_color, plain_names
from .solid import Solid, mounted_view

__all__ = [
    "BLIND",
    "BODY",
    "FILES",
    "GLASS",
    "SCENE_OUTPUTS",
    "GroundFootprint",
    "GroundPlan",
    "OutputRequest",
    "Rgb",
    "SceneOutput",
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
