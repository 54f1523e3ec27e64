"""The sensor that is being placed by pointing: where it would stand, and what shows that.

It is kept here and not in the scene: until it is placed, nothing of the file has changed.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .. import bridge
from ..choices import free_name
from ..engine import graphics, kinds, pe
from . import running
from .add_sensor import is_part
from .drafts import Drafts
from .mounting import mount_for
from .pointing import MOST_M, Stance, ray_of, view_under
from .preview import Preview
from .surface import Spot, parts_of, spot_on_ray

SHOWN = graphics.BeamChoice(96, graphics.ChannelMode.FEW)
LENGTH_M, RING_M, ALOFT_M = 2.0, 0.12, 100.0
STEM = (1.0, 1.0, 1.0, 0.8)
IN_THE_AIR = replace(graphics.VIEWPORT, free=(1.0, 0.93, 0.55, 0.5), other=(1.0, 0.93, 0.55, 0.9))
"""Lighter than sensors that are there."""
POINT_AT = "Point at the vehicle"


class Placing:
    """One sensor, from the moment it is held under the mouse until it is placed or left."""

    def __init__(self, context: bpy.types.Context, model: Any, stance: Stance) -> None:
        self.model, self.kind = model, kinds.kind_of(model)
        self.mount, self.stance = mount_for(model), stance
        self.matrix: Matrix | None = None
        self._spot: Spot | None = None
        self.score = self._typed = ""
        self._preview = Preview()
        self._shape = shape_of(self.kind.label, model)
        depsgraph = context.evaluated_depsgraph_get()
        vehicle = context.scene.perception_entropy.vehicle
        self._parts = parts_of(vehicle, depsgraph)
        self._middle = middle_of(vehicle)
        self._drafts = self._study(context.scene, depsgraph)
        self._workspace = context.workspace.name
        self._preview.begin()
        self.tell_keys()

    def point(self, context: bpy.types.Context, event: bpy.types.Event) -> bool:
        """Follow the mouse; return whether it is over a 3D view."""
        view = view_under(context, event)
        spot = None
        if view is not None:
            depsgraph = context.evaluated_depsgraph_get()
            spot = spot_on_ray(context.scene, depsgraph, self._parts, *ray_of(view))
            self._preview.at(view.region, view.mouse)
        self._stand(spot)
        return view is not None

    def stand(self, stance: Stance) -> None:
        """Stand otherwise, where it is."""
        self.stance = stance
        self._stand(self._spot)
        self.tell_keys()

    def typed(self, letter: str) -> None:
        """Take a digit or a point of a typed stand-off; none takes the last one back."""
        self._typed = self._typed + letter if letter else self._typed[:-1]
        try:
            own = float(self._typed or self.mount.stand_off_m)
        except ValueError:  # not yet a number, such as a point alone
            self.tell_keys()
            return
        self.stand(replace(self.stance, stand_off_m=min(own, MOST_M)))

    def step(self, by_m: float) -> None:
        """Stand nearer or farther."""
        self._typed = ""
        self.stand(self.stance.changed(by_m))

    def turn(self, yaw_deg: float, pitch_deg: float) -> None:
        """Turn it where it is."""
        self.stand(self.stance.turned(yaw_deg, pitch_deg))

    @property
    def angles(self) -> tuple[float, float]:
        """Yaw and pitch [deg] of the sensor as it is held; those of its stance while it is not."""
        if self.matrix is None:
            return self.stance.yaw_deg, self.stance.pitch_deg
        _, pitch, yaw = self.matrix.to_euler()
        return round(math.degrees(yaw), 1) + 0.0, round(math.degrees(pitch), 1) + 0.0

    @property
    def told(self) -> str:
        """Return the stand-off, as it is typed or as it is."""
        return f"{self._typed or format(self.stance.stand_off_m, 'g')} m"

    def more(self, context: bpy.types.Context) -> None:
        """Hold another one of the same model: the score begins where the last one stands."""
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        self._drafts, self.score = self._study(scene, depsgraph), ""
        self._stand(None)

    def tell_keys(self) -> None:
        """Say in the status bar which keys there are."""
        workspace = bpy.data.workspaces.get(self._workspace)
        if workspace is not None:
            workspace.status_text_set(draw_status)

    def end(self) -> None:
        """Take away all that shows it."""
        self._preview.end()
        if self._drafts is not None:
            self._drafts.end()
        for workspace in bpy.data.workspaces:
            workspace.status_text_set(None)
        self._preview.redraw()

    def _stand(self, spot: Spot | None) -> None:
        self._spot, self.matrix = spot, None
        if spot is None:
            self._preview.show(graphics.Primitives.empty(), graphics.Primitives.empty())
        else:
            self.matrix = self.stance.placed(spot, self.mount, self._middle)
            self._show(spot)
        self._write()
        self._preview.redraw()

    def _show(self, spot: Spot) -> None:
        """Draw it on a spot, and have its score drafted."""
        pose = bridge.pose_of_matrix(np.array(self.matrix, dtype=float))
        stem = graphics.Primitives.of([spot.point, pose.position], STEM)
        lines = [placed_at(self._shape[0], pose), stem]
        self._preview.show(graphics.Primitives.joined(lines), placed_at(self._shape[1], pose))
        if self._drafts is not None:
            self._drafts.ask(pose)

    def _write(self) -> None:
        if self._spot is None:
            self._preview.write(self.model.name, POINT_AT)
            return
        stands = "along the normal" if self.stance.along_normal else "upright"
        where = f"{self.stance.stand_off_m:g} m from {self._spot.part}, {stands}"
        if self.stance.is_turned:
            where += ", yaw {:g}°, pitch {:g}°".format(*self.angles)
        self._preview.write(self.model.name, where, self.score)

    def _told(self, score: str) -> None:
        self.score = score
        self._write()
        self._preview.redraw()

    def _study(self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> Drafts | None:
        """Return who drafts its score; None, with a line why, where the scene has none."""
        others = bridge.possible_sensors(bridge.sensor_objects(scene), depsgraph)
        name = free_name(self.kind.label, {each.name for each in others})
        try:
            rig = pe.Rig([*others, pe.Sensor(name, self.model)])
            study = bridge.study_of_rig(scene, depsgraph, rig, {})
            return Drafts(study, name, self._told)
        except (pe.InputError, MemoryError) as error:
            self.score = f"no score: {error}"
            return None


current: Placing | None = None


def busy() -> bool:
    """Whether a sensor is being placed, or a job runs: Esc is one's alone."""
    return current is not None or running.current is not None


