"""The metric on objects: eqs. 4 to 9 with the AP curve of each class, and standard errors.

Lone objects say how far each class is found by a rig where only the vehicle occludes it. Objects of
a class's mean size stand in rings round the vehicle, in eight sectors.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints, join_columns
from ...base.errors import InputError
from ...base.values import rounded
from ...metric.entropy import H_BLIND, OwnCurve, ap_of_entropy
from ...metric.fusion import Fusion, early_fusion
from ...scene.objects import Objects
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import ObjectMeasurementCache, PerceptionModel
from ..score import (
    ALIKE,
    BY_DISTANCE,
    FARTHEST_M,
    POINTS,
    FigureKey,
    FoundClass,
    ObjectScore,
    PartScore,
    Scatter,
    TrafficAp,
    residuals,
    sample_digest,
    unseen_error,
    zone_masks,
)
from .object_sampling import SampledObjects
from .scene_layout import ground_rectangles, overlap, vehicle_rectangle

BATCHES = 32
"""Number of batches of scenes, for the errors of differences; fewer for fewer scenes."""
Bools = NDArray[np.bool_]
SECTORS = ("front", "front left", "left", "rear left", "rear", "rear right", "right", "front right")
"""Eighths of the circle, each centred on the direction that it is named after."""
RING_M = 5.0
RINGS = int(FARTHEST_M / RING_M)
PER_CELL = 8
"""Objects of a class in a sector of a ring, spread over its depth and its angle."""
FOUND_AP = 0.5


class FusedObjects:
    """Fuses measurements of objects by a perception model; objects without weight are left out."""

    def __init__(self, objects: Objects, weights: Floats, model: PerceptionModel) -> None:
        self._model = model
        self._count = len(objects)
        self._distance = np.hypot(*objects.centers[:, :2].T)
        self._rows = {
            name: rows
            for c, name in enumerate(objects.class_names)
            if len(rows := np.flatnonzero((objects.labels == c) & (weights > 0.0)))
        }
        self._fusion = {name: Fusion(model.of_class(name)) for name in self._rows}

    def check(self, rig: Rig) -> None:
        """Raise `InputError` for a sensor with a curve of its own, or a class without one."""
        for sensor in rig:
            if sensor.curve is not None:
                expected = f"none: objects have curves by class, [ap.objects.{sensor.kind}.CLASS]"
                raise InputError(f"sensor {sensor.name!r}", "ap", expected, "a curve of voxels")
            for name in self._rows:
                self._model.object_curve(sensor.kind, name)

    def entropies(
        self, rig: Rig, m: Mapping[str, Floats], members: Collection[str] | None = None
    ) -> tuple[Floats, NDArray[np.bool_]]:
        """Return the entropy (N,) of each object [nats], and whether any fusion group detects it.
        `members` names the sensors that are fused; all, by default."""
        entropies = np.full(self._count, H_BLIND)
        visible = np.zeros(self._count, bool)
        groups = []  # kind and sum (N,) of each fusion group, eq. 6
        for sensors in rig.groups.values():
            present = [m[s.name] for s in sensors if members is None or s.name in members]
            if present:
                groups.append((sensors[0].kind, early_fusion(present)))
        if not groups:
            return entropies, visible
        for name, rows in self._rows.items():
            fusion = self._fusion[name]
            measured = [
                (OwnCurve(kind, self._model.object_curve(kind, name)), total[rows])
                for kind, total in groups
            ]
            ranged = fusion.ranged(measured, self._distance[rows])
            entropies[rows], visible[rows] = fusion.entropies(ranged)
        return entropies, visible


class ObjectSums:
    """Means over the objects: all of them, by class, by zone."""

    def __init__(self, drawn: SampledObjects) -> None:
        self._objects = drawn.objects
        self._weights = drawn.weights
        self._drawn = drawn
        x = drawn.objects.centers[:, 0]
        y = drawn.objects.centers[:, 1]
        self._zones = {n: mask for n, mask in zone_masks(x, y).items() if self._mass(mask) > 0.0}
        self._classes = {
            name: mask
            for c, name in enumerate(drawn.objects.class_names)
            if self._mass(mask := drawn.objects.labels == c) > 0.0
        }

    def part(self, entropies: Floats, visible: Bools, mask: Bools | None = None) -> PartScore:
        """Return mean entropy (eq. 9) and coverage of the objects in a mask, and their share."""
        weights = self._weights if mask is None else self._weights * mask
        mass = float(weights.sum())
        entropy, coverage = (float((v * weights).sum()) / mass for v in (entropies, visible))
        return PartScore(rounded(entropy), rounded(coverage), rounded(mass))

    def classes(self, entropies: Floats, visible: Bools) -> dict[str, PartScore]:
        """Return the score of each class that has any weight."""
        return {name: self.part(entropies, visible, mask) for name, mask in self._classes.items()}

    def zones(self, entropies: Floats, visible: Bools) -> dict[str, PartScore]:
        """Return the score of each zone, of the objects whose centres are in it."""
        return {name: self.part(entropies, visible, mask) for name, mask in self._zones.items()}

    def standard_error(self, entropies: Floats, groups: int, mask: Bools | None = None) -> float:
        """Standard error of the mean entropy, from the scatter of the scenes' means.

        Classes are low-discrepancy samples across the scenes, so this overestimates the error.
        If all objects have equal entropy, it is half of the bound of `SampledScorer`, which follows
        from the rule of three.
        """
        values = entropies if mask is None else entropies[mask]
        if np.ptp(values) <= ALIKE:
            return unseen_error(groups, len(values))
        return self._scatter(entropies, mask)

    def object_score(
        self,
        entropies: Floats,
        points: Sequence[Floats],
        reach: Callable[[str], Mapping[str, float]],
        traffic: bool,
    ) -> ObjectScore:
        """Return the part of a score that only objects have. `points` are m of the LiDARs; `reach`
        returns how far lone objects of a class are found."""
        ap = ap_of_entropy(entropies)
        total = np.sum(points, axis=0) if points else None
        per_class = {}
        for name, mask in self._classes.items():
            per_class[name] = FoundClass(
                objects=int(mask.sum()),
                share=rounded(self._mass(mask)),
                entropy=rounded(self._mean(entropies, mask)),
                stderr=self.standard_error(entropies, max(len(points), 1), mask),
                ap=rounded(self._mean(ap, mask)),
                ap_stderr=self._scatter(ap, mask),
                points={} if total is None else self._shares(total, mask),
                reach=reach(name),
            )
        return ObjectScore(
            self.expected_ap(entropies),
            self._scatter(ap, None),
            len(ap),
            self._drawn.scenes,
            traffic=traffic,
            per_class=per_class,
        )

    def expected_ap(self, entropies: Floats) -> float:
        """Return the expected AP of all objects, by their weights."""
        return rounded(self._mean(ap_of_entropy(entropies), None))

    def by_ring(self, entropies: Floats) -> TrafficAp:
        """Return the expected AP of all objects and of those in each ring."""
        ap = ap_of_entropy(entropies)
        rings = {
            name: (rounded(self._mean(ap, mask)), self._scatter(ap, mask))
            for name, mask in self._zones.items()
            if name in BY_DISTANCE
        }
        batch, batches = self._batches
        parts = {("rig", ""): np.ones(len(ap), bool)}
        parts |= {("zone", name): self._zones[name] for name in rings}
        by_figure: dict[FigureKey, tuple[float, ...]] = {
            (*part, "ap"): residuals(ap, self._weights * mask, batch, batches)
            for part, mask in parts.items()
        }
        return TrafficAp(
            rounded(self._mean(ap, None)),
            self._scatter(ap, None),
            self._drawn.scenes,
            rings,
            scatter=Scatter(self._digest, by_figure),
        )

    @cached_property
    def _batches(self) -> tuple[Ints, int]:
        """The batch of scenes of each object (N,), and the number of batches."""
        scenes = self._drawn.scenes
        batches = min(BATCHES, scenes)
        return self._objects.scenes * batches // scenes, batches

    def residuals(self, entropies: Floats) -> tuple[float, ...]:
        """Return what each batch of scenes adds to the mean entropy, above it (`Scatter`)."""
        batch, batches = self._batches
        return residuals(entropies, self._weights, batch, batches)

    def residuals_of_ap(self, entropies: Floats) -> tuple[float, ...]:
        """Return what each batch of scenes adds to the expected AP, above it."""
        return self.residuals(ap_of_entropy(entropies))

    def scatter(self, entropies: Floats, visible: Bools) -> Scatter:
        """Return residuals by batch of scenes: entropy and coverage of all parts, AP of classes."""
        batch, batches = self._batches
        measures = {
            "entropy": entropies,
            "coverage": visible.astype(float),
            "ap": ap_of_entropy(entropies),
        }
        parts = {("rig", ""): np.ones(len(entropies), bool)}
        parts |= {("zone", name): mask for name, mask in self._zones.items()}
        parts |= {("class", name): mask for name, mask in self._classes.items()}
        by_figure: dict[FigureKey, tuple[float, ...]] = {
            (*part, measure): residuals(values, self._weights * mask, batch, batches)
            for measure, values in measures.items()
            for part, mask in parts.items()
            if measure != "ap" or part[0] != "zone"
        }
        return Scatter(self._digest, by_figure)

    @cached_property
    def _digest(self) -> str:
        objects = self._objects
        arrays = objects.centers, objects.sizes, objects.yaws, objects.scenes, self._weights
        return sample_digest(arrays)

    def _shares(self, points: Floats, mask: Bools) -> dict[int, float]:
        return {n: rounded(self._mean(points >= n, mask)) for n in POINTS}

    def _mass(self, mask: Bools) -> float:
        return float((self._weights * mask).sum())

    def _mean(self, values: Floats | Bools, mask: Bools | None) -> float:
        weights = self._weights if mask is None else self._weights * mask
        return float((values * weights).sum() / weights.sum())

    def _scatter(self, values: Floats, mask: Bools | None) -> float:
        """Standard error of a ratio of sums over scenes: the random sample consists of scenes."""
        weights = self._weights if mask is None else self._weights * mask
        off = weights * (values - self._mean(values, mask))
        scenes = self._drawn.scenes
        sums = np.bincount(self._objects.scenes, off, scenes)
        square = scenes / max(scenes - 1, 1) * float((sums * sums).sum())
        return rounded(math.sqrt(square) / float(weights.sum()))


@dataclass(frozen=True, slots=True, eq=False)
class RingObjects:
    """Objects in rings: `cells` (N,) numbers the class, sector and ring of each object."""

    objects: Objects
    cells: Ints


def ring_objects(drawn: SampledObjects, vehicle: Vehicle | None) -> RingObjects:
    """Return lone objects in every sector and ring, without those that overlap the vehicle. Each
    class has the mean size, the mean height above the ground and the headings of its objects."""
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
    centers, sizes, yaws, cells = join_columns(by_class)
    beside = ~overlap(ground_rectangles(centers[:, :2], sizes, yaws), vehicle_rectangle(vehicle))
    labels = cells // (len(SECTORS) * RINGS)
    placed = [values[beside] for values in (centers, sizes, yaws)]
    objects = Objects(
        placed[0], placed[1], placed[2], labels[beside], class_names=drawn.objects.class_names
    )
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
    Between the middles of two rings it is interpolated linearly."""
    first = next((k for k, ap in enumerate(means) if ap >= min_ap), None)
    if first is None:
        return 0.0
    last = next((k for k in range(first, RINGS) if means[k] < min_ap), None)
    if last is None:
        return FARTHEST_M
    above = means[last - 1]
    below = means[last]
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
    """Objects of every class of a study, alone in rings round the vehicle. They have the mean sizes
    of the `drawn` objects by class. A sensor that has not moved is not measured again."""

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
        `InputError` when a sensor has a curve of its own, or a class has none."""
        self._fused.check(rig)
        entropies, _ = self._fused.entropies(rig, self._sensors.measure(rig), members)
        return ap_of_entropy(entropies)

    def reach(self, class_name: str, ap: Floats, min_ap: float = FOUND_AP) -> Mapping[str, float]:
        """Return how far a class is found with an AP of at least `min_ap`, by direction [m]. `ap`
        is that of `LoneObjects.ap`. 0 in every direction for a class without objects."""
        if class_name not in self.class_names:
            return dict.fromkeys(SECTORS, 0.0)
        return reach(self._rings, self.class_names.index(class_name), ap, min_ap)
