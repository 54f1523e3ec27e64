"""What a study scores rigs on: the voxels of the paper, or objects sampled from its prior.

Objects are placed in scenes.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Floats, Ints, join_columns, read_only
from ...base.errors import InputError
from ...base.setting import FLAG, OneOf, Panel, check_settings, setting
from ...base.values import Whole
from ...geometry.grids import PerceptionSpace
from ...prior.prior import Prior
from ...scene.objects import Objects
from ...scene.vehicle import Vehicle
from .scene_layout import (
    BoxSource,
    LabelledBoxes,
    LaidOutBoxes,
    ModelBoxes,
    ground_rectangles,
    labelled_boxes,
    overlap,
    place_boxes,
    vehicle_rectangle,
)

VOXELS = "voxels"
OBJECTS = "objects"
TARGETS = (VOXELS, OBJECTS)
MENU = (
    ("Voxels", "How well each voxel is measured: perception entropy, as in the paper"),
    ("Objects", "How well objects of the prior are detected: expected AP, and range"),
)
"""How Blender's panel shows `TARGETS`."""
SCENES = 256  # The default; it gives a standard error of about 0.1 nats on the road
COUNT = Whole(8, 20_000, "scenes")
"""More would take minutes and gigabytes for a standard error below 0.01 nats."""
MAX_OBJECTS = 2_000_000
"""Objects in all scenes together: 3 GB while sensors are measured on them."""
CENTERED = 0.5
CLASS_STEP = math.sqrt(2.0) - 1.0
"""Difference between the scrambles of two classes, modulo 1."""


@dataclass(frozen=True, slots=True)
class TargetRule:
    """The targets of a score, and how objects are placed.

    `InputError` when a value is not valid, or traffic is requested for voxels.
    """

    targets: str = setting(
        VOXELS,
        OneOf(TARGETS),
        "What a rig is scored on: all voxels, or objects of the prior",
        Panel("targets", "Targets", menu=MENU),
        scored=True,
    )
    traffic: bool = setting(
        False,
        FLAG,
        "Objects of a scene occlude each other from every sensor",
        Panel("traffic", "Traffic", when="targets=objects"),
        scored=True,
    )
    scenes: int = setting(
        SCENES,
        COUNT,
        "Number of scenes with objects; the expected score is their mean",
        Panel("scenes", "Scenes", soft_max=4096, when="targets=objects"),
        scored=True,
    )

    def __post_init__(self) -> None:
        check_settings(self, "metric")
        if self.traffic and not self.are_objects:
            raise InputError("metric", "traffic", f"targets = {OBJECTS!r} with it", self.targets)

    @property
    def are_objects(self) -> bool:
        """Whether objects are scored, not voxels."""
        return self.targets == OBJECTS


@dataclass(frozen=True, slots=True, eq=False)
class SampledObjects:
    """Objects, sorted by scene, and their weights in the score. `weights` (N,) sum to 1: classes
    share as in the prior, however many of each there are, and focus weights multiply. `scenes` is
    the number of scenes."""

    objects: Objects
    weights: Floats
    scenes: int

    @property
    def weights_by_class(self) -> Floats:
        """Share of each class in the score, (C,)."""
        count = len(self.objects.class_names)
        return np.bincount(self.objects.labels, self.weights, count).astype(np.float64)


def sample_objects(
    prior: Prior,
    space: PerceptionSpace,
    vehicle: Vehicle | None,
    targets: TargetRule,
    shift: float = CENTERED,
) -> SampledObjects:
    """Sample the objects of a study.

    The objects of each class are a low-discrepancy sample of the prior; their scenes are random.
    Without traffic, labelled boxes are taken as they are, each once.

    Their centres are in the space, seen from above, and none overlaps the vehicle's rectangle on
    the ground. `shift` is in [0, 1); another one gives another sample of the same quality.

    `InputError` when the prior has no classes or no number of objects for one, when scenes have no
    object or no room for all, or when no object has any weight.
    """
    if prior.boxes is not None and not targets.traffic:
        boxes, labels = _each_once(prior, space, vehicle)
        scenes = np.arange(len(labels))
    else:
        boxes, labels, scenes = _in_scenes(prior, space, vehicle, targets, shift=shift)
    objects = Objects(
        boxes.centers,
        boxes.sizes,
        boxes.yaws,
        labels,
        class_names=list(prior.class_names),
        scenes=scenes,
    )
    return SampledObjects(objects, read_only(_weights(prior, objects)), int(scenes.max()) + 1)


