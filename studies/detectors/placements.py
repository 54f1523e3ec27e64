"""The placements of the study: drawn by the plan's rule, the same ones wherever it is run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import permutations

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_core.base import Flags, Floats
from pe_core.geometry import Pose, rotate, rotation_matrix
from pe_core.scene.rig import SensorModel
from pe_core.sensors.camera import Camera
from pe_core.sensors.lidar import Lidar

from ..paper.paper import STUDIES
from ..published.scores import box_triangles
from ..results_file import Json
from .plan import ACROSS, CAMERAS, EQUAL_M, FIXED, FRAMES, GOOD, MIXED, SHUTTLE, Plan, full_plan

PoseValues = tuple[float, ...]
"""x, y, z, roll, pitch, yaw of a sensor [m, deg], rounded as in a file."""
InView = Callable[[Floats], Flags]
"""Whether a sensor's field of view has directions (N, 3), sensor frame."""

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
DRAWN_BY = ("seed", "vehicles", "placements", "hardware", "fixed", "across", "mixed")
"""What the placements of LiDARs depend on: drawing takes seconds."""


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


def placements(plan: Plan) -> tuple[Placement, ...]:
    """Return all placements of the plan of LiDARs, design by design, vehicle by vehicle."""
    return _drawn(Plan({key: plan[key] for key in DRAWN_BY}))


@cache
def _drawn(plan: Plan) -> tuple[Placement, ...]:
    designs = (_fixed, _across, _mixed)
    return tuple(p for d in designs for name in plan.vehicles for p in d(plan, name))


def listing(digest: str, drawn: Sequence[Placement]) -> Json:
    """Return placements as JSON data, for people."""
    return {"plan": digest, "placements": {p.name: p.listed() for p in drawn}}


def _fixed(plan: Plan, name: str) -> list[Placement]:
    drawn = _draws(plan, name, FIXED, plan.fixed.lidars, channels=plan.fixed.channels)
    return first_of_each(drawn, plan.fixed)


def _across(plan: Plan, name: str) -> list[Placement]:
    kept: list[Placement] = []
    for lidars, channels, count in plan.across.hardware:
        drawn = (p for p in _draws(plan, name, ACROSS, lidars, channels=channels) if p.all_round)
        kept += [next(drawn) for _ in range(count)]
    return numbered(kept)


def _mixed(plan: Plan, name: str) -> list[Placement]:
    """Placements of the mixed detector besides those of the fixed design; trained ones first."""
    drawn = _draws(plan, name, MIXED, plan.fixed.lidars, channels=plan.fixed.channels)
    total = (plan.mixed.trained + plan.mixed.fresh) // len(plan.vehicles)
    return numbered([next(drawn) for _ in range(total)])


def first_of_each(drawn: Iterator[Placement], rule: Plan) -> list[Placement]:
    """Return the first so many placements that see all round, and then that are blind somewhere."""
    count = {True: rule.all_round, False: rule.blind}
    kept = list[Placement]()
    for placement in drawn:
        if sum(p.all_round == placement.all_round for p in kept) < count[placement.all_round]:
            kept.append(placement)
        if len(kept) == sum(count.values()):
            break
    return numbered(sorted(kept, key=lambda p: not p.all_round))


def numbered(kept: Sequence[Placement]) -> list[Placement]:
    """Return placements with their number after their name."""
    return [replace(p, name=f"{p.name}-{k:02}") for k, p in enumerate(kept, 1)]


def _draws(plan: Plan, name: str, design: str, lidars: int, channels: int) -> Iterator[Placement]:
    """Yield placements of some hardware on a vehicle, without end but for `MAX_DRAWS`."""
    keys = (plan.seed, plan.vehicles.index(name), (FIXED, ACROSS, MIXED).index(design))
    rng = np.random.default_rng([*keys, lidars, channels])
    body = vehicle(name)
    rule = plan.placements
    model = catalog.load(plan.hardware[str(channels)])
    assert isinstance(model, Lidar)
    elevations = float(model.elevations.min()), float(model.elevations.max())

    def in_view(directions: Floats) -> Flags:
        elevation = np.arcsin(np.clip(directions[:, 2], -1.0, 1.0))
        return np.asarray((elevation >= elevations[0]) & (elevation <= elevations[1]))

    for poses in drawn_poses(body, rule, rng, lidars):
        seen = sees_all_round(body, rule, in_view, poses)
        yield Placement(
            f"{design}-{name}", name, tuple(poses), seen, design=design, model=model.name
        )
    raise AssertionError(f"no placement of {design} on {name} in {MAX_DRAWS} draws")


def drawn_poses(
    body: pe.Vehicle, rule: Plan, rng: np.random.Generator, count: int
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
    body: pe.Vehicle, rule: Plan, rng: np.random.Generator
) -> Callable[[], PoseValues]:
    """Return a function that draws a pose on the roof or at a side, rounded as in a file."""
    low, high = body.bounds

    def roof() -> tuple[float, float, float]:
        x, y = (rng.uniform(low[k] + EDGE_M, high[k] - EDGE_M) for k in range(2))
        return x, y, top_near(body, x, y) + rng.uniform(*rule.roof_height_m)

    def side() -> tuple[float, float, float]:
        length, width = (high - low)[:2] + 2.0 * rule.side_gap_m
        along = rng.uniform(0.0, 2.0 * (length + width))
        x0 = low[0] - rule.side_gap_m
        y0 = low[1] - rule.side_gap_m
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
    body: pe.Vehicle, rule: Plan, in_view: InView, poses: Sequence[PoseValues]
) -> bool:
    """Whether in each direction a point near the ground is seen by a sensor, past the body."""
    seen = np.zeros(rule.round_directions, bool)
    angles = 2.0 * np.pi * np.arange(rule.round_directions) / rule.round_directions
    x = rule.round_distance_m * np.cos(angles)
    y = rule.round_distance_m * np.sin(angles)
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


