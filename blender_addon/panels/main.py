"""The tab's first panel: vehicle, sensors, score and search."""

from __future__ import annotations

import bpy

from ..choices import VERSION
from ..operators import offers
from .layout import Tab
from .result import draw_actions, draw_result, draw_vehicle_warnings
from .sensors import draw_sensors
from .words import draw_sentence

KIND = "pe_kind"
"""What a button tells its menu, in Blender's context: the kind of sensor to list."""


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
        draw_vehicle_warnings(self.layout, context)
        draw_add(self.layout)
        draw_sensors(self.layout, context)
        draw_actions(self.layout, settings)
        if settings.has_result:
            draw_result(self.layout, context)


def draw_add(layout: bpy.types.UILayout) -> None:
    """Draw for each kind a button for its usual sensor, and a menu of all of them."""
    row = layout.row()
    for offer in offers():
        pair = row.row(align=True)
        pair.operator("pe.add_sensor", text=f"Add {offer.label}", icon="ADD").model = offer.usual
        pair.context_string_set(KIND, offer.kind)
        pair.menu(PE_MT_add_sensor.bl_idname, text="", icon="DOWNARROW_HLT")


class PE_MT_add_sensor(bpy.types.Menu):
    """All sensors of this kind in the catalogue"""

    bl_idname = "PE_MT_add_sensor"
    bl_label = "Add Sensor"

    def draw(self, context: bpy.types.Context) -> None:
        kind = getattr(context, KIND, None)  # of none in particular: all
        for offer in offers():
            for name in offer.models if kind in (None, offer.kind) else ():
                self.layout.operator("pe.add_sensor", text=name, translate=False).model = name


CLASSES = (
    PE_MT_add_sensor,
    PE_PT_main,
)
