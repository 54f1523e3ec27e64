"""Export of the scene: solids, footprints, glTF, recordings and ego masks (no import)."""

from .blind_volume import blind_volume
from .footprints import GroundFootprint, GroundPlan, ground_plan
from .glb import view_wires
from .output_formats import (
    OF_EXAMPLE,
    SceneOutput,
    export_scene,
    output_files,
    scene_files,
    scene_output,
    scene_outputs,
)
from .request import BLIND, BODY, GLASS, OutputRequest, Rgb, hex_color, plain_names
from .solid import Solid, mounted_view

__all__ = [
    "BLIND",
    "BODY",
    "GLASS",
    "OF_EXAMPLE",
    "GroundFootprint",
    "GroundPlan",
    "OutputRequest",
    "Rgb",
    "SceneOutput",
    "Solid",
    "blind_volume",
    "export_scene",
    "ground_plan",
    "hex_color",
    "mounted_view",
    "output_files",
    "plain_names",
    "scene_files",
    "scene_output",
    "scene_outputs",
    "view_wires",
]
