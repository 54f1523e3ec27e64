"""The placements of the study: drawn by the plan's rule, the same ones wherever it is run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core import catalog
from pe_core.geometry import Pose, rotate, rotation_matrix
from pe_core.sensors.lidar import Lidar

from ...reproduction.paper import STUDIES
from .plan import ACROSS, FIXED, MIXED, PlacementRule, StudyPlan

Floats = NDArray[np.float64]

MAX_DRAWS = 20_000
"""A rule that this many draws do not satisfy is wrong."""
NEIGHBOURHOOD_M = 0.15
"""A LiDAR on the roof is above everything within this distance."""
EDGE_M = 0.1
"""LiDARs on the roof keep this distance from the edge of the rectangle round the body."""


@dataclass(frozen=True, slots=True)
class Placement:
    """A rig on a vehicle.

    Attributes
    ----------
    name : str
        Design, vehicle and number: ``fixed-sedan-01``.
    design, vehicle : str
    channels : int
        Of each LiDAR.
    poses : tuple of (x, y, z, roll, pitch, yaw)
        Of each LiDAR [m, deg].
    all_round : bool
        Whether a point near the ground is seen in each direction.
    """

    name: str
    design: str
    vehicle: str
    channels: int
    poses: tuple[tuple[float, ...], ...]
    all_round: bool

    @property
    def lidars(self) -> int:
        """Number of LiDARs."""
        return len(self.poses)

    @property
    def mean_height(self) -> float:
        """Mean height of the LiDARs above the ground [m]."""
        return float(np.mean([pose[2] for pose in self.poses]))

    def rig(self, plan: StudyPlan) -> pe.Rig:
        """Return the rig, all LiDARs fused early."""
        model = lidar_model(plan, self.channels)
        return pe.Rig([pe.Sensor(f"lidar {k}", model, _pose(p)) for k, p in enumerate(self.poses)])


def lidar_model(plan: StudyPlan, channels: int) -> Lidar:
    """Return the LiDAR of the catalogue that the plan names for a channel count."""
    model = catalog.load(plan.hardware[channels])
    assert isinstance(model, Lidar)
    return model


def _pose(values: tuple[float, ...]) -> Pose:
    x, y, z, *angles = values
    roll, pitch, yaw = (math.radians(a) for a in angles)
    return Pose((x, y, z), (roll, pitch, yaw))


@cache
def vehicle(name: str) -> pe.Vehicle:
    """Return a vehicle that comes with the project: sedan or bus."""
    mesh = pe.read_mesh(STUDIES.parent / f"{name}.npz")
    return pe.Vehicle(mesh.triangles, mesh.parts, mesh.part_names)


def placements(plan: StudyPlan) -> list[Placement]:
    """Return all placements of the plan, design by design, vehicle by vehicle."""
    parts = plan.fixed, plan.mixed, plan.hardware
    key = plan.seed, plan.vehicles, plan.placements, plan.across, *(tuple(p.items()) for p in parts)
    if key not in _drawn:
        designs = (_fixed, _across, _mixed)
        _drawn[key] = [p for d in designs for name in plan.vehicles for p in d(plan, name)]
    return list(_drawn[key])


_drawn: dict[tuple[object, ...], list[Placement]] = {}
"""Placements that were drawn, by what they depend on: drawing takes seconds."""


def _fixed(plan: StudyPlan, name: str) -> list[Placement]:
    count = {True: plan.fixed["all_round"], False: plan.fixed["blind"]}
    drawn = _draws(plan, name, FIXED, plan.fixed["lidars"], plan.fixed["channels"])
    kept: list[Placement] = []
    for placement in drawn:
        if sum(p.all_round == placement.all_round for p in kept) < count[placement.all_round]:
            kept.append(placement)
        if len(kept) == sum(count.values()):
            break
    return _numbered(sorted(kept, key=lambda p: not p.all_round))


def _across(plan: StudyPlan, name: str) -> list[Placement]:
    kept: list[Placement] = []
    for lidars, channels, count in plan.across:
        drawn = (p for p in _draws(plan, name, ACROSS, lidars, channels) if p.all_round)
        kept += [next(drawn) for _ in range(count)]
    return _numbered(kept)


def _mixed(plan: StudyPlan, name: str) -> list[Placement]:
    """Placements of the mixed detector besides those of the fixed design; trained ones first."""
    drawn = _draws(plan, name, MIXED, plan.fixed["lidars"], plan.fixed["channels"])
    share = len(plan.vehicles)
    total = (plan.mixed["trained"] + plan.mixed["fresh"]) // share
    return _numbered([next(drawn) for _ in range(total)])


def _numbered(kept: list[Placement]) -> list[Placement]:
    return [
        Placement(f"{p.name}-{k:02}", p.design, p.vehicle, p.channels, p.poses, p.all_round)
        for k, p in enumerate(kept, 1)
    ]


def _draws(
    plan: StudyPlan, name: str, design: str, lidars: int, channels: int
) -> Iterator[Placement]:
    """Yield placements of some hardware on a vehicle, without end but for `MAX_DRAWS`."""
    keys = (plan.seed, plan.vehicles.index(name), (FIXED, ACROSS, MIXED).index(design))
    rng = np.random.default_rng([*keys, lidars, channels])
    body, rule, model = vehicle(name), plan.placements, lidar_model(plan, channels)
    pose = _pose_source(body, rule, rng)
    for _ in range(MAX_DRAWS):
        poses: list[tuple[float, ...]] = []
        while len(poses) < lidars:
            candidate = pose()
            if all(math.dist(candidate[:3], other[:3]) >= rule.apart_m for other in poses):
                poses.append(candidate)
        seen = sees_all_round(body, rule, model, poses)
        yield Placement(f"{design}-{name}", design, name, channels, tuple(poses), seen)
    raise AssertionError(f"no placement of {design} on {name} in {MAX_DRAWS} draws")


def _pose_source(
    body: pe.Vehicle, rule: PlacementRule, rng: np.random.Generator
) -> Callable[[], tuple[float, ...]]:
    """Return a function that draws a pose on the roof or at a side, rounded as in a file."""
    low, high = body.bounds
    corners = body.triangles.reshape(-1, 3)

    def roof() -> tuple[float, float, float]:
        x, y = (rng.uniform(low[k] + EDGE_M, high[k] - EDGE_M) for k in range(2))
        near = np.abs(corners[:, :2] - (x, y)).max(axis=1) <= NEIGHBOURHOOD_M
        top = _top_at(body, x, y)
        if near.any():
            top = max(top, float(corners[near, 2].max()))
        return x, y, top + rng.uniform(*rule.roof_height_m)

    def side() -> tuple[float, float, float]:
        length, width = (high - low)[:2] + 2.0 * rule.side_gap_m
        along = rng.uniform(0.0, 2.0 * (length + width))
        x0, y0 = low[0] - rule.side_gap_m, low[1] - rule.side_gap_m
        z = rng.uniform(*rule.side_height_m)
        if along < 2.0 * length:
            return x0 + along % length, y0 + width * (along >= length), z
        along -= 2.0 * length
        return x0 + length * (along >= width), y0 + along % width, z

    def pose() -> tuple[float, ...]:
        position = roof() if rng.uniform() < rule.roof_share else side()
        tilts = rng.uniform(-rule.tilt_deg, rule.tilt_deg, 2)
        rounded = [round(float(w), 3) for w in position]
        return (*rounded, *(round(float(t), 1) for t in tilts), 0.0)

    return pose


def _top_at(body: pe.Vehicle, x: float, y: float) -> float:
    """Return the height of the body's surface at a point seen from above [m]; 0 beside it."""
    start = float(body.bounds[1][2]) + 1.0
    hits = body.first_hit_from(np.array([x, y, start]), np.array([[0.0, 0.0, -1.0]]))
    distance = float(hits.distance[0])
    return start - distance if math.isfinite(distance) else 0.0


