"""The scenes of the study: objects of the road prior, distractors, and what else a world has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import Floats, Ints
from pe_core.prior.classes import ROAD_CLASSES, sampled_positions
from pe_core.scoring.targets import SampledObjects, TargetRule, sample_objects

from ..road.logs import CLASSES as OF_LOGS
from ..road.logs import Log, read_logs
from .placements import vehicle
from .plan import SPLITS, TOWN, Plan
from .shapes import DISTRACTORS, Ground, house_triangles, parked_cars, placed_mesh

CLASSES = tuple(c.name for c in ROAD_CLASSES)
SPACE = pe.PerceptionSpace()
NOBODY = -1
"""Owner of a triangle that belongs to no object that is to be found."""
MIN_SCENES = 8
SPREAD = 0.15
"""Standard deviation of a distractor's size, relative."""
FACTORS = (0.6, 1.4)
"""Limits of that factor."""
GAP_M = 0.2
"""Distractors keep this distance from circles round objects."""
EVERY_FRAMES = 20
"""A frame every 2 s: logs have 10 Hz."""
BOLLARD = "bollard"


@dataclass(frozen=True, slots=True)
class Things:
    """What stands in a scene: names, feet (N, 3), sizes (N, 3) [m], yaws (N,) [rad]."""

    names: list[str]
    feet: Floats
    sizes: Floats
    yaws: Floats

    @property
    def radii(self) -> Floats:
        """Radius (N,) of the circle round each, seen from above [m]."""
        return np.asarray(np.hypot(self.sizes[:, 0], self.sizes[:, 1]) / 2.0)

    def subset(self, kept: Sequence[int]) -> Things:
        """Return some of them."""
        names = [self.names[k] for k in kept]
        return Things(names, self.feet[kept], self.sizes[kept], self.yaws[kept])


@dataclass(frozen=True, slots=True)
class Scene:
    """A scene, without the vehicle."""

    triangles: Floats
    """All that beams meet besides the vehicle and flat ground (F, 3, 3) [m]."""
    owners: Ints
    """The object that each triangle belongs to, or `NOBODY`."""
    solids: Ints
    """The object, distractor or house that each triangle belongs to, from 0 up."""
    centers: Floats
    """Centres of the objects that are to be found, seen from above (N, 2) [m]."""
    labels: Ints
    """Their classes: indices into `CLASSES`."""
    flat: bool
    """Whether the ground is the plane z = 0; else it is among the triangles."""


def scene(plan: Plan, vehicle_name: str, split: str, world: str, number: int) -> Scene:
    """Return a scene of a split by its number."""
    seed = [plan.seed, plan.vehicles.index(vehicle_name), SPLITS.index(split), number]
    rng = np.random.default_rng(seed)
    objects, distractors = standing(plan, vehicle_name, split, number, rng=rng)
    if world != TOWN:
        return assembled(objects, distractors, None, [])
    ground = Ground(rng)
    occupied = _joined(objects, distractors)
    parked = _free(Things(*parked_cars(rng)), occupied, vehicle_name)
    objects = _joined(objects, parked)
    houses = house_triangles(rng, np.concatenate([occupied.feet, parked.feet])[:, :2])
    return assembled(objects, distractors, ground, houses)


def standing(
    plan: Plan, vehicle_name: str, split: str, number: int, rng: np.random.Generator
) -> tuple[Things, Things]:
    """Return the objects of a scene that are to be found, and its distractors."""
    objects = _prior_objects(plan, vehicle_name, split, number)
    return objects, _distractors(plan, vehicle_name, objects, rng)


def assembled(
    objects: Things, distractors: Things, ground: Ground | None, more: list[Floats]
) -> Scene:
    """Return the scene of objects to be found, distractors, ground (None: flat) and houses."""
    triangles = []
    owners = []
    for things, are_objects in ((objects, True), (distractors, False)):
        feet = things.feet.copy()
        if ground is not None:
            feet[:, 2] += ground.height(feet[:, 0], feet[:, 1])
        for k, name in enumerate(things.names):
            mesh = placed_mesh(name, feet[k], things.sizes[k], float(things.yaws[k]))
            triangles.append(mesh)
            owners.append(np.full(len(mesh), k if are_objects else NOBODY))
    if ground is not None:
        more = [*more, ground.triangles]
    for mesh in more:
        triangles.append(mesh)
        owners.append(np.full(len(mesh), NOBODY))
    labels = np.array([CLASSES.index(name) for name in objects.names], dtype=np.int64)
    return Scene(
        np.concatenate(triangles),
        np.concatenate(owners),
        np.repeat(np.arange(len(owners)), [len(o) for o in owners]),
        objects.feet[:, :2].copy(),
        labels=labels,
        flat=ground is None,
    )


def _prior_objects(plan: Plan, vehicle_name: str, split: str, number: int) -> Things:
    drawn = _sampled(plan.digest, vehicle_name, _count(plan, split), plan.scenes.shifts[split])
    boxes = drawn.objects
    which = np.flatnonzero(boxes.scenes == number)
    sizes = boxes.sizes[which]
    feet = boxes.centers[which] - np.column_stack([np.zeros((len(which), 2)), sizes[:, 2] / 2.0])
    return Things(
        [boxes.class_names[k] for k in boxes.labels[which]], feet, sizes, boxes.yaws[which]
    )


