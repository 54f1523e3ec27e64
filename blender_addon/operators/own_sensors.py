"""Own sensors, own AP curves, and bounds around where a sensor is."""

from __future__ import annotations

import math

import bpy
from bpy.props import EnumProperty, IntProperty

from .. import bridge, changes
from ..choices import free_name
from ..engine import catalog, kinds, search
from ..properties import OWN_KINDS
from .reports import REFUSALS, refuse

REACH = (0.5, 10.0)
"""Bounds begin this far to either side of where a sensor is: metres, degrees."""


class PE_OT_add_own_sensor(bpy.types.Operator):
    """Define a sensor of your own, by channels, field of view and range, or by pixels"""

    bl_idname = "pe.add_own_sensor"
    bl_label = "Add Own Sensor"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(items=OWN_KINDS, name="Kind", description="What it is")

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.perception_entropy
        row = settings.own_sensors.add()
        row.kind = self.kind
        row.name = free_name(f"My {kinds.KINDS[row.kind].label}", set(catalog.entries()))
        settings.own_index = len(settings.own_sensors) - 1
        changes.study.tell()
        return {"FINISHED"}


class PE_OT_remove_own_sensor(bpy.types.Operator):
    """Take this own sensor away; sensors of the model are refused from then on"""

    bl_idname = "pe.remove_own_sensor"
    bl_label = "Remove Own Sensor"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        settings = context.scene.perception_entropy
        return settings.own_index < len(settings.own_sensors)

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.perception_entropy
        settings.own_sensors.remove(settings.own_index)
        settings.own_index = max(0, min(settings.own_index, len(settings.own_sensors) - 1))
        changes.study.tell()
        return {"FINISHED"}


class PE_OT_own_curves(bpy.types.Operator):
    """Set the AP curves by hand, starting from those of each kind"""

    bl_idname = "pe.own_curves"
    bl_label = "Own AP Curves"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        rows = context.scene.perception_entropy.curves
        for name, kind in kinds.KINDS.items():
            if name not in rows:
                row = rows.add()
                row.name, row.a, row.b = name, kind.curve.a, kind.curve.b
        return {"FINISHED"}


class PE_OT_bound_axis(bpy.types.Operator):
    """Give the search bounds here, around where this sensor is; again takes them away"""

    bl_idname = "pe.bound_axis"
    bl_label = "Bound Axis"
    bl_options = {"REGISTER", "UNDO"}

    axis: IntProperty(name="Axis", description="x, y, z, roll, pitch, yaw", min=0, max=5)

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.active_object
        settings = obj.perception_entropy
        try:
            pose = bridge.pose_of(obj, context.evaluated_depsgraph_get())
        except REFUSALS as error:
            return refuse(self, error)
        settings.bounded[self.axis] = not settings.bounded[self.axis]
        if settings.bounded[self.axis]:
            middle = (*pose.position, *map(math.degrees, pose.rpy))[self.axis]
            reach = REACH[search.AXES[self.axis] not in ("x", "y", "z")]
            settings.bounds_low[self.axis] = round(middle - reach, 3)
            settings.bounds_high[self.axis] = round(middle + reach, 3)
        return {"FINISHED"}


CLASSES = (PE_OT_add_own_sensor, PE_OT_remove_own_sensor, PE_OT_own_curves, PE_OT_bound_axis)