def sees_all_round(
    body: pe.Vehicle, rule: PlacementRule, model: Lidar, poses: list[tuple[float, ...]]
) -> bool:
    """Whether in each direction a point near the ground is seen by a LiDAR.

    A point is seen when the body is not between it and the LiDAR, and its elevation lies between
    the lowest and the highest channel of the LiDAR.
    """
    seen = np.zeros(rule.round_directions, bool)
    for values in poses:
        pose = _pose(values)
        for height in rule.round_heights_m:
            seen |= _visible(body, model, pose, _ring(rule, height))
    return bool(seen.all())


def _ring(rule: PlacementRule, height: float) -> Floats:
    angles = 2.0 * np.pi * np.arange(rule.round_directions) / rule.round_directions
    x, y = rule.round_distance_m * np.cos(angles), rule.round_distance_m * np.sin(angles)
    return np.stack([x, y, np.full(len(angles), height)], axis=1)


def _visible(body: pe.Vehicle, model: Lidar, pose: Pose, points: Floats) -> NDArray[np.bool_]:
    position = np.array(pose.position)
    offsets = points - position
    distance = np.sqrt((offsets**2).sum(axis=1))
    directions = offsets / distance[:, None]
    in_sensor = rotate(rotation_matrix(*pose.rpy).T, directions)
    elevation = np.arcsin(np.clip(in_sensor[:, 2], -1.0, 1.0))
    inside = (elevation >= model.elevations.min()) & (elevation <= model.elevations.max())
    free = body.first_hit(pose.position, directions).distance > distance
    return np.asarray(inside & free)


def listing(plan: StudyPlan) -> dict[str, Any]:
    """Return all placements as JSON data, for people."""
    rows = {
        p.name: {
            "lidar": plan.hardware[p.channels],
            "all_round": p.all_round,
            "x y z roll pitch yaw": [" ".join(f"{w:g}" for w in pose) for pose in p.poses],
        }
        for p in placements(plan)
    }
    return {"plan": plan.digest, "placements": rows}