def _each_once(
    prior: Prior, space: PerceptionSpace, vehicle: Vehicle | None
) -> tuple[LaidOutBoxes, Ints]:
    """Return all labelled boxes in the space that do not overlap the vehicle, and their classes."""
    assert prior.boxes is not None
    by_class = [labelled_boxes(prior.boxes, name, space) for name in prior.class_names]
    by_class = [_beside_vehicle(boxes, vehicle) for boxes in by_class]
    labels = np.repeat(np.arange(len(by_class)), [len(boxes.yaws) for boxes in by_class])
    if not len(labels):
        raise InputError(prior.boxes.source, "boxes", "a box in the space", "none")
    return LaidOutBoxes(*join_columns(by_class)), labels


def _beside_vehicle(boxes: LaidOutBoxes, vehicle: Vehicle | None) -> LaidOutBoxes:
    ground = ground_rectangles(boxes.centers[:, :2], boxes.sizes, boxes.yaws)
    return boxes.subset(~overlap(ground, vehicle_rectangle(vehicle)))


def _in_scenes(
    prior: Prior, space: PerceptionSpace, vehicle: Vehicle | None, targets: TargetRule, shift: float
) -> tuple[LaidOutBoxes, Ints, Ints]:
    """Return boxes, their classes and scenes: (N, ...), scene after scene."""
    at_once = prior.objects_at_once(space)
    boxes_of = prior.boxes and {
        name: _beside_vehicle(labelled_boxes(prior.boxes, name, space), vehicle) for name in at_once
    }
    has_boxes = [name for name in at_once if not boxes_of or len(boxes_of[name].yaws)]
    counts = _counts({name: at_once[name] for name in has_boxes}, targets)
    shifts = {n: (shift + CLASS_STEP * (c + 1)) % 1.0 for c, n in enumerate(at_once)}
    sources: list[BoxSource]
    if boxes_of:
        sources = [LabelledBoxes(boxes_of[n], count, shifts[n]) for n, count in counts.items()]
    else:
        by_name = {c.name: c for c in prior.classes}
        sources = [ModelBoxes(by_name[n], space, k, shifts[n]) for n, k in counts.items()]
    labels = np.repeat([list(at_once).index(n) for n in counts], list(counts.values()))
    by_class = [_random_scenes(k, targets.scenes, shifts[n]) for n, k in counts.items()]
    scenes = np.concatenate(by_class)
    ground = (space.x[1] - space.x[0]) * (space.y[1] - space.y[0])
    boxes = place_boxes(
        sources, labels, scenes, vehicle_rectangle(vehicle), ground_m2=ground, names=list(at_once)
    )
    order = np.argsort(scenes, kind="stable")
    return boxes.subset(order), labels[order], scenes[order]


def _counts(at_once: Mapping[str, float], targets: TargetRule) -> dict[str, int]:
    """Return how many objects of each class there are in all scenes together."""
    counts = {name: round(count * targets.scenes) for name, count in at_once.items()}
    total = sum(counts.values())
    if total < targets.scenes:
        expected = "at least one object in a scene, on average"
        raise InputError("prior", "density", expected, f"{total / targets.scenes:.3g}")
    if total > MAX_OBJECTS:
        raise InputError(
            "prior", "density", f"at most {MAX_OBJECTS:,} objects in all scenes", total
        )
    return {name: count for name, count in counts.items() if count}


def _random_scenes(count: int, scenes: int, shift: float) -> Ints:
    """Return the scene of each of a class's objects, (count,): each scene has as many, or one more.
    Which scenes have one more is random, and differs from class to class (another shift)."""
    numbers = np.empty(count, np.int64)
    order = _permutation(scenes, (shift + 0.5) % 1.0)
    numbers[_permutation(count, shift)] = order[np.arange(count) * scenes // count]
    return numbers


def _permutation(count: int, shift: float) -> Ints:
    """Return a permutation of the numbers below `count`, (count,), seeded by a shift in [0, 1)."""
    x = np.arange(count, dtype=np.uint32) + np.uint32(int(shift * (1 << 32)))
    for odd in (0x85EBCA6B, 0xC2B2AE35):  # MurmurHash3's mixing
        x = (x ^ (x >> np.uint32(16))) * np.uint32(odd)
    return np.argsort(x, kind="stable")


def _weights(prior: Prior, objects: Objects) -> Floats:
    """Return each object's share of the score, (N,); `InputError` when all have none."""
    shares = {c.name: c.share for c in prior.classes}
    counts = np.bincount(objects.labels, minlength=len(objects.class_names))
    weights = np.zeros(len(objects))
    for c, name in enumerate(objects.class_names):
        of_class = np.flatnonzero(objects.labels == c)
        x = objects.centers[of_class, 0]
        y = objects.centers[of_class, 1]
        weights[of_class] = shares.get(name, 1.0) / max(counts[c], 1) * prior.focus_at(name, x, y)
    total = float(weights.sum())
    if not 0.0 < total < math.inf:
        found = "infinitely much" if total else "none"
        raise InputError("prior", "focus", "some weight left on the objects", found)
    return np.asarray(weights / total)
