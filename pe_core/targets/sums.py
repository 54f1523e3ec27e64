"""Means over objects, by their weights, and how far they are to be trusted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..metric.entropy import H_BEST, H_BLIND, ap_of_entropy
from ..scoring.object_score import POINTS, FoundClass, ObjectScore
from ..scoring.sampled import ALIKE, RULE_OF_THREE
from ..scoring.scatter import FigureKey, Scatter, residuals, sample_digest
from ..scoring.score import PartScore, rounded
from ..scoring.zones import zone_masks
from .drawing import DrawnObjects
from .lone import LoneObjects

BATCHES = 32
"""Scenes are put together in so many batches for the errors of differences; fewer where there are
fewer scenes."""
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class ObjectSums:
    """Sums over drawn objects: of all, of classes, of zones."""

    def __init__(self, drawn: DrawnObjects) -> None:
        self._objects, self._weights, self._drawn = drawn.objects, drawn.weights, drawn
        x, y = drawn.objects.centers[:, 0], drawn.objects.centers[:, 1]
        self._zones = {n: mask for n, mask in zone_masks(x, y).items() if self._mass(mask) > 0.0}
        self._classes = {
            name: mask
            for c, name in enumerate(drawn.objects.class_names)
            if self._mass(mask := drawn.objects.labels == c) > 0.0
        }

    def part(self, entropies: Floats, seen: Bools, some: Bools | None = None) -> PartScore:
        """Mean entropy (eq. 9) and coverage of some objects, or of all, and their share."""
        weights = self._weights if some is None else self._weights * some
        mass = float(weights.sum())
        entropy, coverage = (float((v * weights).sum()) / mass for v in (entropies, seen))
        return PartScore(rounded(entropy), rounded(coverage), rounded(mass))

    def classes(self, entropies: Floats, seen: Bools) -> dict[str, PartScore]:
        """Return the score of each class that has any weight."""
        return {name: self.part(entropies, seen, mask) for name, mask in self._classes.items()}

    def zones(self, entropies: Floats, seen: Bools) -> dict[str, PartScore]:
        """Return the score of each zone by the objects whose middles are in it."""
        return {name: self.part(entropies, seen, mask) for name, mask in self._zones.items()}

    def standard_error(self, entropies: Floats, groups: int, some: Bools | None = None) -> float:
        """Standard error of the mean entropy, from the scatter of the scenes' means.

        Classes are low-discrepancy samples across the scenes, so it errs high. Where all objects
        are alike it is half of what is left to doubt by the rule of three, as for voxels.
        """
        own = entropies if some is None else entropies[some]
        if np.ptp(own) <= ALIKE:
            most = H_BLIND - H_BEST + math.log(groups)
            return rounded(RULE_OF_THREE / 2.0 * most / len(own))
        return self._scatter(entropies, some)

    def told(
        self,
        entropies: Floats,
        points: Sequence[Floats],
        lone: LoneObjects,
        lone_ap: Floats,
        traffic: bool,
    ) -> ObjectScore:
        """Put together what a score on objects tells besides.

        `points` are m of the LiDARs, `lone_ap` (R,) the AP of lone objects.
        """
        ap = ap_of_entropy(entropies)
        total = np.sum(points, axis=0) if points else None
        found = {}
        for name, mask in self._classes.items():
            found[name] = FoundClass(
                int(mask.sum()),
                rounded(self._mass(mask)),
                rounded(self._mean(entropies, mask)),
                self.standard_error(entropies, max(len(points), 1), mask),
                rounded(self._mean(ap, mask)),
                self._scatter(ap, mask),
                {} if total is None else self._shares(total, mask),
                lone.reach(name, lone_ap),
            )
        whole = rounded(self._mean(ap, None)), self._scatter(ap, None)
        return ObjectScore(*whole, len(ap), self._drawn.scenes, traffic, found)

    def scatter(self, entropies: Floats, seen: Bools) -> Scatter:
        """Return residuals by batch of scenes: entropy and coverage of all parts, AP of classes."""
        scenes = self._drawn.scenes
        batches = min(BATCHES, scenes)
        batch = self._objects.scenes * batches // scenes
        measures = {
            "entropy": entropies,
            "coverage": seen.astype(float),
            "ap": ap_of_entropy(entropies),
        }
        parts = {("rig", ""): np.ones(len(entropies), bool)}
        parts |= {("zone", name): mask for name, mask in self._zones.items()}
        parts |= {("class", name): mask for name, mask in self._classes.items()}
        found: dict[FigureKey, tuple[float, ...]] = {
            (*part, measure): residuals(values, self._weights * mask, batch, batches)
            for measure, values in measures.items()
            for part, mask in parts.items()
            if measure != "ap" or part[0] != "zone"
        }
        return Scatter(self._digest, found)

    @cached_property
    def _digest(self) -> str:
        objects = self._objects
        arrays = objects.centers, objects.sizes, objects.yaws, objects.scenes, self._weights
        return sample_digest(arrays)

    def _shares(self, points: Floats, mask: Bools) -> dict[int, float]:
        return {n: rounded(self._mean(points >= n, mask)) for n in POINTS}

    def _mass(self, mask: Bools) -> float:
        return float((self._weights * mask).sum())

    def _mean(self, values: Floats | Bools, some: Bools | None) -> float:
        weights = self._weights if some is None else self._weights * some
        return float((values * weights).sum() / weights.sum())

    def _scatter(self, values: Floats, some: Bools | None) -> float:
        """Standard error of a ratio of sums over scenes: scenes are what is drawn."""
        weights = self._weights if some is None else self._weights * some
        off = weights * (values - self._mean(values, some))
        scenes = self._drawn.scenes
        sums = np.bincount(self._objects.scenes, off, scenes)
        square = scenes / max(scenes - 1, 1) * float((sums * sums).sum())
        return rounded(math.sqrt(square) / float(weights.sum()))