# Cameras.


@cache
def camera_model(rig: Plan) -> Camera:
    """Return the model of all cameras of a plan's rig."""
    return Camera("study camera", rig.width_px, rig.height_px, math.radians(rig.hfov_deg))


def camera_placements(plan: Plan) -> tuple[Placement, ...]:
    """Return all placements of the plan of cameras: those that see all round first."""
    return _drawn_cameras(plan.cameras)


@cache
def _drawn_cameras(own: Plan) -> tuple[Placement, ...]:
    return tuple(first_of_each(_camera_draws(own), own.rig))


def _camera_draws(own: Plan) -> Iterator[Placement]:
    name = own.rig.vehicle
    count = own.rig.cameras
    model = camera_model(own.rig)
    rng = np.random.default_rng([own.seed, count])
    body = vehicle(name)
    rule = own.placements

    def in_view(directions: Floats) -> Flags:
        return in_picture(model, directions)[2]

    for poses in drawn_poses(body, rule, rng, count):
        yaws = rng.uniform(0.0, 90.0) + np.arange(count) * 360.0 / count
        yaws += rng.uniform(-rule.yaw_deg, rule.yaw_deg, count)
        turned = tuple(_looking_outwards(body.bounds, poses, yaws))
        seen = sees_all_round(body, rule, in_view, turned)
        yield Placement(f"{CAMERAS}-{name}", name, turned, seen, design=CAMERAS, model="")
    raise AssertionError(f"no placement of cameras on {name}")


def _looking_outwards(
    bounds: tuple[Floats, Floats], poses: Sequence[PoseValues], yaws: Floats
) -> list[PoseValues]:
    """Return poses with the yaws [deg] given to them so that the cameras look outwards.

    Of all orders of the yaws, that with the highest sum of the positions' components along the
    directions; positions are relative to the body's middle and in halves of its sides.
    """
    low, high = (np.asarray(b)[:2] for b in bounds)
    places = (np.array([p[:2] for p in poses]) - (low + high) / 2.0) / ((high - low) / 2.0)
    gain = places @ np.stack([np.cos(np.radians(yaws)), np.sin(np.radians(yaws))])
    cameras = range(len(poses))
    best = max(permutations(cameras), key=lambda order: sum(gain[k, order[k]] for k in cameras))
    wrapped = [round(float((yaws[k] + 180.0) % 360.0 - 180.0), 1) for k in best]
    return [(*pose[:5], yaw) for pose, yaw in zip(poses, wrapped, strict=True)]


def in_picture(model: Camera, directions: Floats) -> tuple[Floats, Floats, Flags]:
    """Return where directions (..., 3), sensor frame, are: column, row [px], and whether inside.

    Columns and rows are counted from the upper left corner.
    """
    depth, left, up = np.moveaxis(directions, -1, 0)
    columns, rows = model.projection.project(depth, left, up)
    inside = (depth > 0.0) & (columns >= 0.0) & (columns < model.width)
    return columns, rows, inside & (rows >= 0.0) & (rows < model.height)


# Frames, and the second plan.


def frames_placements(plan: Plan) -> list[Placement]:
    """Return the first placements of the first plan's design *mixed*, vehicles by turns."""
    drawn = [p for p in placements(full_plan()) if p.design == MIXED]
    each = plan.frames.each
    groups = [[p for p in drawn if p.vehicle == name][:each] for name in plan.vehicles]
    turns = zip(*groups, strict=True)
    return [_renamed(p, MIXED, FRAMES) for turn in turns for p in turn]


def _renamed(placement: Placement, before: str, after: str) -> Placement:
    return replace(placement, name=placement.name.replace(before, after), design=after)


@cache
def _good(each: int) -> tuple[Placement, ...]:
    first = full_plan()
    known = first.fixed.all_round
    drawn = placements(first.but(fixed={"all_round": known + each, "blind": 0}))
    return tuple(
        replace(p, name=f"{GOOD}-{name}-{k:02}", design=GOOD)
        for name in first.vehicles
        for k, p in enumerate(
            [p for p in drawn if p.design == FIXED and p.vehicle == name][known:], 1
        )
    )


def good_placements(plan: Plan) -> tuple[Placement, ...]:
    """Return the placements of part 1 of the second plan: the sedan's, then the bus's."""
    return _good(plan.second.good.each)


def arm_placements(plan: Plan) -> list[Placement]:
    """Return the placements of part 2: the same poses for each number of rows."""
    rule = plan.second.equal_m
    first = [p for p in good_placements(plan) if int(p.name[-2:]) <= rule.each]
    return [
        replace(_renamed(p, GOOD, f"{EQUAL_M}-{rows}"), design=EQUAL_M, lidar=arm_lidar(rule, rows))
        for p in first
        for rows in rule.rows
    ]


@cache
def arm_lidar(rule: Plan, rows: int) -> Lidar:
    """Return the LiDAR of so many rows: all have the same number of beams."""
    columns = rule.beams // rows
    top = math.radians(rule.elevation_deg)
    elevations = np.linspace(-top, top, rows)
    return Lidar(f"{rows} x {columns}", elevations, columns, rule.max_range_m)
