"""Designs side by side: the variants of this vehicle, and the choice of sensors by price."""

from typing import Any

import bpy
from bpy.types import Context, Object, PropertyGroup, UILayout

from ..choices import RANDOM
from ..operators import menu_of_rigs
from ..panel_text import draw_label, is_simple
from .layout import (
    columns,
    draw_declared,
    draw_list,
    draw_properties,
    draw_sentence,
    panel,
    row_list,
)


@row_list("PE_UL_variants")
def variants_rows(_context: Context, layout: UILayout, settings: Any, item: Any) -> None:
    """Variants: which one is in the scene, name, entropy"""
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


@panel("Variants", simple=True, closed=False, count="variants")
def variants(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Designs for this vehicle: save, switch, compare"""
    if not settings.variants:
        layout.operator("pe.save_variant", icon="ADD")
        layout.menu(PE_MT_known_rigs.bl_idname, icon="AUTO")
        draw_text(layout, context)
        return
    draw_list(layout, variants_rows, settings, "variants", height=4, add="pe.save_variant")
    draw_state(layout, settings)
    if settings.view.ghost_key:
        row = layout.row(align=True)
        row.prop(settings.view, "wipe", icon="MOD_MIRROR")
        row.prop(settings.view, "wipe_at", text="", slider=True)
    if settings.live.on:
        name, menu = columns(layout, 0.4)
        draw_label(name, "Compare Live With")
        menu.prop(settings.live, "reference", text="")
    draw_text(layout, context)
    layout.prop(selected(settings), "note", text="", icon="TEXT", placeholder="Note")


def draw_text(layout: UILayout, context: Context) -> None:
    """Draw the buttons of a rig as a line of text; not in *Simple*."""
    if is_simple(context.scene):
        return
    row = layout.row(align=True)
    row.operator("pe.copy_rig", icon="COPYDOWN")
    row.operator("pe.paste_rig", icon="PASTEDOWN")


class PE_MT_known_rigs(bpy.types.Menu):
    """Templates on the vehicle's named places, and rigs of well-known vehicles"""

    bl_idname = "PE_MT_known_rigs"
    bl_label = "Add Rig"

    def draw(self, _context: Context) -> None:
        for key, title in menu_of_rigs():
            if key:
                self.layout.operator("pe.add_rig", text=title, translate=False).key = key
            else:
                self.layout.separator()
        self.layout.separator()
        self.layout.operator("pe.show_places", icon="EMPTY_ARROWS")


def selected(settings: PropertyGroup) -> PropertyGroup:
    """Return the selected row; the last one where the list has become shorter."""
    return settings.variants[min(settings.variant_index, len(settings.variants) - 1)]


def draw_state(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw the buttons of the scene's variant, always in the same place."""
    active = selected(settings).key == settings.variant_key
    row = layout.row(align=True)
    there = row.row(align=True)
    there.enabled = settings.variant_changed or not active
    there.operator("pe.switch_variant", text="Revert" if active else "Switch")
    update = row.row(align=True)
    update.enabled = settings.variant_changed
    update.operator("pe.update_variant", text="Update")
    row = layout.row(align=True)
    row.operator("pe.compare_variants", icon="MOD_ARRAY")
    row.menu(PE_MT_known_rigs.bl_idname, icon="AUTO", text="Add Rig", translate=False)


@panel("Sensor Choices")
def selection(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Choices of models for each sensor, with prices"""
    obj = context.active_object
    if obj is not None and obj.perception_entropy.is_sensor:
        draw_options(layout, obj)
    else:
        draw_label(layout, "Select a sensor to choose models for it", "INFO")
    limits = layout.column()
    # Candidates of the screening; the method that has them, too, shows them beside itself.
    own = () if settings.method == RANDOM else ("candidates",)
    draw_properties(limits, settings, (*own, "currency"))
    draw_declared(limits, settings, "selection", ("currency",))
    layout.operator("pe.choose_sensors", icon="VIEWZOOM")
    if settings.front.rows:
        draw_front(layout, settings, context)


def draw_options(layout: UILayout, obj: Object) -> None:
    """Draw the models that may be chosen for a sensor, with their prices."""
    settings = obj.perception_entropy
    layout.label(text=obj.name, icon="EMPTY_AXIS", translate=False)
    column = layout.column(align=True)
    for number, option in enumerate(settings.options):
        model, price = columns(column, 0.66)
        model.prop(option, "model", text="")
        price.prop(option, "price", text="")
        remove = price.operator("pe.remove_row", text="", icon="REMOVE", emboss=False)
        remove.rows = "options"
        remove.index = number
        row = column.row(align=True)
        for name in ("mass", "power", "data_rate"):
            row.prop(option, name)
    column.operator("pe.add_row", text="Add Model", icon="ADD").rows = "options"
    if settings.options:
        layout.prop(settings, "may_be_left_out")


def draw_front(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Draw the Pareto front: a button for each design's variant, its name and its figures."""
    column = layout.box().column(align=True)
    front = settings.front
    if front.note:
        draw_sentence(column, context, front.note, icon="INFO")
    for row in front.rows:
        icon = "RADIOBUT_ON" if row.key == settings.variant_key else "RADIOBUT_OFF"
        line = column.row()
        line.operator("pe.switch_variant", text="", icon=icon, emboss=False).key = row.key
        line.label(text=row.name, translate=False)
        draw_sentence(column, context, row.figures, icon="BLANK1")
    draw_sentence(column, context, front.told)


CLASSES = (PE_MT_known_rigs, variants_rows, variants, selection)
