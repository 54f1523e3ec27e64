"""The placements of the study: drawn by the plan's rule, the same ones wherever it is run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_core.geometry import Pose, rotate, rotation_matrix
from pe_core.scene.rig import SensorModel
from pe_core.sensors.lidar import Lidar

from ..paper.paper import STUDIES
from ..published.scores import box_triangles
from ..results_file import Json
from .plan import ACROSS, FIXED, MIXED, PlacementRule, StudyPlan

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
PoseValues = tuple[float, ...]
"""x, y, z, roll, pitch, yaw of a sensor [m, deg], rounded as in a file."""
InView = Callable[[Floats], Mask]
"""Whether a sensor's field of view has directions (N, 3), sensor frame."""

SHUTTLE = "shuttle"
SHUTTLE_BOXES = {
    "hull": ((0.0, 0.0, 1.35), (6.0, 2.0, 2.1)),
    "pod": ((0.0, 0.0, 2.475), (1.6, 1.0, 0.25)),
}
"""Centre and size of its parts [m]: the shuttle of the benchmarks of searches."""
MAX_DRAWS = 20_000
"""A rule that this many draws do not satisfy is wrong."""
NEIGHBOURHOOD_M = 0.15
"""A LiDAR on the roof is above everything within this distance."""
EDGE_M = 0.1
"""LiDARs on the roof keep this distance from the edge of the rectangle round the body."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Where the sensors of a rig, all of one model and fused early, are on a vehicle.

    Attributes
    ----------
    name : str
        Design, vehicle and number: ``fixed-sedan-01``.
    vehicle, design : str
    poses : tuple of PoseValues
        Of each sensor.
    all_round : bool
        Whether a point near the ground is seen in each direction.
    model : str
        Its name in the catalogue; empty for cameras, whose model the plan has.
    lidar : Lidar, optional
        In place of the catalogue's model.
    """

    name: str
    vehicle: str
    poses: tuple[PoseValues, ...]
    all_round: bool
    design: str
    model: str
    lidar: Lidar | None = None

    @property
    def hardware(self) -> str:
        """Number of sensors and their model."""
        return f"{len(self.poses)} x {self.lidar.name if self.lidar else self.model}"

    @property
    def mean_height(self) -> float:
        """Mean height of the sensors above the ground [m]."""
        return float(np.mean([pose[2] for pose in self.poses]))

    def rig(self, model: SensorModel | None = None) -> pe.Rig:
        """Return the rig, with sensors of the catalogue's model or of another one."""
        model = model or self.lidar or catalog.load(self.model)
        named = enumerate(self.poses)
        return pe.Rig([pe.Sensor(f"{model.kind} {k}", model, pose_of(p)) for k, p in named])

    def listed(self) -> Json:
        """Return the placement as JSON data, for people."""
        model = {"lidar": self.model} if self.model else {}
        texts = [" ".join(f"{w:g}" for w in pose) for pose in self.poses]
        return {**model, "all_round": self.all_round, "x y z roll pitch yaw": texts}


def pose_of(values: PoseValues) -> Pose:
    """Return the pose of values that are rounded as in a file."""
    x, y, z, *angles = values
    roll, pitch, yaw = (math.radians(a) for a in angles)
    return Pose((x, y, z), (roll, pitch, yaw))


@cache
def vehicle(name: str) -> pe.Vehicle:
    """Return a vehicle that comes with the project, sedan or bus, or the shuttle of boxes."""
    if name == SHUTTLE:
        boxes = [box_triangles(center, size, 0.0) for center, size in SHUTTLE_BOXES.values()]
        parts = np.repeat(np.arange(len(boxes)), [len(b) for b in boxes]).astype(np.int32)
        return pe.Vehicle(np.concatenate(boxes), parts, tuple(SHUTTLE_BOXES))
    mesh = pt.read_mesh(STUDIES.parent / f"{name}.npz")
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


def listing(digest: str, drawn: Sequence[Placement]) -> Json:
    """Return placements as JSON data, for people."""
    return {"plan": digest, "placements": {p.name: p.listed() for p in drawn}}


def _fixed(plan: StudyPlan, name: str) -> list[Placement]:
    count = {True: plan.fixed["all_round"], False: plan.fixed["blind"]}
    drawn = _draws(plan, name, FIXED, plan.fixed["lidars"], plan.fixed["channels"])
    return numbered(first_of_each(drawn, count))


def _across(plan: StudyPlan, name: str) -> list[Placement]:
    kept: list[Placement] = []
    for lidars, channels, count in plan.across:
        drawn = (p for p in _draws(plan, name, ACROSS, lidars, channels) if p.all_round)
        kept += [next(drawn) for _ in range(count)]
    return numbered(kept)


def _mixed(plan: StudyPlan, name: str) -> list[Placement]:
    """Placements of the mixed detector besides those of the fixed design; trained ones first."""
    drawn = _draws(plan, name, MIXED, plan.fixed["lidars"], plan.fixed["channels"])
    total = (plan.mixed["trained"] + plan.mixed["fresh"]) // len(plan.vehicles)
    return numbered([next(drawn) for _ in range(total)])


