"""Ideas side by side: the variants of this vehicle."""

from __future__ import annotations

import bpy

from ..operators import rigs
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
        if not active:
            ghost = "GHOST_ENABLED" if item.key == settings.view.ghost_key else "GHOST_DISABLED"
            row.operator("pe.ghost_variant", text="", icon=ghost, emboss=False).key = item.key
        else:
            row.label(text="", icon="BLANK1")
        figures.label(text=f"{item.entropy:.3f}" if item.has_result else "–", translate=False)


class PE_PT_variants(Tab, bpy.types.Panel):
    """Ideas for this vehicle: save, switch, compare"""

    bl_idname = "PE_PT_variants"
    bl_label = "Variants"

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        count = len(context.scene.perception_entropy.variants)
        self.layout.label(text=str(count or ""), translate=False)  # to be seen also when closed

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.perception_entropy, self.layout
        if not settings.variants:
            layout.operator("pe.save_variant", icon="ADD")
            layout.menu(PE_MT_known_rigs.bl_idname, icon="AUTO")
            return
        draw_list(layout, settings)
        draw_state(layout, settings)
        draw_note(layout, context)


class PE_MT_known_rigs(bpy.types.Menu):
    """Rigs of well-known vehicles"""

    bl_idname = "PE_MT_known_rigs"
    bl_label = "Add Known Rig"

    def draw(self, _context: bpy.types.Context) -> None:
        for key, title in rigs():
            self.layout.operator("pe.add_rig", text=title, translate=False).key = key


def selected(settings: bpy.types.PropertyGroup) -> bpy.types.PropertyGroup:
    """Return the row of the list that is selected; the last one when the list has become short."""
    return settings.variants[min(settings.variant_index, len(settings.variants) - 1)]


def draw_note(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the note of the selected variant, to be read in full and to be changed."""
    row = selected(context.scene.perception_entropy)
    layout.prop(row, "note", text="", icon="TEXT", placeholder="Note")


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
    stands = (
        settings.variants[min(settings.variant_index, len(settings.variants) - 1)].key
        == settings.variant_key
    )
    row = layout.row(align=True)
    there = row.row(align=True)
    there.enabled = settings.variant_changed or not stands
    there.operator("pe.switch_variant", text="Revert" if stands else "Switch")
    update = row.row(align=True)
    update.enabled = settings.variant_changed
    update.operator("pe.update_variant", text="Update")
    row = layout.row(align=True)
    row.operator("pe.compare_variants", icon="MOD_ARRAY")
    row.menu(PE_MT_known_rigs.bl_idname, icon="AUTO", text="Add Rig")


CLASSES = (
    PE_MT_known_rigs,
    PE_UL_variants,
    PE_PT_variants,
)
