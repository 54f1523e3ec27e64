"""Add a sensor by pointing: it stands on the surface under the mouse, a click places it there."""

from __future__ import annotations

import math
from dataclasses import replace

import bpy
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, StringProperty
from mathutils import Matrix, Vector

from ..engine import catalog, kinds
from ..housing import measured_housing
from ..language import shown
from ..properties import DEFAULT_MODEL, model_suggestions
from ..sensor_kinds import Mount, mount_for
from . import placement
from .add_sensor import choose_vehicle, default_location, new_sensor, select_only, tooltip_of
from .reports import USER_ERRORS, OperatorResult, report_error
from .surface_pose import STAND_OFF_STEP_M, Stance, SurfaceSpot, view_under

BY_KIND = -1.0
STEPS = {
    "LEFT_BRACKET": -STAND_OFF_STEP_M,
    "WHEELDOWNMOUSE": -STAND_OFF_STEP_M,
    "RIGHT_BRACKET": STAND_OFF_STEP_M,
    "WHEELUPMOUSE": STAND_OFF_STEP_M,
}
"""Keys that bring a sensor nearer to the surface, or farther from it [m]."""
TURN_DEG, FINE_TURN_DEG = 5.0, 1.0
TURNS = {
    "LEFT_ARROW": (1.0, 0.0),
    "RIGHT_ARROW": (-1.0, 0.0),
    "UP_ARROW": (0.0, -1.0),
    "DOWN_ARROW": (0.0, 1.0),
}
"""Keys that turn a sensor: yaw to the left and pitch nose down, in steps; finer with Shift."""
NUMBERS = ("ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE")
TYPED = {key: str(n) for n, key in enumerate(NUMBERS)} | {"PERIOD": ".", "COMMA": "."}
TYPED["BACK_SPACE"] = ""
"""Keys of a typed stand-off; those of the number pad turn the view."""
VIEW = ("NUMPAD_", "MIDDLEMOUSE", "WHEEL", "TRACKPAD", "MOUSE", "NDOF", "TIMER", "WINDOW", "HOME")
"""How events begin that turn, move and zoom the view, or are Blender's own: they pass."""


