"""ZoneGrowth: how far a zone could grow before a requirement fails.

The ground round a zone is looked at from the zone outwards, part by part, until the requirement
fails.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...base.arrays import Floats
from ...scene.rig import Rig
from ...sensors import PerceptionModel
from .body_checks import BodyChecks, SceneCaches
from .criteria import Requirement, levels_of
from .verdict import Samples, ZoneResult, growth, margin_of
from .zones import INSIDE_M

RingPart = tuple[Floats, BodyChecks]
"""Distances (N,) of some samples round a zone [m], and what checks the bodies there."""
MAX_GROWN = 30_000
"""A zone is grown as long as no more boxes stand on the ground that is added."""
PART_BOXES = 8_000
"""The boxes that are measured at once, about: after each part it may be clear that it fails."""


class ZoneGrowth:
    """Grows the zone of one requirement on bodies.

    Samples are given `inside` the zone, and `around` it up to `zone.grow`.
    """

    def __init__(
        self,
        requirement: Requirement,
        inside: Samples,
        around: Samples,
        model: PerceptionModel,
        caches: SceneCaches,
    ) -> None:
        self._requirement, self._inside = requirement, inside
        self._model, self._caches = model, caches
        self._rings: dict[float, list[RingPart] | None] = {
            inside.zone.grow: self._parts(around.points, around.distance)
        }

    def margins(
        self, result: ZoneResult, rig: Rig, cases: Sequence[Rig]
    ) -> Iterator[tuple[float, bool]]:
        """Yield the margin of a zone that meets its requirement, and whether it could grow more.

        The zone is grown to twice as far again and again, as long as it does not fail, and a margin
        is yielded after each part that is measured: the last one counts.
        """
        wanted, step = self._requirement.criterion.zone_share, self._requirement.zone.step
        distance, passed, inner = self._inside.distance, result.passed, 0.0
        for outer in (self._inside.zone.grow, *growth(self._inside.zone)):
            parts = self._ring(inner, outer)
            if parts is None:
                return
            for away, checks in parts:
                distance = np.concatenate([distance, away])
                passed = np.concatenate([passed, checks.results(rig, cases)[0].passed])
                margin = margin_of(distance, passed, wanted, step, outer)
                yield margin
                if not margin[1]:
                    return
            inner = outer
            yield margin_of(distance, passed, wanted, step, outer)

    def _ring(self, inner: float, outer: float) -> list[RingPart] | None:
        """Return the ground round the zone between two distances; None where it is too much."""
        if outer not in self._rings:
            most = MAX_GROWN // boxes_of(self._requirement)
            points, distance = self._inside.zone.ring_of_samples(inner, outer, most)
            parts = self._parts(points, distance) if len(points) <= most else None
            self._rings[outer] = parts
        return self._rings[outer]

    def _parts(self, points: Floats, distance: Floats) -> list[RingPart]:
        """Return samples from the zone outwards; those at one distance stay together."""
        order, size = np.argsort(distance, kind="stable"), PART_BOXES // boxes_of(self._requirement)
        away, cuts, last = distance[order], [], 0
        for cut in (np.flatnonzero(np.diff(away) > INSIDE_M) + 1).tolist():
            if cut - last >= size:
                cuts.append(last := cut)
        parts = []
        for own in filter(len, np.split(order, cuts)):
            samples = Samples(self._inside.zone, points[own], distance[own])
            checks = BodyChecks([(self._requirement, samples)], self._model, self._caches)
            parts.append((distance[own], checks))
        return parts


def boxes_of(requirement: Requirement) -> int:
    """Return how many boxes are measured at each sample."""
    with_cells = (False, True) if requirement.criterion.share is not None else (False,)
    boxes = sum(
        len(body.boxes(cells)[0]) * len(body.headings)
        for body in requirement.bodies
        for cells in with_cells
    )
    return boxes * levels_of(requirement)
