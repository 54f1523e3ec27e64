"""States and weathers of a scene. A state is a frame of the scene; its motions are read there.

A designer poses the vehicle as usual, by an armature, drivers or an action. What has moved between
the frame at which the vehicle is drawn and the frame of a state is read as rigid motions of parts
and sensors, rounded as placements are. The engine moves the vehicle by these motions, here and
without Blender alike, so the front ends agree to the bit.
"""

import contextlib
import json
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from bpy.types import PropertyGroup, Scene

from ..engine import geometry, pe, studies
from .rig import pose_of_matrix, sensor_objects, view_layer_of
from .study_table import put, read_row, store_row, value_at
from .vehicle import vehicle_from_collection

MOVE = ("move",)
LENGTH_DIGITS = 5
ANGLE_DIGITS = 4
"""Decimals of a motion: 0.01 mm and 0.0001 degrees."""
STILL_M = 2e-5
BENT_M = 2e-3
"""A part that moves less than the one stays; one that differs more than the other bends [m]."""
SAME_M = 1e-3
SAME_RAD = 1e-4
"""A sensor that moves as a part within these moves with the part."""


class Shown(NamedTuple):
    """The vehicle and the sensors' poses at a frame."""

    vehicle: pe.Vehicle
    poses: dict[str, pe.Pose]


class Rigid(NamedTuple):
    """A rigid motion about the origin: roll, pitch, yaw [deg], and a translation [m]."""

    rotation: tuple[float, float, float]
    move: tuple[float, float, float]

    def motion(self, parts: tuple[str, ...], sensors: tuple[str, ...]) -> geometry.Motion:
        """Return the motion of some parts and sensors."""
        roll, pitch, yaw = (math.radians(angle) for angle in self.rotation)
        return geometry.Motion(parts, (roll, pitch, yaw), move=self.move, sensors=sensors)


