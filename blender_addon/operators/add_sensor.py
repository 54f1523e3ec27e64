"""Add a sensor: an empty that carries its settings, at a place that makes sense."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import bridge
from ..engine import catalog, kinds
from ..housing import known_housing
from ..properties import DEFAULT_MODEL, model_suggestions
from .mounting import Mount, mount_of, sensible_place
from .offered import described
from .reports import REFUSALS, refuse


class PE_OT_add_sensor(bpy.types.Operator):
    """Add a sensor at the 3D cursor, or on the roof while the cursor is at the origin"""

    bl_idname = "pe.add_sensor"
    bl_label = "Add Sensor"
    bl_options = {"REGISTER", "UNDO"}

    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        default=DEFAULT_MODEL,
        search=model_suggestions,
        search_options=set(),
    )
    housing: BoolProperty(
        name="Housing",
        description="Show the sensor's own body in its true size, where a data sheet gives it",
        default=True,
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, chosen: bpy.types.OperatorProperties) -> str:
        return f"{cls.__doc__}\n\n{described(chosen.model)}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Sensors are added in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            kind = kinds.kind_of(catalog.load(self.model))
            mount = mount_of(kind.name)
            choose_vehicle(context.scene)
            location = sensible_place(context, mount)
        except REFUSALS as error:
            return refuse(self, error)
        body = known_housing(self.model) if self.housing else None
        obj = new_sensor(context, kind.label, self.model, mount, body)
        obj.location = location
        select_only(context, obj)
        return {"FINISHED"}


def choose_vehicle(scene: bpy.types.Scene) -> None:
    """Take the only collection with meshes for the vehicle, if none has been chosen."""
    settings = scene.perception_entropy
    if settings.vehicle is None:
        solid = [
            child for child in scene.collection.children if any(map(is_part, child.all_objects))
        ]
        if len(solid) == 1:
            settings.vehicle = solid[0]


def is_part(obj: bpy.types.Object) -> bool:
    """Whether an object is something that a vehicle may be made of."""
    return obj.type == "MESH" and not bridge.mounted_on_sensor(obj)


def new_sensor(
    context: bpy.types.Context,
    name: str,
    model: str,
    mount: Mount,
    body: bpy.types.Mesh | None = None,
) -> bpy.types.Object:
    """Make a sensor in the scene's collection of sensors: an empty, unless it has a body."""
    obj = bpy.data.objects.new(name, body)
    if body is None:
        obj.empty_display_type, obj.empty_display_size = mount.display, mount.size_m
    bridge.shown_collection(context.scene).objects.link(obj)
    obj.perception_entropy.model = model
    obj.perception_entropy.is_sensor = True
    return obj


def select_only(context: bpy.types.Context, obj: bpy.types.Object) -> None:
    """Make an object the active one, and the only one that is selected."""
    for other in context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj


CLASSES = (PE_OT_add_sensor,)