def begin(context: bpy.types.Context, model: Any, stance: Stance) -> None:
    """Hold a sensor under the mouse from now on."""
    global current
    current = Placing(context, model, stance)


def end() -> None:
    """Let go of it; do nothing if there is none."""
    global current
    if current is not None:
        ended, current = current, None
        ended.end()


def shape_of(name: str, model: Any) -> tuple[graphics.Primitives, graphics.Primitives]:
    """Lines and faces of a sensor in its own frame: worked out once, not at each move.

    It is drawn high above the ground, on which its lines would end, and taken down again.
    """
    sensor = pe.Sensor(name, model, pe.Pose((0.0, 0.0, ALOFT_M)))
    sketch = graphics.drawing_of(sensor.kind).sketch(sensor, None, SHOWN)
    lines = [sketch.lines(LENGTH_M, IN_THE_AIR), graphics.ring_lines(sensor, RING_M, IN_THE_AIR)]
    low = np.array([0.0, 0.0, ALOFT_M], np.float32)
    both = graphics.Primitives.joined(lines), sketch.faces(LENGTH_M, IN_THE_AIR)
    found = [graphics.Primitives(each.points - low, each.colors) for each in both]
    return found[0], found[1]


def placed_at(shape: graphics.Primitives, pose: pe.Pose) -> graphics.Primitives:
    """A shape of a sensor's own frame where the sensor is."""
    turned = shape.points @ pose.ground_from_sensor.T.astype(np.float32)
    return graphics.Primitives(turned + np.array(pose.position, np.float32), shape.colors)


def middle_of(vehicle: bpy.types.Collection | None) -> Vector:
    """Middle of the vehicle's bounding boxes on the ground; the origin without one."""
    solid = [] if vehicle is None else [each for each in vehicle.all_objects if is_part(each)]
    corners = [obj.matrix_world @ Vector(corner) for obj in solid for corner in obj.bound_box]
    if not corners:
        return Vector((0.0, 0.0, 0.0))
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    return Vector(((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, 0.0))


def draw_status(header: bpy.types.Header, _context: bpy.types.Context) -> None:
    """Draw the keys in the status bar, in place of Blender's own hints."""
    if current is None:
        return
    row = header.layout.row()
    angles = "Yaw {:g}°, Pitch {:g}°".format(*current.angles)
    other = "Upright" if current.stance.along_normal else "Along Normal"
    keys = (
        (("MOUSE_LMB",), "Place"),
        (("EVENT_SHIFT", "MOUSE_LMB"), "Place More"),
        (("EVENT_RETURN",), "On the Roof"),
        (("EVENT_N",), other),
        (("MOUSE_MMB",), f"Wheel, [ ], Digits: Stand-off {current.told}"),
        (("DRIVER_ROTATIONAL_DIFFERENCE",), f"Arrows (Shift: 1°): {angles}"),
        (("EVENT_ESC",), "   Leave"),
    )
    for icons, text in keys:
        pair = row.row(align=True)
        for icon in icons[:-1]:
            pair.label(text="", icon=icon)
        pair.label(text=text, icon=icons[-1])
    row.separator_spacer()
