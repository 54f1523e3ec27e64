"""The sensor that is being placed by pointing: its pose under the mouse, and its preview.

Its state is in this module, not in the scene: the file does not change before it is placed.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from .. import bridge
from ..choices import free_name
from ..engine import graphics, kinds, pe
from ..language import draw_label
from ..sensor_kinds import mount_for
from . import running_job
from .placement_preview import GainPreview, HeldPreview
from .surface_pose import (
    MAX_STAND_OFF_M,
    Stance,
    SurfaceSpot,
    parts_of,
    ray_of,
    spot_on_ray,
    vehicle_center,
    view_under,
)

LENGTH_M, RING_M, ALOFT_M = 2.0, 0.12, 100.0
STEM_COLOR = (1.0, 1.0, 1.0, 0.8)
HELD_PALETTE = replace(graphics.VIEWPORT, free=(1.0, 0.93, 0.55, 0.5), other=(1.0, 0.93, 0.55, 0.9))
"""Lighter than sensors that are there."""
POINT_AT = "Point at the vehicle"


class HeldSensor:
    """One sensor that is held under the mouse, until it is placed or cancelled."""

    def __init__(self, context: bpy.types.Context, model: Any, stance: Stance) -> None:
        self.model, self.kind = model, kinds.kind_of(model)
        self.mount, self.stance = mount_for(model), stance
        self.matrix: Matrix | None = None
        self._spot: SurfaceSpot | None = None
        self.score = self._typed = ""
        self._preview = HeldPreview()
        self._shape = sensor_shape(self.kind.label, model)
        depsgraph = context.evaluated_depsgraph_get()
        vehicle = context.scene.perception_entropy.vehicle
        self._parts = parts_of(vehicle, depsgraph)
        self._middle = vehicle_center(vehicle)
        self._gain_preview = self._study(context.scene, depsgraph)
        self._workspace = context.workspace.name
        self._preview.begin()
        self.show_keys()

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
        """Change the stance of the sensor at its present spot."""
        self.stance = stance
        self._stand(self._spot)
        self.show_keys()

    def typed(self, letter: str) -> None:
        """Append a digit or a point to the typed stand-off; "" removes the last character."""
        self._typed = self._typed + letter if letter else self._typed[:-1]
        try:
            stand_off_m = float(self._typed or self.mount.stand_off_m)
        except ValueError:  # not yet a number, such as a point alone
            self.show_keys()
            return
        self.stand(replace(self.stance, stand_off_m=min(stand_off_m, MAX_STAND_OFF_M)))

    def step(self, by_m: float) -> None:
        """Change the stand-off by a distance [m]."""
        self._typed = ""
        self.stand(self.stance.changed(by_m))

    @property
    def angles(self) -> tuple[float, float]:
        """Yaw and pitch [deg] of the held sensor; those of its stance without a spot."""
        if self.matrix is None:
            return self.stance.yaw_deg, self.stance.pitch_deg
        _, pitch, yaw = self.matrix.to_euler()
        return round(math.degrees(yaw), 1) + 0.0, round(math.degrees(pitch), 1) + 0.0

    @property
    def standoff_text(self) -> str:
        """Return the stand-off as text: the typed text, or the present value."""
        return f"{self._typed or format(self.stance.stand_off_m, 'g')} m"

    def more(self, context: bpy.types.Context) -> None:
        """Hold another sensor of the same model; its score includes the sensor just placed."""
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        self._gain_preview, self.score = self._study(scene, depsgraph), ""
        self._stand(None)

    def show_keys(self) -> None:
        """Show the keys in the status bar."""
        workspace = bpy.data.workspaces.get(self._workspace)
        if workspace is not None:
            workspace.status_text_set(draw_status)

    def end(self) -> None:
        """Remove the preview, the status text and the score."""
        self._preview.end()
        if self._gain_preview is not None:
            self._gain_preview.end()
        for workspace in bpy.data.workspaces:
            workspace.status_text_set(None)
        self._preview.redraw()

    def _stand(self, spot: SurfaceSpot | None) -> None:
        self._spot, self.matrix = spot, None
        if spot is None:
            self._preview.show(graphics.Primitives.empty(), graphics.Primitives.empty())
        else:
            self.matrix = self.stance.placed(spot, self.mount, self._middle)
            self._show(spot)
        self._write()
        self._preview.redraw()

    def _show(self, spot: SurfaceSpot) -> None:
        """Draw the sensor on a spot, and request its approximate score."""
        pose = bridge.pose_of_matrix(np.array(self.matrix, dtype=float))
        stem = graphics.Primitives.of([spot.point, pose.position], STEM_COLOR)
        lines = [moved_to(self._shape[0], pose), stem]
        self._preview.show(graphics.Primitives.joined(lines), moved_to(self._shape[1], pose))
        if self._gain_preview is not None:
            self._gain_preview.ask(pose)

    def _write(self) -> None:
        if self._spot is None:
            self._preview.write(self.model.name, POINT_AT)
            return
        stands = "along the normal" if self.stance.along_normal else "upright"
        where = f"{self.stance.stand_off_m:g} m from {self._spot.part}, {stands}"
        if self.stance.is_turned:
            where += ", yaw {:g}°, pitch {:g}°".format(*self.angles)
        self._preview.write(self.model.name, where, self.score)

    def _show_gain(self, score: str) -> None:
        self.score = score
        self._write()
        self._preview.redraw()

    def _study(self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> GainPreview | None:
        """Return the preview of its score; None, with the error as text, if there is no study."""
        sensors = bridge.possible_sensors(bridge.sensor_objects(scene), depsgraph)
        name = free_name(self.kind.label, {sensor.name for sensor in sensors})
        try:
            rig = pe.Rig([*sensors, pe.Sensor(name, self.model)])
            study = bridge.study_of_rig(scene, depsgraph, rig)
            return GainPreview(study, name, self._show_gain)
        except (pe.InputError, MemoryError) as error:
            self.score = f"no score: {error}"
            return None


current: HeldSensor | None = None


def busy() -> bool:
    """Whether a sensor is being placed or a job runs: only one of them may use Esc."""
    return current is not None or running_job.current is not None


def begin(context: bpy.types.Context, model: Any, stance: Stance) -> None:
    """Start to hold a sensor under the mouse."""
    global current
    current = HeldSensor(context, model, stance)


def end() -> None:
    """Stop holding the sensor; does nothing if there is none."""
    global current
    if current is not None:
        ended, current = current, None
        ended.end()


def sensor_shape(name: str, model: Any) -> tuple[graphics.Primitives, graphics.Primitives]:
    """Return lines and faces of a sensor in its own frame, computed once for all moves.

    They are computed high above the ground, because lines end at the ground, and moved back down.
    """
    sensor = pe.Sensor(name, model, pe.Pose((0.0, 0.0, ALOFT_M)))
    drawing = graphics.drawing_of(sensor.kind)
    lines = [
        drawing.lines(sensor, LENGTH_M, HELD_PALETTE),
        graphics.ring_lines(sensor, RING_M, HELD_PALETTE),
    ]
    low = np.array([0.0, 0.0, ALOFT_M], np.float32)
    both = graphics.Primitives.joined(lines), drawing.faces(sensor, LENGTH_M, HELD_PALETTE)
    moved = [graphics.Primitives(primitives.points - low, primitives.colors) for primitives in both]
    return moved[0], moved[1]


def moved_to(shape: graphics.Primitives, pose: pe.Pose) -> graphics.Primitives:
    """Return a shape, given in the sensor's frame, at a pose of the sensor."""
    turned = shape.points @ pose.ground_from_sensor.T.astype(np.float32)
    return graphics.Primitives(turned + np.array(pose.position, np.float32), shape.colors)


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
        (("MOUSE_MMB",), f"Wheel, [ ], Digits: Stand-off {current.standoff_text}"),
        (("DRIVER_ROTATIONAL_DIFFERENCE",), f"Arrows (Shift: 1°): {angles}"),
        (("EVENT_ESC",), "   Leave"),
    )
    for icons, text in keys:
        pair = row.row(align=True)
        for icon in icons[:-1]:
            pair.label(text="", icon=icon)
        draw_label(pair, text, icons[-1])
    row.separator_spacer()