def first_of_each(drawn: Iterator[Placement], count: Mapping[bool, int]) -> list[Placement]:
    """Return the first so many placements that see all round (True), and then that do not."""
    kept: list[Placement] = []
    for placement in drawn:
        if sum(p.all_round == placement.all_round for p in kept) < count[placement.all_round]:
            kept.append(placement)
        if len(kept) == sum(count.values()):
            break
    return sorted(kept, key=lambda p: not p.all_round)


def numbered(kept: Sequence[Placement]) -> list[Placement]:
    """Return placements with their number after their name."""
    return [replace(p, name=f"{p.name}-{k:02}") for k, p in enumerate(kept, 1)]


def _draws(
    plan: StudyPlan, name: str, design: str, lidars: int, channels: int
) -> Iterator[Placement]:
    """Yield placements of some hardware on a vehicle, without end but for `MAX_DRAWS`."""
    keys = (plan.seed, plan.vehicles.index(name), (FIXED, ACROSS, MIXED).index(design))
    rng = np.random.default_rng([*keys, lidars, channels])
    body, rule, model = vehicle(name), plan.placements, catalog.load(plan.hardware[channels])
    assert isinstance(model, Lidar)
    elevations = float(model.elevations.min()), float(model.elevations.max())

    def in_view(directions: Floats) -> Mask:
        elevation = np.arcsin(np.clip(directions[:, 2], -1.0, 1.0))
        return np.asarray((elevation >= elevations[0]) & (elevation <= elevations[1]))

    for poses in drawn_poses(body, rule, rng, lidars):
        seen = sees_all_round(body, rule, in_view, poses)
        yield Placement(f"{design}-{name}", name, tuple(poses), seen, design, model.name)
    raise AssertionError(f"no placement of {design} on {name} in {MAX_DRAWS} draws")


def drawn_poses(
    body: pe.Vehicle, rule: PlacementRule, rng: np.random.Generator, count: int
) -> Iterator[list[PoseValues]]:
    """Yield poses of `count` sensors that are far enough apart, `MAX_DRAWS` times."""
    pose = _pose_source(body, rule, rng)
    for _ in range(MAX_DRAWS):
        poses: list[PoseValues] = []
        while len(poses) < count:
            candidate = pose()
            if all(math.dist(candidate[:3], other[:3]) >= rule.apart_m for other in poses):
                poses.append(candidate)
        yield poses


def _pose_source(
    body: pe.Vehicle, rule: PlacementRule, rng: np.random.Generator
) -> Callable[[], PoseValues]:
    """Return a function that draws a pose on the roof or at a side, rounded as in a file."""
    low, high = body.bounds

    def roof() -> tuple[float, float, float]:
        x, y = (rng.uniform(low[k] + EDGE_M, high[k] - EDGE_M) for k in range(2))
        return x, y, top_near(body, x, y) + rng.uniform(*rule.roof_height_m)

    def side() -> tuple[float, float, float]:
        length, width = (high - low)[:2] + 2.0 * rule.side_gap_m
        along = rng.uniform(0.0, 2.0 * (length + width))
        x0, y0 = low[0] - rule.side_gap_m, low[1] - rule.side_gap_m
        z = rng.uniform(*rule.side_height_m)
        if along < 2.0 * length:
            return x0 + along % length, y0 + width * (along >= length), z
        along -= 2.0 * length
        return x0 + length * (along >= width), y0 + along % width, z

    def pose() -> PoseValues:
        position = roof() if rng.uniform() < rule.roof_share else side()
        tilts = rng.uniform(-rule.tilt_deg, rule.tilt_deg, 2)
        rounded = [round(float(w), 3) for w in position]
        return (*rounded, *(round(float(t), 1) for t in tilts), 0.0)

    return pose


def top_near(body: pe.Vehicle, x: float, y: float) -> float:
    """Return the height of the highest of the body near a point seen from above [m]."""
    corners = body.triangles.reshape(-1, 3)
    near = np.abs(corners[:, :2] - (x, y)).max(axis=1) <= NEIGHBOURHOOD_M
    return max(_top_at(body, x, y), float(corners[near, 2].max(initial=-np.inf)))


def _top_at(body: pe.Vehicle, x: float, y: float) -> float:
    """Return the height of the body's surface at a point seen from above [m]; 0 beside it."""
    start = float(body.bounds[1][2]) + 1.0
    hits = body.first_hit_from(np.array([x, y, start]), np.array([[0.0, 0.0, -1.0]]))
    distance = float(hits.distance[0])
    return start - distance if math.isfinite(distance) else 0.0


def sees_all_round(
    body: pe.Vehicle, rule: PlacementRule, in_view: InView, poses: Sequence[PoseValues]
) -> bool:
    """Whether in each direction a point near the ground is seen by a sensor, past the body."""
    seen = np.zeros(rule.round_directions, bool)
    angles = 2.0 * np.pi * np.arange(rule.round_directions) / rule.round_directions
    x, y = rule.round_distance_m * np.cos(angles), rule.round_distance_m * np.sin(angles)
    for values in poses:
        pose = pose_of(values)
        for height in rule.round_heights_m:
            ring = np.stack([x, y, np.full(len(angles), height)], axis=1)
            offsets = ring - np.array(pose.position)
            distance = np.sqrt((offsets**2).sum(axis=1))
            directions = offsets / distance[:, None]
            inside = in_view(rotate(rotation_matrix(*pose.rpy).T, directions))
            seen |= inside & (body.first_hit(pose.position, directions).distance > distance)
    return bool(seen.all())