class PE_OT_place_sensor(bpy.types.Operator):
    """Place a sensor by pointing at the vehicle. Click: place, Esc: cancel"""

    bl_idname = "pe.place_sensor"
    bl_label = "Place Sensor"
    bl_options = {"REGISTER", "UNDO"}

    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        default=DEFAULT_MODEL,
        search=model_suggestions,
        search_options=set(),
    )
    location: FloatVectorProperty(
        name="Location", description="Point of the surface below the sensor", subtype="XYZ"
    )
    normal: FloatVectorProperty(
        name="Normal",
        description="Normal of the surface there, outwards",
        subtype="DIRECTION",
        default=(0.0, 0.0, 1.0),
    )
    along_normal: BoolProperty(
        name="Along the Normal",
        description="Align the sensor with the surface's normal instead of upright",
    )
    stand_off: FloatProperty(
        name="Stand-off",
        description="Distance of the sensor's origin from the surface; negative: the default of its"
        " kind",
        default=BY_KIND,
        unit="LENGTH",
    )

    yaw: FloatProperty(
        name="Yaw",
        description="Rotation about the sensor's z axis; positive is to the left",
        subtype="ANGLE",
    )
    pitch: FloatProperty(
        name="Pitch",
        description="Rotation about the sensor's y axis; positive is nose down",
        subtype="ANGLE",
    )

    housing: BoolProperty(
        name="Housing",
        description="Show the sensor's own body in its true size, where a data sheet gives it",
        default=True,
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, chosen: bpy.types.OperatorProperties) -> str:
        return f"{shown(str(cls.__doc__))}\n\n{tooltip_of(chosen.model)}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Sensors are added in Object Mode"))
            return False
        if placement.busy():
            cls.poll_message_set(
                shown("Something else waits for Esc: a search, or a sensor to place")
            )
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        """Place the sensor at the given location."""
        try:
            model = catalog.load(self.model)
            kind = kinds.kind_of(model)
        except USER_ERRORS as error:
            return report_error(self, error)
        choose_vehicle(context.scene)
        spot = SurfaceSpot(Vector(self.location), Vector(self.normal).normalized(), "")
        mount = mount_for(model)
        middle = placement.vehicle_center(context.scene.perception_entropy.vehicle)
        self._add(context, mount, kind.label, self._stance(mount).placed(spot, mount, middle))
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
        """Hold the sensor under the mouse."""
        if bpy.app.background:
            return self.execute(context)
        try:
            model = catalog.load(self.model)
            choose_vehicle(context.scene)
            placement.begin(context, model, self._stance(mount_for(model)))
        except USER_ERRORS as error:
            return report_error(self, error)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        """Follow the mouse; events that are not handled here are passed to Blender."""
        held = placement.current
        if held is None:  # the add-on has ended the placement
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS":
            placement.end()
            return {"CANCELLED"}
        if event.type == "MOUSEMOVE":
            held.point(context, event)
            return {"PASS_THROUGH"}
        if view_under(context, event) is None or event.value != "PRESS":
            return {"PASS_THROUGH"}
        return self._pressed(context, event, held)

    def cancel(self, _context: bpy.types.Context) -> None:
        """Called by Blender when the window or the file is closed: no sensor is placed."""
        placement.end()

    def _pressed(
        self, context: bpy.types.Context, event: bpy.types.Event, held: placement.HeldSensor
    ) -> OperatorResult:
        """Handle a key or a button that was pressed over a 3D view."""
        if event.type == "RIGHTMOUSE":
            placement.end()
            return {"CANCELLED"}
        if event.type == "LEFTMOUSE":
            held.point(context, event)
            return self._click(context, held, more=event.shift)
        if event.type in {"RET", "NUMPAD_ENTER"}:
            held.matrix = Matrix.Translation(default_location(context, held.mount))
            return self._click(context, held, more=False)
        if event.type == "N" and not (event.ctrl or event.alt):
            held.stand(replace(held.stance, along_normal=not held.stance.along_normal))
        elif event.type in STEPS and not (event.ctrl or event.shift or event.alt):
            held.step(STEPS[event.type])
        elif event.type in TURNS and not (event.ctrl or event.alt):
            step = FINE_TURN_DEG if event.shift else TURN_DEG
            held.turn(*(step * way for way in TURNS[event.type]))
        elif event.type in TYPED and not (event.ctrl or event.alt):
            held.typed(TYPED[event.type])
        elif event.type.startswith(VIEW):
            return {"PASS_THROUGH"}
        return {"RUNNING_MODAL"}

    def _click(
        self, context: bpy.types.Context, held: placement.HeldSensor, more: bool
    ) -> OperatorResult:
        """Place the held sensor; then hold the next one, or finish."""
        if held.matrix is None:
            return {"RUNNING_MODAL"}
        self._add(context, held.mount, held.kind.label, held.matrix)
        if more:
            bpy.ops.ed.undo_push(message=self.bl_label)
            held.more(context)
            return {"RUNNING_MODAL"}
        placement.end()
        return {"FINISHED"}

    def _add(self, context: bpy.types.Context, mount: Mount, name: str, placed: Matrix) -> None:
        body = measured_housing(self.model) if self.housing else None
        obj = new_sensor(context, name, self.model, mount, body)
        obj.location, obj.rotation_euler = placed.to_translation(), placed.to_euler()
        select_only(context, obj)

    def _stance(self, mount: Mount) -> Stance:
        stand_off_m = mount.stand_off_m if self.stand_off < 0.0 else self.stand_off
        return Stance(
            stand_off_m, self.along_normal, math.degrees(self.yaw), math.degrees(self.pitch)
        )


CLASSES = (PE_OT_place_sensor,)
