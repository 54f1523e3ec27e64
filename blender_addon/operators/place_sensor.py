"""Add a sensor by pointing: it stands on the surface under the mouse, a click places it there."""

import math
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, StringProperty
from mathutils import Matrix, Vector

from .. import document
from ..engine import catalog, kinds, pe
from ..sensor_kinds import Mount, mount_for
from ..view.housing import measured_housing
from . import modes, placement
from .add_sensor import (
    MODEL,
    choose_vehicle,
    default_location,
    new_sensor,
    select_only,
    with_data_sheet,
)
from .declared import USER_ERRORS, OperatorResult, chosen_sensor, operator, report_error
from .edit_sensors import mirrored_copy
from .surface_pose import STAND_OFF_STEP_M, Stance, SurfaceSpot, vehicle_center, view_under

BY_KIND = -1.0
STEPS = {
    "LEFT_BRACKET": -STAND_OFF_STEP_M,
    "WHEELDOWNMOUSE": -STAND_OFF_STEP_M,
    "RIGHT_BRACKET": STAND_OFF_STEP_M,
    "WHEELUPMOUSE": STAND_OFF_STEP_M,
}
"""Keys that bring a sensor nearer to the surface, or farther from it [m]."""
TURN_DEG = 5.0
FINE_TURN_DEG = 1.0
TURNS = {
    "LEFT_ARROW": (1.0, 0.0),
    "RIGHT_ARROW": (-1.0, 0.0),
    "UP_ARROW": (0.0, -1.0),
    "DOWN_ARROW": (0.0, 1.0),
}
"""Keys that turn a sensor: yaw to the left and pitch nose down, in steps; finer with Shift."""
AXES = ("X", "Y", "Z")
NUMBERS = ("ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE")
TYPED = {key: str(n) for n, key in enumerate(NUMBERS)} | {"PERIOD": ".", "COMMA": "."}
TYPED |= {"MINUS": "-", "BACK_SPACE": ""}
"""Keys of a typed number; those of the number pad turn the view."""
BUSY = "Something else waits for Esc: a search, or a sensor to place"


def _stance(self: Any, mount: Mount) -> Stance:
    stand_off_m = mount.stand_off_m if self.stand_off < 0.0 else self.stand_off
    return Stance(stand_off_m, self.along_normal, math.degrees(self.yaw), math.degrees(self.pitch))


def _put(self: Any, context: bpy.types.Context, name: str, mount: Mount, placed: Matrix) -> None:
    """Add the sensor with a pose, or move the one that is there; with its mirror image if asked."""
    pose = document.pose_of_matrix(np.array(placed, dtype=float))
    if self.sensor:
        document.place_poses(context.scene, {self.sensor: pose})
        obj = context.scene.objects[self.sensor]
    else:
        body = measured_housing(self.model) if self.housing else None
        obj = new_sensor(context, name, self.model, mount, body=body)
        obj.location = placed.to_translation()
        obj.rotation_euler = placed.to_euler()
        context.view_layer.update()
    if self.mirrored and not obj.perception_entropy.mirror_of and not document.in_the_middle(pose):
        try:
            document.link_mirror(obj, mirrored_copy(context, obj))
        except pe.InputError as error:
            self.report({"WARNING"}, str(error))
    select_only(context, obj)


def _model(self: Any, context: bpy.types.Context) -> Any:
    """Return the model of the sensor that is moved, or of a new one."""
    if not self.sensor:
        return catalog.load(self.model)
    return catalog.load(chosen_sensor(context, self.sensor).perception_entropy.model)


