"""Lone objects: how far each class is found by a rig where only the vehicle occludes it.

Objects of a class's mean size stand in rings round the vehicle, in eight sectors.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Floats, Ints
from ...base.values import rounded
from ...metric.entropy import ap_of_entropy
from ...scene.objects import Objects
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import ObjectMeasurementCache, PerceptionModel
from ..score import FARTHEST_M
from .object_metric import FusedObjects
from .object_sampling import SampledObjects
from .scene_layout import ground_rectangles, overlap, vehicle_rectangle

SECTORS = (
    *("front", "front left", "left", "rear left"),
    *("rear", "rear right", "right", "front right"),
)
"""Eighths of the circle, each centred on the direction that it is named after."""
RING_M = 5.0
RINGS = int(FARTHEST_M / RING_M)
PER_CELL = 8
"""Objects of a class in a sector of a ring, spread over its depth and its angle."""
FOUND_AP = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class RingObjects:
    """Objects in rings: `cells` (N,) numbers the class, sector and ring of each object."""

    objects: Objects
    cells: Ints


def ring_objects(drawn: SampledObjects, vehicle: Vehicle | None) -> RingObjects:
    """Return lone objects in every sector and ring, without those that overlap the vehicle.

    Each class has the mean size, the mean height above the ground and the headings of its objects.
    """
    per_class = len(SECTORS) * RINGS * PER_CELL
    positions = _positions()
    by_class = []
    for c in range(len(drawn.objects.class_names)):
        members = np.flatnonzero(drawn.objects.labels == c)
        if not len(members):
            continue
        z = np.full((per_class, 1), np.mean(drawn.objects.centers[members, 2]))
        sizes = np.broadcast_to(np.mean(drawn.objects.sizes[members], axis=0), (per_class, 3))
        yaws = drawn.objects.yaws[members[np.arange(per_class) % len(members)]]
        cells = c * len(SECTORS) * RINGS + np.arange(per_class) // PER_CELL
        by_class.append((np.hstack([positions, z]), sizes, yaws, cells))
    centers, sizes, yaws, cells = (np.concatenate(arrays) for arrays in zip(*by_class, strict=True))
    beside = ~overlap(ground_rectangles(centers[:, :2], sizes, yaws), vehicle_rectangle(vehicle))
    labels = cells // (len(SECTORS) * RINGS)
    placed = [values[beside] for values in (centers, sizes, yaws)]
    objects = Objects(placed[0], placed[1], placed[2], labels[beside], drawn.objects.class_names)
    return RingObjects(objects, cells[beside])


def reach(
    rings: RingObjects, label: int, ap: Floats, min_ap: float = FOUND_AP
) -> Mapping[str, float]:
    """Return how far a class is found, by direction [m]; `ap` (N,) is that of the ring objects."""
    count = len(rings.objects.class_names) * len(SECTORS) * RINGS
    counts = np.bincount(rings.cells, minlength=count).reshape(-1, len(SECTORS), RINGS)[label]
    sums = np.bincount(rings.cells, ap, count).reshape(-1, len(SECTORS), RINGS)[label]
    means = np.where(counts > 0, sums / np.maximum(counts, 1), 0.0)
    by_sector = zip(SECTORS, means, strict=True)
    return {name: rounded(_reach(values.tolist(), min_ap)) for name, values in by_sector}


def _reach(means: list[float], min_ap: float = FOUND_AP) -> float:
    """Return where the mean AP falls below `min_ap`, after the first ring where it is not below.

    Between the middles of two rings it is interpolated linearly.
    """
    first = next((k for k, ap in enumerate(means) if ap >= min_ap), None)
    if first is None:
        return 0.0
    last = next((k for k in range(first, RINGS) if means[k] < min_ap), None)
    if last is None:
        return FARTHEST_M
    above, below = means[last - 1], means[last]
    return RING_M * (last - 0.5 + (above - min_ap) / (above - below))


def _positions() -> Floats:
    """Return the centres (N, 2) of a class's objects, sector after sector, ring after ring."""
    rows = []
    for sector in range(len(SECTORS)):
        for ring in range(RINGS):
            for k in range(PER_CELL):
                radius = RING_M * (ring + (k + 0.5) / PER_CELL)
                mirrored = (k & 1) << 2 | (k & 2) | k >> 2  # neighbours in depth are far in angle
                turn = sector - 0.5 + (mirrored + 0.5) / PER_CELL
                angle = 2.0 * math.pi * turn / len(SECTORS)
                rows.append((radius * math.cos(angle), radius * math.sin(angle)))
    return np.round(np.array(rows), 4)


class LoneObjects:
    """Objects of every class of a study, alone in rings round the vehicle.

    They have the mean sizes of the `drawn` objects by class. A sensor that has not moved is not
    measured again.
    """

    def __init__(
        self, drawn: SampledObjects, vehicle: Vehicle | None, model: PerceptionModel
    ) -> None:
        self._rings = ring_objects(drawn, vehicle)
        counted = drawn.weights_by_class[self._rings.objects.labels]
        self._fused = FusedObjects(self._rings.objects, counted, model)
        self._sensors = ObjectMeasurementCache(self._rings.objects, vehicle, False)
        self.class_names = tuple(drawn.objects.class_names)

    def ap(self, rig: Rig, members: Collection[str] | None = None) -> Floats:
        """Return the AP (N,) of each object, for the whole rig or the sensors named by `members`.

        `InputError` when a sensor has a curve of its own, or a class has none.
        """
        self._fused.check(rig)
        entropies, _ = self._fused.entropies(rig, self._sensors.measure(rig), members)
        return ap_of_entropy(entropies)

    def reach(self, class_name: str, ap: Floats, min_ap: float = FOUND_AP) -> Mapping[str, float]:
        """Return how far a class is found with an AP of at least `min_ap`, by direction [m].

        `ap` is that of `LoneObjects.ap`. 0 in every direction for a class without objects.
        """
        if class_name not in self.class_names:
            return dict.fromkeys(SECTORS, 0.0)
        return reach(self._rings, self.class_names.index(class_name), ap, min_ap)
