"""What is drawn in the 3D view: one popover in its header, beside Blender's own for overlays."""

from __future__ import annotations

from typing import Any, TypeAlias

import bpy
from bpy.types import Context, PropertyGroup

from ..language import draw_label, shown
from ..operators import reference_label
from ..properties import VIEW_ROWS
from ..view_settings import FIXED, RANGES
from .layout import is_asked, panel

UILayout: TypeAlias = bpy.types.UILayout
OverlaySettings: TypeAlias = PropertyGroup


@panel("Perception", closed=False, bl_region_type="HEADER", bl_category="", bl_ui_units_x=13)
def view(layout: UILayout, settings: PropertyGroup, _context: Context) -> None:
    """What is shown of perception: the ground, the blind ground, reach, views and beams"""
    draw_label(layout, "Perception")
    column = layout.column()
    column.active = settings.show_overlay
    view = settings.view
    for name in LAYERS:
        column.prop(view, f"show_{name}")
        if name in CHOICES:
            choices = column.column(align=True)
            choices.active = getattr(view, f"show_{name}")
            _draw_rows(_indented(choices), settings, CHOICES[name])
    row = column.row()
    row.prop(view, "show_labels")
    row.prop(view, "show_legend")
    column.prop(view, "show_inset")


def _draw_rows(
    layout: UILayout, settings: OverlaySettings, rows: tuple[tuple[str, ...], ...]
) -> None:
    """Draw rows of settings: menus without their label, and what is asked for now alone."""
    view = settings.view
    for names in rows:
        cells = layout.row(align=True)
        for name in names:
            if name == COLORS:
                _draw_colors(layout, settings)
            elif is_asked(view, VIEW_ROWS[name].when):
                kind = view.bl_rna.properties[name].type
                is_named = name in EXPANDED or kind not in ("ENUM", "STRING")
                form: dict[str, Any] = (
                    {} if is_named else {"text": ""}
                )  # no text: none on the buttons, either
                cells.prop(view, name, expand=name in EXPANDED, slider=name in SLIDERS, **form)


def _draw_colors(layout: UILayout, settings: OverlaySettings) -> None:
    """Draw the range of the ground map's colours, and the compared rig."""
    view = settings.view
    if view.ground_quantity not in RANGES:
        return
    if not view.ground_difference:
        row = layout.row(align=True)
        row.prop(view, "ground_range", text="")
        if view.ground_range == FIXED:
            for index in (0, 1):
                row.prop(view, RANGES[view.ground_quantity], index=index, text="")
        row.operator("pe.fit_colors", text="", icon="FILE_REFRESH")
        row.operator("pe.fix_colors", text="", icon="PINNED")
    row = layout.row(align=True)
    row.prop(view, "ground_difference", toggle=True)
    if view.ground_difference:
        row.menu(
            "PE_MT_live_against", text=shown(reference_label(settings.id_data)), translate=False
        )


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


LAYERS = (
    *("ground", "blind", "reach", "requirements", "mounts", "focus", "frustums"),
    *("beams", "heat", "axles", "front", "ghosts", "place"),
)
"""Layers with a switch, from the ground up."""
COLORS = "colors"
CHOICES: dict[str, tuple[tuple[str, ...], ...]] = {
    "ground": (
        ("ground_quantity",),
        ("redundancy_of", "redundancy_height"),
        ("ground_height", "ground_opacity"),
        (COLORS,),
    ),
    "blind": (("blind_height",),),
    "reach": (("reach_class",), ("reach_of",)),
    "frustums": (("footprints", "view_range"),),
    "beams": (
        ("beams_of",),
        ("channels",),
        ("channel", "every"),
        ("beam_colors",),
        ("beam_length", "beam_limit"),
        ("rings",),
    ),
}
"""Rows of settings below the switch of a layer."""
SLIDERS = {"ground_opacity"}
EXPANDED = {"ground_quantity", "blind_height", "reach_of", "beams_of", "channels"}
"""Menus whose entries are buttons beside each other."""


CLASSES = (view,)
