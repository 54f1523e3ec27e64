"""The objects that rigs are judged on: drawn from the prior, set in scenes, always the same."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..prior.prior import Prior
from ..scene.frozen import frozen
from ..scene.objects import Objects
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from ..text.memory import require_memory
from .boxes import BoxSource, LabelledBoxes, ModelBoxes, StandingBoxes, labelled
from .footprints import overlap, rectangles
from .placing import kept_free, placed
from .rule import TargetRule

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

OBJECT_BYTES = 1500
"""Of an object while scenes are drawn and sensors are measured on it."""
CENTERED = 0.5
CLASS_STEP = math.sqrt(2.0) - 1.0
"""Scrambles of the classes are this far apart, modulo 1."""


@dataclass(frozen=True, slots=True, eq=False)
class DrawnObjects:
    """Objects and what each counts.

    Attributes
    ----------
    objects : Objects
        Scene after scene.
    weights : (N,) float
        Share of each in the score, summing to 1: classes share as in the prior, however many of
        each there are, and focus weights multiply.
    scenes : int
    """

    objects: Objects
    weights: Floats
    scenes: int

    @property
    def weights_by_class(self) -> Floats:
        """(C,) share of each class in the score."""
        count = len(self.objects.class_names)
        return np.bincount(self.objects.labels, self.weights, count).astype(np.float64)


def drawn_objects(
    prior: Prior,
    space: PerceptionSpace,
    vehicle: Vehicle | None,
    targets: TargetRule,
    shift: float = CENTERED,
) -> DrawnObjects:
    """Draw the objects of a study.

    Every class's objects are a low-discrepancy sample of the prior; in which scene each stands is
    by lot. Labelled boxes that do not hide each other are taken as they are, each once.

    Parameters
    ----------
    prior : Prior
    space : PerceptionSpace
        Centres of objects are in it, seen from above.
    vehicle : Vehicle, optional
        No object overlaps the rectangle round it.
    targets : TargetRule
    shift : float
        A number in [0, 1); another one draws another sample as good.

    Raises
    ------
    InputError
        When the prior has no classes or nothing tells how many of one there are, when scenes have
        no object or not all find room, when nothing has any weight, or memory does not suffice.
    """
    if prior.boxes is not None and not targets.traffic:
        boxes, labels = _each_once(prior, space, vehicle)
        scenes = np.arange(len(labels))
    else:
        boxes, labels, scenes = _in_scenes(prior, space, vehicle, targets, shift)
    objects = Objects(
        boxes.centers, boxes.sizes, boxes.yaws, labels, list(prior.class_names), scenes
    )
    return DrawnObjects(objects, frozen(_weights(prior, objects)), int(scenes.max()) + 1)


def _each_once(
    prior: Prior, space: PerceptionSpace, vehicle: Vehicle | None
) -> tuple[StandingBoxes, Ints]:
    """Return all labelled boxes in the space that do not overlap the vehicle, and their classes."""
    assert prior.boxes is not None
    require_memory("prior", "boxes", len(prior.boxes) * OBJECT_BYTES)
    each = [_beside(labelled(prior.boxes, n, space), vehicle) for n in prior.class_names]
    labels = np.repeat(np.arange(len(each)), [len(own.yaws) for own in each])
    if not len(labels):
        raise InputError(prior.boxes.source, "boxes", "a box in the space", "none")
    return StandingBoxes(*(np.concatenate(parts) for parts in zip(*each, strict=True))), labels


def _beside(boxes: StandingBoxes, vehicle: Vehicle | None) -> StandingBoxes:
    ground = rectangles(boxes.centers[:, :2], boxes.sizes, boxes.yaws)
    return boxes.some(~overlap(ground, kept_free(vehicle)))


def _in_scenes(
    prior: Prior, space: PerceptionSpace, vehicle: Vehicle | None, targets: TargetRule, shift: float
) -> tuple[StandingBoxes, Ints, Ints]:
    """Return boxes, their classes and scenes: (N, ...), scene after scene."""
    known = prior.objects_at_once(space)
    own = prior.boxes
    there = own and {n: _beside(labelled(own, n, space), vehicle) for n in known}
    counts = _counts({n: known[n] for n in known if not there or len(there[n].yaws)}, targets)
    shifts = {n: (shift + CLASS_STEP * (c + 1)) % 1.0 for c, n in enumerate(known)}
    sources: list[BoxSource]
    if there:
        sources = [LabelledBoxes(there[n], count, shifts[n]) for n, count in counts.items()]
    else:
        by_name = {c.name: c for c in prior.classes}
        sources = [ModelBoxes(by_name[n], space, k, shifts[n]) for n, k in counts.items()]
    labels = np.repeat([list(known).index(n) for n in counts], list(counts.values()))
    lots = [_lots(count, targets.scenes, shifts[n]) for n, count in counts.items()]
    scenes = np.concatenate(lots)
    ground = (space.x[1] - space.x[0]) * (space.y[1] - space.y[0])
    boxes = placed(sources, labels, scenes, kept_free(vehicle), ground, list(known))
    order = np.argsort(scenes, kind="stable")
    return boxes.some(order), labels[order], scenes[order]


def _counts(known: Mapping[str, float], targets: TargetRule) -> dict[str, int]:
    """Return how many objects of each class there are in all scenes together."""
    counts = {name: round(count * targets.scenes) for name, count in known.items()}
    total = sum(counts.values())
    if total < targets.scenes:
        expected = "at least one object in a scene, on average"
        raise InputError("prior", "density", expected, f"{total / targets.scenes:.3g}")
    require_memory("metric", "scenes", total * OBJECT_BYTES)
    return {name: count for name, count in counts.items() if count}


def _lots(count: int, scenes: int, shift: float) -> Ints:
    """(count,) the scene of each of a class's objects: every scene has as many, or one more.

    Which scenes have one more is by lot as well, another one for each class (another shift).
    """
    found = np.empty(count, np.int64)
    drawn = _by_lot(scenes, (shift + 0.5) % 1.0)
    found[_by_lot(count, shift)] = drawn[np.arange(count) * scenes // count]
    return found


def _by_lot(count: int, shift: float) -> Ints:
    """(count,) the numbers below `count` in an order that a shift in [0, 1) decides."""
    x = np.arange(count, dtype=np.uint32) + np.uint32(int(shift * (1 << 32)))
    for odd in (0x85EBCA6B, 0xC2B2AE35):  # MurmurHash3's mixing
        x = (x ^ (x >> np.uint32(16))) * np.uint32(odd)
    return np.argsort(x, kind="stable")


def _weights(prior: Prior, objects: Objects) -> Floats:
    """(N,) each object's share of the score; `InputError` when none has any."""
    shares = {c.name: c.share for c in prior.classes}
    counts = np.bincount(objects.labels, minlength=len(objects.class_names))
    weights = np.zeros(len(objects))
    for c, name in enumerate(objects.class_names):
        own = np.flatnonzero(objects.labels == c)
        x, y = objects.centers[own, 0], objects.centers[own, 1]
        weights[own] = shares.get(name, 1.0) / max(counts[c], 1) * prior.focus_at(name, x, y)
    total = float(weights.sum())
    if not 0.0 < total < math.inf:
        found = "infinitely much" if total else "none"
        raise InputError("prior", "focus", "some weight left on the objects", found)
    return np.asarray(weights / total)
