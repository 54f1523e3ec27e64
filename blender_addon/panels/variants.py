"""Ideas side by side: the variants of this vehicle."""

from __future__ import annotations

import bpy

from .layout import Tab, columns


class PE_UL_variants(bpy.types.UIList):
    """Variants: which one stands in the scene, name, entropy"""

    def draw_item(
        self,
        _context: bpy.types.Context,
        layout: bpy.types.UILayout,
        settings: bpy.types.PropertyGroup,
        item: bpy.types.PropertyGroup,
        _icon: int,
        _active_data: bpy.types.PropertyGroup,
        _active_property: str,
    ) -> None:
        active = item.key == settings.variant_key
        row = layout.row(align=True)
        tick = "RADIOBUT_ON" if active else "RADIOBUT_OFF"
        row.operator("pe.switch_variant", text="", icon=tick, emboss=False).key = item.key
        name, figures = columns(row, 0.74)
        name.prop(item, "name", text="", emboss=False)
        if active and settings.variant_changed:
            name.label(text="", icon="GREASEPENCIL")
        figures.alignment = "RIGHT"
        figures.active = not item.stale
        figures.label(text=f"{item.entropy:.3f}" if item.has_result else "–", translate=False)


class PE_PT_variants(Tab, bpy.types.Panel):
    """Ideas for this vehicle: save, switch, compare"""

    bl_idname = "PE_PT_variants"
    bl_label = "Variants"
    bl_parent_id = "PE_PT_main"

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        count = len(context.scene.perception_entropy.variants)
        self.layout.label(text=str(count or ""), translate=False)  # to be seen also when closed

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.perception_entropy, self.layout
        if not settings.variants:
            layout.operator("pe.save_variant", icon="ADD")
            return
        draw_list(layout, settings)
        draw_state(layout, settings)


def draw_list(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw the list with its buttons beside it."""
    row = layout.row()
    row.template_list(
        PE_UL_variants.__name__, "", settings, "variants", settings, "variant_index", rows=4
    )
    buttons = row.column(align=True)
    buttons.operator("pe.save_variant", text="", icon="ADD")
    buttons.operator("pe.delete_variant", text="", icon="REMOVE")
    buttons.separator()
    buttons.operator("pe.duplicate_variant", text="", icon="DUPLICATE")


def draw_state(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw what can be done with what stands in the scene, always in the same place."""
    stands = settings.variants[settings.variant_index].key == settings.variant_key
    row = layout.row(align=True)
    there = row.row(align=True)
    there.enabled = settings.variant_changed or not stands
    there.operator("pe.switch_variant", text="Revert" if stands else "Switch")
    update = row.row(align=True)
    update.enabled = settings.variant_changed
    update.operator("pe.update_variant", text="Update")
    layout.operator("pe.compare_variants", icon="MOD_ARRAY")


CLASSES = (
    PE_UL_variants,
    PE_PT_variants,
)
