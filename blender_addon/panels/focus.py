"""What counts more than the prior says, or less."""

from __future__ import annotations

import bpy

from ..choices import CUSTOM, REGIONS
from .layout import Tab, columns, draw_properties


class PE_UL_focus(bpy.types.UIList):
    """The focus weights: name, region, factor"""

    def draw_item(
        self,
        _context: bpy.types.Context,
        layout: bpy.types.UILayout,
        _settings: bpy.types.PropertyGroup,
        item: bpy.types.PropertyGroup,
        _icon: int,
        _active_data: bpy.types.PropertyGroup,
        _active_property: str,
    ) -> None:
        name, figures = columns(layout, 0.4)
        name.prop(item, "name", text="", emboss=False)
        region, factor = columns(figures, 0.61)
        region.label(text=REGIONS[item.region].short, translate=False)
        factor.alignment = "RIGHT"
        factor.label(text=f"× {item.factor:g}", translate=False)


class PE_PT_focus(Tab, bpy.types.Panel):
    """What counts more than the prior says, or less"""

    bl_idname = "PE_PT_focus"
    bl_label = "Focus"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        count = len(context.scene.perception_entropy.focus)
        self.layout.label(text=str(count or ""), translate=False)  # to be seen also when closed

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.perception_entropy, self.layout
        row = layout.row()
        row.template_list(
            PE_UL_focus.__name__, "", settings, "focus", settings, "focus_index", rows=3
        )
        buttons = row.column(align=True)
        buttons.operator("pe.add_focus", text="", icon="ADD")
        buttons.operator("pe.remove_focus", text="", icon="REMOVE")
        if settings.focus_index < len(settings.focus):
            draw_focus(layout, settings.focus[settings.focus_index])


def draw_focus(layout: bpy.types.UILayout, focus: bpy.types.PropertyGroup) -> None:
    """Draw the settings of one focus."""
    draw_properties(layout, focus, ("factor", "region"))
    if focus.region == CUSTOM:
        for name in ("x_range", "y_range"):
            low, high = getattr(focus, name)
            pair = layout.column(align=True)
            pair.alert = low >= high
            label = focus.bl_rna.properties[name].name
            pair.prop(focus, name, index=0, text=f"{label} From")
            pair.prop(focus, name, index=1, text="To")
    layout.column().prop(focus, "classes")


CLASSES = (
    PE_UL_focus,
    PE_PT_focus,
)