def _count(plan: Plan, split: str) -> int:
    """Scenes of a split that are drawn together: enough for the mixed detector, too."""
    count = plan.scenes[split]
    return max(count, plan.mixed["scenes"], MIN_SCENES) if split == SPLITS[0] else count


@lru_cache(maxsize=8)
def _sampled(digest: str, vehicle_name: str, count: int, shift: float) -> SampledObjects:
    rule = TargetRule("objects", True, max(count, MIN_SCENES))
    return sample_objects(pe.Prior.road(), SPACE, vehicle(vehicle_name), rule, shift=shift)


def _distractors(
    plan: Plan, vehicle_name: str, objects: Things, rng: np.random.Generator
) -> Things:
    count = int(rng.poisson(plan.scenes.distractors))
    kinds = list(DISTRACTORS)
    names = [kinds[k] for k in rng.integers(0, len(kinds), count)]
    x, y = sampled_positions(
        ROAD_CLASSES[1], SPACE, rng.uniform(size=count), rng.uniform(size=count)
    )
    means = np.array([DISTRACTORS[name] for name in names]).reshape(-1, 3)
    factors: Floats = np.clip(rng.normal(1.0, SPREAD, (count, 3)), *FACTORS)
    feet = np.column_stack([x, y, np.zeros(count)])
    things = Things(names, feet, means * factors, rng.uniform(0.0, np.pi, count))
    return _free(things, objects, vehicle_name)


def _free(things: Things, occupied: Things, vehicle_name: str) -> Things:
    """Return the things whose circle overlaps no other circle and not that round the vehicle."""
    low, high = vehicle(vehicle_name).bounds
    half = (high - low)[:2] / 2.0
    outside = np.maximum(np.abs(things.feet[:, :2] - (high + low)[:2] / 2.0) - half, 0.0)
    radii = things.radii + GAP_M
    free = np.hypot(outside[:, 0], outside[:, 1]) > radii
    feet = list(occupied.feet[:, :2])
    others = list(occupied.radii)
    kept = []
    for k in np.flatnonzero(free):
        distances = np.sqrt(((np.array(feet).reshape(-1, 2) - things.feet[k, :2]) ** 2).sum(axis=1))
        if (distances > np.array(others) + radii[k]).all():
            kept.append(int(k))
            feet.append(things.feet[k, :2])
            others.append(things.radii[k])
    return things.subset(kept)


def _joined(first: Things, second: Things) -> Things:
    feet, sizes, yaws = (
        np.concatenate([getattr(t, name) for t in (first, second)])
        for name in ("feet", "sizes", "yaws")
    )
    return Things([*first.names, *second.names], feet, sizes, yaws)


class Layouts:
    """The scenes of a folder of logs; calling it returns a scene, as `scenes.scene` does."""

    def __init__(self, folder: Path) -> None:
        self.logs = [log.every(EVERY_FRAMES) for log in read_logs(folder)]
        self._frames = [
            (log, int(frame)) for log in self.logs for frame in np.unique(log.objects.scenes)
        ]
        self._scenes: dict[tuple[str, int], Scene] = {}
        if not any(np.isin(log.objects.labels, _labels(CLASSES)).any() for log in self.logs):
            raise InputError(folder, "category", f"boxes of {', '.join(CLASSES)}", "none")

    def __len__(self) -> int:
        return len(self._frames)

    def __call__(self, plan: Plan, vehicle_name: str, split: str, world: str, number: int) -> Scene:
        """Return a scene by its number; plan, split and world do not matter."""
        key = vehicle_name, number
        if key not in self._scenes:
            log, frame = self._frames[number]
            objects = _things(log, frame, vehicle_name, CLASSES)
            bollards = _things(log, frame, vehicle_name, (BOLLARD,))
            self._scenes[key] = assembled(objects, bollards, None, [])
        return self._scenes[key]


def _labels(names: tuple[str, ...]) -> list[int]:
    return [OF_LOGS.index(name) for name in names]


def _things(log: Log, frame: int, vehicle_name: str, names: tuple[str, ...]) -> Things:
    """Return the boxes of some classes whose circle does not meet that round the vehicle."""
    boxes = log.objects
    wanted = (boxes.scenes == frame) & np.isin(boxes.labels, _labels(names))
    low, high = (corner[:2] for corner in vehicle(vehicle_name).bounds)
    away = np.hypot(*(boxes.centers[:, :2] - (low + high) / 2.0).T)
    radii = np.hypot(boxes.sizes[:, 0], boxes.sizes[:, 1]) / 2.0
    kept = np.flatnonzero(wanted & (away > radii + np.hypot(*(high - low)) / 2.0))
    feet = boxes.centers[kept] * (1.0, 1.0, 0.0)
    return Things(
        [OF_LOGS[k] for k in boxes.labels[kept]], feet, boxes.sizes[kept], boxes.yaws[kept]
    )
