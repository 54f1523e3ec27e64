"""Settings of the 3D view, and of the live score."""

from typing import Any

from bpy.types import Context, PropertyGroup

from ..choices import BEFORE_MOVE
from ..engine import pe
from ..view.view_settings import LiveSettings, ViewSettings
from .callbacks import redraw, switched
from .declared import group_of
from .fields import menu


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


_references: list[tuple[str, str, str, int]] = []
"""What the menu lists: Blender reads the texts after the function that made them returned."""


def references(live: PropertyGroup, _context: Context | None) -> list[tuple[str, str, str, int]]:
    """Return what the live score may be compared with, as items of a menu: numbers are keys."""
    variants = live.id_data.perception_entropy.variants
    about = "Compare the live score with this reference"
    first = (str(BEFORE_MOVE), "Before the Last Move", about, BEFORE_MOVE)
    _references[:] = [first, *((str(row.key), row.name, about, row.key) for row in variants)]
    return _references


class PE_LiveSettings(LiveFields, PropertyGroup):
    """The live score of a scene."""

    reference: menu(
        "Compare Live With",
        "What the live score and the difference of the ground map are compared with",
        references,
        get=lambda live: live.against,
        set=lambda live, key: setattr(live, "against", key),
    )
