"""What the benchmarks work on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import pe_core as pe
from tests.engine.shapes import box, refined

BODY = ((-2.35, -0.92, 0.2), (2.35, 0.92, 0.9))
CABIN = ((-1.5, -0.7, 0.85), (0.8, 0.7, 1.45))
ROOF_LIDAR = (-0.43, 0.02, 1.83)
"""Off the grid's planes: the literal loop has no rule for beams that run along a face."""


def car(triangles: int = 20_000) -> pe.Vehicle:
    """A car of two boxes, refined to about that many triangles."""
    times = max(0, round(np.log(triangles / 24) / np.log(4)))
    parts = [refined(box(*ends), times) for ends in (BODY, CABIN)]
    names = np.repeat([0, 1], [len(p) for p in parts]).astype(np.int32)
    return pe.Vehicle(np.concatenate(parts), names, ("body", "cabin"))


def plain_study(vehicle: pe.Vehicle | None) -> pe.Study:
    """A Pandar64 on the roof, in the paper's space."""
    sensor = pe.Sensor("roof", pe.catalog.load("Pandar64"), pe.Pose(ROOF_LIDAR))
    return pe.Study(pe.Rig([sensor]), vehicle)


def two_lidars(study: pe.Study) -> pe.Study:
    """The study with a second Pandar64 on the bonnet."""
    (first,) = study.rig
    second = pe.Sensor("front", first.model, pe.Pose((1.9, 0.0, 1.2)))
    return replace(study, rig=pe.Rig([first, second]))


def two_lidars_two_cameras(study: pe.Study) -> pe.Study:
    """The study with a rig like the paper's experiment 4, fitted to the car."""
    mounted = (
        ("left", "Pandar40", (2.2, 0.8, 0.95), (0.0, 1.2, 0.0)),
        ("right", "Pandar40", (2.2, -0.8, 0.93), (0.0, 3.0, 0.0)),
        ("ahead", "Camera 30 deg", (1.0, 0.0, 1.5), (0.0, 1.4, 0.0)),
        ("behind", "Camera 60 deg", (-1.7, 0.0, 1.5), (0.0, 7.2, 180.0)),
    )
    sensors = [
        pe.Sensor(name, pe.catalog.load(model), pe.Pose.from_degrees(position, rotation))
        for name, model, position, rotation in mounted
    ]
    return replace(study, rig=pe.Rig(sensors))


def four_on_car() -> pe.Study:
    """A Pandar64 on the roof, a Pandar40 and two cameras."""
    study = plain_study(car())
    others = list(two_lidars_two_cameras(study).rig)[1:]
    return replace(study, rig=pe.Rig([*study.rig, *others]))


def moved_a_little(rig: pe.Rig, along: float) -> pe.Rig:
    """Move the first sensor forward by so many metres, without turning it."""
    first, *others = rig
    x, y, z = first.pose.position
    return pe.Rig([first.moved(pe.Pose((x + along, y, z), first.pose.rpy)), *others])


def rays_of(vehicle: pe.Vehicle) -> tuple[pe.Vehicle, np.ndarray, tuple[float, float, float]]:
    """A full Pandar64 frame from the roof."""
    return vehicle, pe.catalog.load("Pandar64").directions, ROOF_LIDAR


def grazing_camera() -> pe.Sensor:
    """A camera of 60 degrees, level, 5 cm over the car's roof."""
    camera = pe.Camera("grazing", 1920, 1080, np.radians(60.0))
    return pe.Sensor("grazing", camera, pe.Pose((-1.2, 0.02, 1.5)))


def rays_to_voxels(sensor: pe.Sensor, space: pe.PerceptionSpace) -> np.ndarray:
    """(V, 3) unit directions from a level camera to the voxels in its picture, single precision."""
    camera = sensor.model
    position = sensor.pose.position
    wide = np.tan(camera.hfov / 2.0)
    high = np.tan(camera.vfov / 2.0)
    parts = []
    for x in space.centers(0) - position[0]:
        y = space.centers(1) - position[1]
        z = space.centers(2) - position[2]
        y = y[np.abs(y) < wide * x]
        z = z[np.abs(z) < high * x]
        grid = np.stack(np.broadcast_arrays(x, *np.meshgrid(y, z)), axis=-1).reshape(-1, 3)
        size = np.sqrt(np.sum(grid * grid, axis=1, keepdims=True))
        parts.append((grid / size).astype(np.float32))
    return np.concatenate(parts)


def raw_cast(triangles: np.ndarray, position: object, directions: np.ndarray) -> np.ndarray:
    """Distances by brute force (Moller and Trumbore), a ray at a time."""
    origin = np.asarray(position)
    a = triangles[:, 0]
    e1 = triangles[:, 1] - a
    e2 = triangles[:, 2] - a
    s = origin - a
    distances = np.full(len(directions), np.inf)
    q = np.cross(s, e1)
    for i, d in enumerate(directions):
        h = np.cross(d, e2)
        det = np.sum(e1 * h, axis=1)
        inverse = 1.0 / np.where(det == 0.0, np.inf, det)  # edge-on: no hit, as t is 0 then
        u = np.sum(s * h, axis=1) * inverse
        v = (q @ d) * inverse
        t = np.sum(e2 * q, axis=1) * inverse
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        distances[i] = t[hit].min() if hit.any() else np.inf
    return distances
