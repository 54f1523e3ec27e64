"""What is drawn in the 3D view: one popover in its header, beside Blender's own for overlays."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import bpy
from bpy.types import Context, PropertyGroup

from ..language import draw_label, shown
from ..operators import reference_label

UILayout: TypeAlias = bpy.types.UILayout
OverlaySettings: TypeAlias = PropertyGroup


class PE_PT_view(bpy.types.Panel):
    """What is shown of perception: the ground, the blind ground, reach, views and beams"""

    bl_idname = "PE_PT_view"
    bl_label = "Perception"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_ui_units_x = 13

    def draw(self, context: Context) -> None:
        settings = context.scene.perception_entropy
        draw_label(self.layout, "Perception")
        column = self.layout.column()
        column.active = settings.show_overlay
        view = settings.view
        for name, draw_choices in LAYERS:
            column.prop(view, f"show_{name}")
            if draw_choices is not None:
                choices = column.column(align=True)
                choices.active = getattr(view, f"show_{name}")
                draw_choices(_indented(choices), settings)
        row = column.row()
        row.prop(view, "show_labels")
        row.prop(view, "show_legend")
        column.prop(view, "show_inset")


def _ground(layout: UILayout, settings: OverlaySettings) -> None:
    view = settings.view
    layout.row(align=True).prop(view, "ground_quantity", expand=True)
    row = layout.row(align=True)
    if view.ground_quantity == "REDUNDANCY":
        row.prop(view, "redundancy_of", text="")
        row.prop(view, "redundancy_height", text="")
        layout.prop(view, "ground_opacity", text="Opacity", slider=True)
        return
    row.prop(view, "ground_height", text="")
    row.prop(view, "ground_opacity", text="Opacity", slider=True)
    if view.ground_quantity in RANGES:
        _ground_colors(layout, settings)


def _ground_colors(layout: UILayout, settings: OverlaySettings) -> None:
    """Draw the range of the colours, and the compared rig."""
    view = settings.view
    if not view.ground_difference:
        row = layout.row(align=True)
        row.prop(view, "ground_range", text="")
        if view.ground_range == "FIXED":
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


def _blind(layout: UILayout, settings: OverlaySettings) -> None:
    layout.row(align=True).prop(settings.view, "blind_height", expand=True)


def _reach(layout: UILayout, settings: OverlaySettings) -> None:
    layout.prop(settings.view, "reach_class", text="")
    layout.row(align=True).prop(settings.view, "reach_of", expand=True)


def _frustums(layout: UILayout, settings: OverlaySettings) -> None:
    row = layout.row(align=True)
    row.prop(settings.view, "footprints")
    part = row.row(align=True)
    part.active = settings.view.footprints
    part.prop(settings.view, "view_range", text="")


def _beams(layout: UILayout, settings: OverlaySettings) -> None:
    view = settings.view
    layout.row(align=True).prop(view, "beams_of", expand=True)
    layout.row(align=True).prop(view, "channels", expand=True)
    if view.channels in NUMBERED:
        layout.prop(view, NUMBERED[view.channels])
    layout.prop(view, "beam_colors", text="")
    row = layout.row(align=True)
    row.prop(settings, "beam_length", text="Length")
    row.prop(settings, "beam_limit", text="Maximum")
    layout.prop(view, "rings")


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
    part.popover(panel=PE_PT_view.bl_idname, text="")


RANGES = {"ENTROPY": "entropy_range", "COVERAGE": "coverage_range"}
"""The setting that holds a fixed range of colours."""
NUMBERED = {"ONE": "channel", "EVERY": "every"}
"""The setting that says which channels, where there is one."""

DrawChoices = Callable[[UILayout, OverlaySettings], None]
LAYERS: tuple[tuple[str, DrawChoices | None], ...] = (
    ("ground", _ground),
    ("blind", _blind),
    ("reach", _reach),
    ("requirements", None),
    ("mounts", None),
    ("focus", None),
    ("frustums", _frustums),
    ("beams", _beams),
    ("heat", None),
    ("axles", None),
    ("front", None),
    ("ghosts", None),
    ("place", None),
)
"""Switches and what there is to choose, from the ground up."""


def register() -> None:
    """Put the button into the header of 3D views."""
    bpy.types.VIEW3D_HT_header.append(draw_in_header)


def unregister() -> None:
    """Remove the button from the header."""
    bpy.types.VIEW3D_HT_header.remove(draw_in_header)


CLASSES = (PE_PT_view,)
