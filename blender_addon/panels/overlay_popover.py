"""What is drawn in the 3D view: one popover in its header, beside Blender's own for overlays."""

from typing import Any, TypeAlias

import bpy
from bpy.types import Context, PropertyGroup

from ..engine import graphics
from ..panel_text import draw_label
from ..properties import VIEW_ROWS
from .layout import is_asked, panel

UILayout: TypeAlias = bpy.types.UILayout
OverlaySettings: TypeAlias = PropertyGroup
COLORS = "ground_range"
ELSEWHERE = ("ground_difference", "ground_fits", "ghost_key")
"""Drawn with the colours, or set by buttons in another place."""
SLIDERS = {"ground_opacity", "wipe_at"}
EXPANDED = {"ground_quantity", "blind_height", "reach_of", "beams_of", "channels"}
"""Menus whose entries are buttons beside each other."""


@panel(
    "Perception",
    closed=False,
    simple=True,
    always=True,
    bl_region_type="HEADER",
    bl_category="",
    bl_ui_units_x=13,
)
def view(layout: UILayout, settings: PropertyGroup, _context: Context) -> None:
    """What is shown of perception: the ground, the blind ground, reach, views and beams"""
    draw_label(layout, "Perception")
    column = layout.column()
    column.active = settings.show_overlay
    view = settings.view
    choices = column
    for name, row in VIEW_ROWS.items():
        if name.startswith("show_"):
            column.prop(view, name)
            choices = _indented(column)
            choices.active = getattr(view, name)
        elif name == COLORS:
            _draw_colors(choices, settings)
        elif name not in ELSEWHERE and is_asked(view, row.when):
            # No text of a menu: none on its buttons, either.
            is_menu = view.bl_rna.properties[name].type in ("ENUM", "STRING")
            form: dict[str, Any] = {"text": ""} if is_menu and name not in EXPANDED else {}
            choices.prop(view, name, expand=name in EXPANDED, slider=name in SLIDERS, **form)


def _draw_colors(layout: UILayout, settings: OverlaySettings) -> None:
    """Draw the range of the ground map's colours, and the compared rig."""
    view = settings.view
    if view.ground_quantity == graphics.SENSORS:
        return
    if not view.ground_difference:
        row = layout.row(align=True)
        row.prop(view, "ground_range", text="")
        row.operator("pe.fit_colors", text="", icon="FILE_REFRESH")
    row = layout.row(align=True)
    row.prop(view, "ground_difference", toggle=True)
    if view.ground_difference:
        row.prop(settings.live, "reference", text="")


def _indented(layout: UILayout) -> UILayout:
    """Return a column that begins below the text of a check box."""
    row = layout.row()
    row.separator(factor=2.0)
    return row.column(align=True)


def draw_in_header(self: bpy.types.Header, context: Context) -> None:
    """Draw the switch of everything, and the button that opens the popover."""
    settings = context.scene.perception_entropy
    row = self.layout.row(align=True)
    row.prop(settings, "show_overlay", text="", icon="LIGHT_HEMI")
    part = row.row(align=True)
    part.active = settings.show_overlay
    part.popover(panel=view.__name__, text="")


CLASSES = (view,)
