"""Settings of the 3D view, and of the live score."""

from typing import Any

from bpy.types import Context, PropertyGroup

from ..engine import pe
from ..view_settings import LiveSettings, ViewSettings
from .callbacks import redraw, switched
from .declared import group_of


def classes_of(_view: PropertyGroup, context: Context, _typed: str) -> list[str]:
    """Return the classes of the scene's prior; for boxes from a file, those of the road."""
    highway = context.scene.perception_entropy.prior == "highway"
    return list((pe.Prior.highway() if highway else pe.Prior.road()).class_names)


ViewFields: Any = group_of(
    ViewSettings,
    update=redraw,
    own={
        "ground_fits": {"options": {"HIDDEN"}},
        "reach_class": {"search": classes_of, "search_options": set()},
    },
)


class PE_ViewSettings(ViewFields, PropertyGroup):
    """Settings of what the 3D view draws."""


LiveFields: Any = group_of(LiveSettings, update=switched)


class PE_LiveSettings(LiveFields, PropertyGroup):
    """The live score of a scene."""