STILL = Rigid((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def shown_state(scene: Scene) -> str:
    """Return the name of the state that is shown; empty where the vehicle is shown as drawn."""
    row = _shown_row(scene)
    return "" if row is None else row.name or "?"


def _shown_row(scene: Scene) -> PropertyGroup | None:
    settings = scene.perception_entropy
    shown = scene.frame_current
    if shown == settings.drawn_frame:
        return None
    return next((row for row in settings.states if row.frame == shown), None)


def shown_motions(scene: Scene) -> str:
    """Return the motions of the state that is shown, as they are stored; empty as drawn."""
    row = _shown_row(scene)
    return "" if row is None else json.dumps(value_at(row.table, MOVE))


def with_drawn(scene: Scene, vehicle: pe.Vehicle) -> pe.Vehicle:
    """Return the vehicle as it is shown, which knows how it is drawn: `Vehicle.drawn`."""
    row = _shown_row(scene)
    if row is None:
        return vehicle
    with contextlib.suppress(pe.InputError):  # a score reports what is wrong with a state
        return replace(vehicle, drawn=_state_of(row).undone(vehicle))
    return vehicle


@contextlib.contextmanager
def as_drawn(scene: Scene) -> Iterator[None]:
    """Show the frame at which the vehicle is drawn, within; only where the scene has states."""
    if not shown_state(scene):
        yield
        return
    shown = scene.frame_current
    scene.frame_set(scene.perception_entropy.drawn_frame)
    try:
        yield
    finally:
        scene.frame_set(shown)


def conditions_of(settings: PropertyGroup) -> pe.Conditions:
    """Return the conditions of a scene that are switched on. `InputError` when a row is wrong,
    names repeat, or all weights are 0."""
    states = [_state_of(row) for row in settings.states if row.enabled]
    weathers = [_weather_of(row) for row in settings.weathers if row.enabled]
    return pe.Conditions(states, weathers)


def write_conditions(settings: PropertyGroup, conditions: pe.Conditions) -> None:
    """Write conditions to a scene, in place of its own."""
    for rows, given in (
        (settings.states, conditions.states),
        (settings.weathers, conditions.weathers),
    ):
        rows.clear()
        for each in given:
            store_row(rows.add(), each)


def conditions_signature(settings: PropertyGroup) -> list[object]:
    """Return what a table of conditions depends on; empty without conditions."""
    rows = [*settings.states, None, *settings.weathers]
    used = [row and (row.name, row.table) for row in rows if row is None or row.enabled]
    return used if len(used) > 1 else []


def _state_of(row: PropertyGroup) -> geometry.State:
    return read_row(geometry.State, row, f"state {row.name!r}", name=row.name)


def _weather_of(row: PropertyGroup) -> pe.Weather:
    return read_row(pe.Weather, row, f"weather {row.name!r}", name=row.name)


def read_states(scene: Scene) -> list[str]:
    """Read the motions of all states with a frame again; return the names of those that changed.
    `InputError` when a part bends or has other triangles at a frame, or the vehicle cannot be read.
    """
    rows = [row for row in scene.perception_entropy.states if row.frame >= 0]
    if not rows:
        return []
    shown = scene.frame_current
    drawn_frame = scene.perception_entropy.drawn_frame
    changed = []
    try:
        drawn = _shown_at(scene, drawn_frame)
        for row in rows:
            moves = _motions(row.name, drawn, _shown_at(scene, row.frame))
            table = row.table
            put(row, MOVE, studies.write(moves) or None)
            if table != row.table:
                changed.append(row.name)
    finally:
        scene.frame_set(shown)
    return changed


def _shown_at(scene: Scene, frame: int) -> Shown:
    scene.frame_set(frame)
    layer = view_layer_of(scene)
    layer.update()
    collection = scene.perception_entropy.vehicle
    if collection is None:
        raise pe.InputError("scene", "vehicle", "a collection with the vehicle", "none")
    vehicle = vehicle_from_collection(collection, layer.depsgraph)
    poses = {
        obj.name: pose_of_matrix(np.array(obj.matrix_world, dtype=float))
        for obj in sensor_objects(scene)
    }
    return Shown(vehicle, poses)


def _motions(name: str, drawn: Shown, posed: Shown) -> list[geometry.Motion]:
    """Return the rigid motions from one frame to another, each with its parts and sensors."""
    parts: dict[Rigid, list[str]] = {}
    for number, part in enumerate(drawn.vehicle.part_names):
        before = drawn.vehicle.triangles[drawn.vehicle.parts == number].reshape(-1, 3)
        after = _points_of(posed.vehicle, part)
        if after is None or len(after) != len(before):
            field = f"state {name!r}: part {part!r}"
            raise pe.InputError("scene", field, "the same mesh at its frame", "another one")
        found = rigid_motion(before, after)
        if found is None:
            field = f"state {name!r}: part {part!r}"
            raise pe.InputError("scene", field, "a rigid motion", "a part that bends")
        if found != STILL:
            parts.setdefault(found, []).append(part)
    sensors: dict[Rigid, list[str]] = {}
    for sensor, pose in drawn.poses.items():
        moved = _motion_of_pose(pose, posed.poses[sensor], list(parts))
        if moved != STILL:
            sensors.setdefault(moved, []).append(sensor)
    return [
        rigid.motion(tuple(parts.get(rigid, ())), tuple(sensors.get(rigid, ())))
        for rigid in dict.fromkeys([*parts, *sensors])
    ]


def _points_of(vehicle: pe.Vehicle, part: str) -> np.ndarray | None:
    if part not in vehicle.part_names:
        return None
    number = list(vehicle.part_names).index(part)
    return vehicle.triangles[vehicle.parts == number].reshape(-1, 3)


def rigid_motion(before: np.ndarray, after: np.ndarray) -> Rigid | None:
    """Return the rigid motion of points (N, 3) [m]; None where they bend by more than `BENT_M`. The
    rotation with the least squares: Kabsch, Acta Crystallographica A32 (1976) 922."""
    if float(np.abs(after - before).max()) <= STILL_M:
        return STILL
    first = before.mean(axis=0)
    last = after.mean(axis=0)
    left, _, right = np.linalg.svd((before - first).T @ (after - last))
    sign = np.sign(np.linalg.det(right.T @ left.T))
    matrix = right.T @ np.diag([1.0, 1.0, sign]) @ left.T
    found = _rounded(matrix, last - matrix @ first)
    motion = found.motion(("part",), ())
    if float(np.abs(motion.points(before) - after).max()) > BENT_M:
        return None
    return found


def _motion_of_pose(before: pe.Pose, after: pe.Pose, motions: list[Rigid]) -> Rigid:
    """Return the motion of a sensor: that of a part where it moves as the part does."""
    for rigid in (STILL, *motions):
        moved = before if rigid == STILL else rigid.motion(("part",), ()).pose(before)
        turned = moved.ground_from_sensor - after.ground_from_sensor
        apart = np.subtract(moved.position, after.position)
        if np.abs(turned).max() <= SAME_RAD and np.abs(apart).max() <= SAME_M:
            return rigid
    matrix = after.ground_from_sensor @ before.ground_from_sensor.T
    return _rounded(matrix, np.asarray(after.position) - matrix @ np.asarray(before.position))


def _rounded(matrix: np.ndarray, move: np.ndarray) -> Rigid:
    """Return a motion with the decimals of placements."""
    degrees = [math.degrees(angle) for angle in geometry.rpy_from_matrix(matrix)]
    roll, pitch, yaw = (round(angle, ANGLE_DIGITS) + 0.0 for angle in degrees)
    x, y, z = (round(length, LENGTH_DIGITS) + 0.0 for length in move.tolist())
    return Rigid((roll, pitch, yaw), (x, y, z))
