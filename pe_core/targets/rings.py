"""How far a class is found, by direction: lone objects of its mean size in rings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.objects import Objects
from ..scene.vehicle import Vehicle
from ..scoring.object_score import FARTHEST_M
from ..scoring.score import rounded
from .drawing import DrawnObjects
from .footprints import overlap, rectangles
from .placing import kept_free

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SECTORS = (
    *("front", "front left", "left", "rear left"),
    *("rear", "rear right", "right", "front right"),
)
"""Eighths of the circle, round the middle that each is called by."""
RING_M = 5.0
RINGS = int(FARTHEST_M / RING_M)
EACH = 8
"""Objects of a class in a sector of a ring, spread over its depth and its angle."""
FOUND_AP = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class RingObjects:
    """Objects in rings: `cells` (N,) has the class, sector and ring of each, in one number."""

    objects: Objects
    cells: Ints


def ring_objects(drawn: DrawnObjects, vehicle: Vehicle | None) -> RingObjects:
    """Return lone objects in every sector and ring, but for those that overlap the vehicle.

    Each class has the mean size, the mean height above the ground and the headings of its objects.
    """
    per_class = len(SECTORS) * RINGS * EACH
    middles = _places()
    found = []
    for c in range(len(drawn.objects.class_names)):
        own = np.flatnonzero(drawn.objects.labels == c)
        if not len(own):
            continue
        z = np.full((per_class, 1), np.mean(drawn.objects.centers[own, 2]))
        sizes = np.broadcast_to(np.mean(drawn.objects.sizes[own], axis=0), (per_class, 3))
        yaws = drawn.objects.yaws[own[np.arange(per_class) % len(own)]]
        cells = c * len(SECTORS) * RINGS + np.arange(per_class) // EACH
        found.append((np.hstack([middles, z]), sizes, yaws, cells))
    centers, sizes, yaws, cells = (np.concatenate(each) for each in zip(*found, strict=True))
    beside = ~overlap(rectangles(centers[:, :2], sizes, yaws), kept_free(vehicle))
    labels = cells // (len(SECTORS) * RINGS)
    kept = [values[beside] for values in (centers, sizes, yaws)]
    objects = Objects(kept[0], kept[1], kept[2], labels[beside], drawn.objects.class_names)
    return RingObjects(objects, cells[beside])


def reach(
    rings: RingObjects, label: int, ap: Floats, least: float = FOUND_AP
) -> Mapping[str, float]:
    """Return how far a class is found, by direction [m]; `ap` (N,) is that of the ring objects."""
    count = len(rings.objects.class_names) * len(SECTORS) * RINGS
    there = np.bincount(rings.cells, minlength=count).reshape(-1, len(SECTORS), RINGS)[label]
    sums = np.bincount(rings.cells, ap, count).reshape(-1, len(SECTORS), RINGS)[label]
    means = np.where(there > 0, sums / np.maximum(there, 1), 0.0)
    each = zip(SECTORS, means, strict=True)
    return {name: rounded(_reach(own.tolist(), least)) for name, own in each}


def _reach(means: list[float], least: float = FOUND_AP) -> float:
    """Return where the mean AP of rings falls below `least`, from the first in which it is not.

    Between the middles of two rings it runs straight.
    """
    first = next((k for k, ap in enumerate(means) if ap >= least), None)
    if first is None:
        return 0.0
    last = next((k for k in range(first, RINGS) if means[k] < least), None)
    if last is None:
        return FARTHEST_M
    above, below = means[last - 1], means[last]
    return RING_M * (last - 0.5 + (above - least) / (above - below))


def _places() -> Floats:
    """(N, 2) middles of a class's objects, sector after sector, ring after ring."""
    rows = []
    for sector in range(len(SECTORS)):
        for ring in range(RINGS):
            for k in range(EACH):
                radius = RING_M * (ring + (k + 0.5) / EACH)
                turn = sector - 0.5 + (_mirrored(k) + 0.5) / EACH
                angle = 2.0 * math.pi * turn / len(SECTORS)
                rows.append((radius * math.cos(angle), radius * math.sin(angle)))
    return np.round(np.array(rows), 4)


def _mirrored(k: int) -> int:
    """Mirror three bits: neighbours in depth are far apart in angle."""
    return (k & 1) << 2 | (k & 2) | k >> 2
