"""The tab's first panel: vehicle, sensors, score and search."""

from __future__ import annotations

import bpy

from ..choices import VERSION
from ..operators import brief, makers, models, offers
from .layout import Tab
from .result import draw_actions, draw_result, draw_vehicle_told
from .sensors import draw_sensors
from .words import draw_sentence
from .written import draw_written

KIND, MAKER = "pe_kind", "pe_maker"
"""What a button tells its menu, in Blender's context: the kind and the maker of sensors to list."""


class PE_PT_main(Tab, bpy.types.Panel):
    """Vehicle, sensors, score and search"""

    bl_idname = "PE_PT_main"
    bl_label = "Perception Entropy"

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        if settings.version > VERSION:
            newer = "This file is of a newer version of the extension: what is new is not seen here"
            draw_sentence(self.layout, context, newer, icon="ERROR")
        self.layout.prop(settings, "vehicle")
        draw_vehicle_told(self.layout, context)
        draw_add(self.layout)
        draw_sensors(self.layout, context)
        draw_actions(self.layout, settings)
        draw_written(self.layout, context)
        draw_result(self.layout, context)


def draw_add(layout: bpy.types.UILayout) -> None:
    """Draw for each kind: its usual sensor on the roof, or by pointing, and a menu of all."""
    column = layout.column(align=True)
    for offer in offers():
        row = column.row(align=True)
        row.operator("pe.add_sensor", text=f"Add {offer.label}", icon="ADD").model = offer.usual
        place = row.operator("pe.place_sensor", text="Place", icon="RESTRICT_SELECT_OFF")
        place.model = offer.usual
        row.context_string_set(KIND, offer.kind)
        row.menu(PE_MT_add_sensor.bl_idname, text="", icon="DOWNARROW_HLT")


class PE_MT_add_sensor(bpy.types.Menu):
    """Place another sensor of this kind by pointing: search the catalogue, or go by its maker"""

    bl_idname = "PE_MT_add_sensor"
    bl_label = "Place Sensor"

    def draw(self, context: bpy.types.Context) -> None:
        layout, kind = self.layout, getattr(context, KIND, None)  # of none in particular: all
        layout.operator_context = "INVOKE_DEFAULT"
        search = layout.operator("pe.search_sensor", text="Search...", icon="VIEWZOOM")
        search.kind = kind or ""
        layout.separator()
        for maker in makers(kind):
            row = layout.row()
            row.context_string_set(MAKER, maker)
            row.menu(PE_MT_sensors_of_maker.bl_idname, text=maker, translate=False)


class PE_MT_sensors_of_maker(bpy.types.Menu):
    """Sensors of one maker in the catalogue"""

    bl_idname = "PE_MT_sensors_of_maker"
    bl_label = "Sensors"

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.operator_context = "INVOKE_DEFAULT"
        kind, maker = getattr(context, KIND, None), getattr(context, MAKER, None)
        for name in models(kind, maker):
            text = f"{name}   {brief(name)}"
            self.layout.operator("pe.place_sensor", text=text, translate=False).model = name


CLASSES = (
    PE_MT_sensors_of_maker,
    PE_MT_add_sensor,
    PE_PT_main,
)
