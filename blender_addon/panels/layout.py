"""What all panels share: the tab they are in, and ways to lay out."""

from __future__ import annotations

import bpy


class Tab:
    """Where all panels are."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Perception"


def draw_properties(
    layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, names: tuple[str, ...]
) -> None:
    """Draw properties below each other, their names in a column of its own."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    for name in names:
        layout.prop(settings, name)


def draw_whether_stale(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw a mark above figures of a result that is not that of the scene any more."""
    if settings.result_stale:
        layout.label(text="Of the last score, before a change", icon="FILE_REFRESH")


def columns(
    layout: bpy.types.UILayout, factor: float
) -> tuple[bpy.types.UILayout, bpy.types.UILayout]:
    """Return two rows beside each other; the first takes that share of the width."""
    split = layout.split(factor=factor)
    return split.row(), split.row()
