"""Rigs of well-known vehicles: one becomes a variant, and stands on the vehicle that is chosen."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import body, bridge, changes
from ..engine import catalog, search
from ..properties import FREE_BY_DEFAULT
from .mounting import mount_of
from .reports import REFUSALS, refuse, tell
from .variants import stand_as_variant


class PE_OT_add_rig(bpy.types.Operator):
    """Put the sensors of a known rig in place of those that stand here, as a variant.

    What stands here and is no variant yet is kept as one"""

    bl_idname = "pe.add_rig"
    bl_label = "Add Known Rig"
    bl_options = {"REGISTER", "UNDO"}

    key: StringProperty(name="Rig", description="Which one", options={"HIDDEN"})
    fit: BoolProperty(
        name="Fit to Vehicle",
        description="Stretch its places from its own vehicle's box to this one's; else they are as "
        "published, about the vehicle's centre",
        default=True,
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: bpy.types.Operator) -> str:
        rig = catalog.known_rigs().get(properties.key)
        if rig is None:
            return cls.__doc__
        return f"{len(rig.sensors)} sensors of {rig.vehicle}. {rig.note}\nSource: {rig.source}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Rigs are added in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        try:
            rig = catalog.known_rig(self.key)
            before = bridge.records_of_scene(scene)
            vehicle = body.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
            fitted = self.fit and vehicle is not None and rig.size is not None
            sensors = rig.on_vehicle(*vehicle.bounds) if fitted else rig.sensors
            note, records = note_of(rig, fitted), tuple(map(record_of, sensors))
            name = stand_as_variant(scene, rig.title, records, note, before)
        except REFUSALS as error:
            return refuse(self, error)
        changes.study.tell()
        tell(self, "INFO", f"Added {name}: {len(rig.sensors)} sensors")
        return {"FINISHED"}


def note_of(rig: catalog.KnownRig, fitted: bool) -> str:
    """Say whose rig it is, and what was made of its published places."""
    how = "stretched to this vehicle's box" if fitted else "as published"
    return (
        f"{rig.vehicle}; published with the origin {rig.origin}, here about the vehicle's centre, "
        f"{how}. {rig.note} Source: {rig.source}"
    )


def record_of(sensor: catalog.KnownSensor) -> bridge.Record:
    """Return a sensor of a known rig as a variant holds it."""
    mount = mount_of(catalog.load(sensor.model).kind)
    values = (*sensor.pose.position, *sensor.pose.rpy)
    pose = search.pose_from_values(dict(zip(search.AXES, values, strict=True)))
    return bridge.Record(
        sensor.name, sensor.model, "", pose, FREE_BY_DEFAULT, True, mount.display, mount.size_m
    )


def rigs() -> tuple[tuple[str, str], ...]:
    """Return keys and titles of the known rigs, for a menu."""
    return tuple((rig.key, rig.title) for rig in catalog.known_rigs().values())


CLASSES = (PE_OT_add_rig,)
