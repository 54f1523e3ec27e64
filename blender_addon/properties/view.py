"""Settings of the 3D view, and of the live score."""

from __future__ import annotations

import zlib
from typing import Any

from bpy.types import Context, PropertyGroup

from ..choices import NO_ANCHOR
from ..engine import catalog, pe
from ..view_settings import LiveSettings, ViewSettings
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
        "coverage_range": {"min": 0.0, "max": 1.0},
        "reach_class": {"search": classes_of, "search_options": set()},
    },
)


class PE_ViewSettings(ViewFields, PropertyGroup):
    """Settings of what the 3D view draws."""


ANCHORS = (
    (NO_ANCHOR, "None", "No other rig's score beside the live one", 0),
    *(
        (
            key,
            rig.title,
            f"{len(rig.sensors)} sensors of {rig.vehicle}",
            1 + zlib.crc32(key.encode()) % 2**30,
        )
        for key, rig in catalog.known_rigs().items()
    ),
)
"""Of known rigs; a file holds a number that stays a rig's whatever others there are."""


LiveFields: Any = group_of(LiveSettings, update=switched)


class PE_LiveSettings(LiveFields, PropertyGroup):
    """The live score of a scene."""

    anchor: menu(
        "Known Rig",
        "A known rig, scaled to this vehicle and scored under the same prior, for "
        "comparison. It is scored once, in the background",
        ANCHORS,
        default=NO_ANCHOR,
        update=switched,
    )
