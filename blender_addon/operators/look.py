"""See what a sensor sees: through a camera's lens, or as a picture of a LiDAR's ranges."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty

from .. import bridge, changes
from ..engine import pe
from . import range_image, view_state
from .reports import REFUSALS, refuse, tell


class PE_OT_look_through(bpy.types.Operator):
    """See what this sensor sees: through a camera, again to come back; a LiDAR as a picture"""

    bl_idname = "pe.look_through"
    bl_label = "Look Through"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the active one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Sensors are looked through in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        obj = scene.objects.get(self.name) if self.name else context.active_object
        try:
            sensor = _sensor(obj, context.evaluated_depsgraph_get())
        except REFUSALS as error:
            return refuse(self, error)
        if isinstance(sensor.model, pe.Lidar):
            return self._picture(context, sensor)
        if not isinstance(sensor.model, pe.Camera):
            tell(self, "WARNING", f"Only cameras and LiDARs show a picture, not {obj.name}")
            return {"CANCELLED"}
        if looking_through(scene) == obj:
            come_back(scene)
            return {"FINISHED"}
        bridge.look_through(scene, obj, sensor.model)
        view_state.turn(scene, context.area)
        return {"FINISHED"}

    def _picture(self, context: bpy.types.Context, sensor: pe.Sensor) -> set[str]:
        """Have a LiDAR's picture made beside the window, and show it when it is there."""
        try:
            vehicle = _vehicle(context)
        except REFUSALS as error:
            return refuse(self, error)
        range_image.ask(sensor, vehicle)
        tell(self, "INFO", f"{sensor.name}: {range_image.LEGEND}")
        return {"FINISHED"}


class PE_OT_look_back(bpy.types.Operator):
    """Come back from looking through a sensor: the view and the scene's camera as before"""

    bl_idname = "pe.look_back"
    bl_label = "Stop Looking Through"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode == "OBJECT" and looking_through(context.scene) is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        come_back(context.scene)
        return {"FINISHED"}


def looking_through(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """Return the sensor that is looked through."""
    camera = scene.camera
    if not scene.perception_entropy.before_look or camera is None:
        return None
    return camera.parent if camera.perception_entropy.is_view else None


def come_back(scene: bpy.types.Scene) -> None:
    """Show the scene as it was looked at before: camera, size of pictures, and views."""
    bridge.look_back(scene)
    view_state.restore(scene)


def _sensor(obj: bpy.types.Object | None, depsgraph: bpy.types.Depsgraph) -> pe.Sensor:
    if obj is None or not obj.perception_entropy.is_sensor:
        raise pe.InputError("scene", "active object", "a sensor", obj.name if obj else "none")
    return bridge.sensor_from_object(obj, depsgraph)


def _vehicle(context: bpy.types.Context) -> pe.Vehicle | None:
    if context.scene.perception_entropy.vehicle is None:
        return None
    return bridge.vehicle_of_scene(context.scene, context.evaluated_depsgraph_get())


_keys: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


def register() -> None:
    """Have Esc come back, in a window's 3D views; and undo, which leaves views as they are."""
    for signal in (changes.moved, changes.rested):
        signal.connect(view_state.settle)
    keys = bpy.context.window_manager.keyconfigs.addon
    if keys is not None:  # there are none without a window
        keymap = keys.keymaps.new(name="3D View", space_type="VIEW_3D")
        _keys.append((keymap, keymap.keymap_items.new("pe.look_back", "ESC", "PRESS")))


def unregister() -> None:
    """Take the key away."""
    for signal in (changes.moved, changes.rested):
        signal.disconnect(view_state.settle)
    while _keys:
        keymap, item = _keys.pop()
        keymap.keymap_items.remove(item)


CLASSES = (PE_OT_look_through, PE_OT_look_back)