def _hold(self: Any, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
    """Hold the sensor under the mouse."""
    if bpy.app.background:
        return self.execute(context)
    try:
        model = _model(self, context)
        moved = context.scene.objects.get(self.sensor)
        choose_vehicle(context.scene)
        placement.begin(context, model, _stance(self, mount_for(model)), moved)
    except USER_ERRORS as error:
        return report_error(self, error)
    context.window_manager.modal_handler_add(self)
    return {"RUNNING_MODAL"}


def _modal(self: Any, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
    """Follow the mouse; events that are not handled here are passed to Blender."""
    held = placement.current
    if held is None:  # the add-on has ended the placement
        return {"CANCELLED"}
    if event.type == "MOUSEMOVE":
        held.point(context, event)
        return {"PASS_THROUGH"}
    if event.value != "PRESS":
        return {"PASS_THROUGH"}
    is_in_view = view_under(context, event) is not None
    if event.type == "ESC" or (event.type == "RIGHTMOUSE" and is_in_view):
        placement.end()
        return {"CANCELLED"}
    return _pressed(self, context, event, held) if is_in_view else {"PASS_THROUGH"}


def _pressed(
    self: Any, context: bpy.types.Context, event: bpy.types.Event, held: placement.HeldSensor
) -> OperatorResult:
    """Handle a key or a button that was pressed over a 3D view."""
    is_plain = not (event.ctrl or event.alt)
    if event.type == "LEFTMOUSE":
        held.point(context, event)
        return _click(self, context, held, more=event.shift and not self.sensor)
    if event.type in {"RET", "NUMPAD_ENTER"}:
        return _click(self, context, held, more=False)
    if event.type == "R" and is_plain:
        held.matrix = Matrix.Translation(default_location(context, held.mount))
        return _click(self, context, held, more=False)
    if event.type == "N" and is_plain:
        held.stand(replace(held.stance, along_normal=not held.stance.along_normal))
    elif event.type == "M" and is_plain:
        held.mirror()
    elif event.type in AXES and is_plain:
        held.type_into(AXES.index(event.type))
    elif event.type in STEPS and is_plain and not event.shift:
        held.step(STEPS[event.type])
    elif event.type in TURNS and is_plain:
        step = FINE_TURN_DEG if event.shift else TURN_DEG
        held.stand(held.stance.turned(*(step * way for way in TURNS[event.type])))
    elif event.type in TYPED and is_plain:
        held.typed(TYPED[event.type])
    elif event.type.startswith(modes.OF_VIEW):
        return {"PASS_THROUGH"}
    return {"RUNNING_MODAL"}


def _click(
    self: Any, context: bpy.types.Context, held: placement.HeldSensor, more: bool
) -> OperatorResult:
    """Place the held sensor; then hold the next one, or finish."""
    if held.matrix is None:
        return {"RUNNING_MODAL"}
    self.mirrored = held.mirrored
    try:
        _put(self, context, held.kind.label, held.mount, placed=held.matrix)
    except USER_ERRORS as error:  # a constraint holds the sensor that was to be moved
        placement.end()
        return report_error(self, error)
    if more:
        bpy.ops.ed.undo_push(message=self.bl_label)
        held.more(context)
        return {"RUNNING_MODAL"}
    placement.end()
    return {"FINISHED"}


@operator(
    "Place Sensor",
    mode="Sensors are added in Object Mode",
    unless=lambda _: BUSY if placement.busy() else None,
    tooltip=with_data_sheet,
    invoke=_hold,
    modal=_modal,
    cancel=lambda _self, _context: placement.end(),  # the window or the file is closed
    **MODEL,
    location=FloatVectorProperty(
        name="Location", description="Point of the surface below the sensor", subtype="XYZ"
    ),
    normal=FloatVectorProperty(
        name="Normal",
        description="Normal of the surface there, outwards",
        subtype="DIRECTION",
        default=(0.0, 0.0, 1.0),
    ),
    along_normal=BoolProperty(
        name="Along the Normal",
        description="Align the sensor with the surface's normal instead of upright",
    ),
    stand_off=FloatProperty(
        name="Stand-off",
        description="Distance of the sensor's origin from the surface; negative: the default of its"
        " kind",
        default=BY_KIND,
        unit="LENGTH",
    ),
    yaw=FloatProperty(
        name="Yaw",
        description="Rotation about the sensor's z axis; positive is to the left",
        subtype="ANGLE",
    ),
    pitch=FloatProperty(
        name="Pitch",
        description="Rotation about the sensor's y axis; positive is nose down",
        subtype="ANGLE",
    ),
    mirrored=BoolProperty(
        name="Mirrored", description="Place a linked mirror image on the other side, too"
    ),
    sensor=StringProperty(
        name="Sensor", description="Sensor that is moved; empty: a new one", options={"SKIP_SAVE"}
    ),
)
def place_sensor(context: bpy.types.Context, operator: Any) -> None:
    """Place a sensor by pointing at the vehicle. Click: place, Esc: cancel"""
    model = _model(operator, context)
    kind = kinds.kind_of(model)
    mount = mount_for(model)
    choose_vehicle(context.scene)
    spot = SurfaceSpot(Vector(operator.location), Vector(operator.normal).normalized(), "")
    middle = vehicle_center(context.scene.perception_entropy.vehicle)
    placed = _stance(operator, mount).placed(spot, mount, middle)
    _put(operator, context, kind.label, mount, placed=placed)
