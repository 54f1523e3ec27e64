"""Requirements on blind ground: how much of a zone's ground is blind, and how far out.

Blind squares are those of `sight.blind_squares`: never too few, edges at most 0.15 m too far out.
What each sensor marks is cached by sensor, so a moved sensor and a lost one cost only their own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.grids import PerceptionSpace
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import VisibleGroundCache
from ..sight.blind_ground import body_rectangle
from ..sight.blind_squares import STEP_M, BlindSearch, blind_squares
from ..sight.ground_cells import GroundCells
from .criteria import Requirement
from .verdict import Samples, Verdict, ground_verdict
from .zones import INSIDE_M, PlacedZone, signed_distance

Flags = NDArray[np.bool_]

FAR_OFF_M = 10.0
"""Blind ground this much too far out is as far off as can be."""


class GroundCheck:
    """Holds rigs to a requirement on blind ground.

    Parameters
    ----------
    requirement : Requirement
    zone : PlacedZone
    space : PerceptionSpace
        Ground outside of it is not looked at.
    vehicle : Vehicle or None
    caches : dict of dict
        Caches of kernels by sensor and kind, shared by several of these on one vehicle.
    """

    def __init__(
        self,
        requirement: Requirement,
        zone: PlacedZone,
        space: PerceptionSpace,
        vehicle: Vehicle | None,
        caches: dict[str, dict[str, Any]],
    ) -> None:
        self.requirement, self._zone, self._vehicle = requirement, zone, vehicle
        (x0, y0), (x1, y1) = (w.tolist() for w in zone.bounds)
        around = ((x0 - STEP_M, x1 + STEP_M), (y0 - STEP_M, y1 + STEP_M))
        self.cells = GroundCells.of(space, STEP_M, around)
        height = requirement.criterion.blind_height
        self._search = BlindSearch.of(self.cells, height, vehicle, {})
        self._caches, self._sensors = caches, dict[str, VisibleGroundCache]()
        middles = np.stack(np.meshgrid(self.cells.x, self.cells.y, indexing="ij"), axis=-1)
        points = middles.reshape(-1, 2)
        inside = zone.distance(points) <= INSIDE_M
        inside &= signed_distance(points, zone.planes.outline) > 0.0
        self.mask: Flags = inside.reshape(self.cells.shape)

    def verdict(self, rig: Rig, preview: bool) -> Verdict:
        """Return the verdict on a rig; a preview is without lost sensors that need not count."""
        marks = self._marks(rig, preview)
        blind = self._blind(marks.values())
        counts = self.requirement.under.one_lost
        names = list(marks) if len(marks) > 1 and (counts or not preview) else []
        lost = {name: self.is_met(self._without(marks, name)) for name in names}
        samples = Samples(self._zone, np.zeros((0, 2)), np.zeros(0), self.mask)
        met = self.is_met(blind)
        own = self.requirement
        return ground_verdict(own, samples, self.cells, blind, met, lost, counts, preview)

    def shortfall(self, rig: Rig) -> float:
        """Return how far a rig is off the requirement, 0 where it is met, else above 0 to 1."""
        marks = self._marks(rig, False)
        cases = [self._blind(marks.values())]
        if self.requirement.under.one_lost and len(marks) > 1:
            cases += [self._without(marks, name) for name in marks]
        return max(self._off(blind) for blind in cases)

    def is_met(self, blind: Flags) -> bool:
        """Whether blind squares (NX, NY) meet the requirement."""
        criterion = self.requirement.criterion
        if criterion.blind_m2 is not None and self._area(blind) > criterion.blind_m2:
            return False
        return criterion.blind_out is None or self.farthest_out(blind) <= criterion.blind_out

    def farthest_out(self, blind: Flags) -> float:
        """Return how far from the vehicle's rectangle the farthest blind square ends [m]."""
        i, j = np.nonzero(blind)
        if not len(i):
            return 0.0
        (x0, x1), (y0, y1) = body_rectangle(self._vehicle)
        cells = self.cells
        dx = np.maximum(np.maximum(cells.x1[i] - x1, x0 - cells.x0[i]), 0.0)
        dy = np.maximum(np.maximum(cells.y1[j] - y1, y0 - cells.y0[j]), 0.0)
        return float(np.max(np.hypot(dx, dy)))

    def _off(self, blind: Flags) -> float:
        if self.is_met(blind):
            return 0.0
        criterion, most = self.requirement.criterion, max(self._area(self.mask), STEP_M)
        area = 0.0
        if criterion.blind_m2 is not None:
            area = max(self._area(blind) - criterion.blind_m2, 0.0) / most
        out = 0.0
        if criterion.blind_out is not None:
            out = max(self.farthest_out(blind) - criterion.blind_out, 0.0) / FAR_OFF_M
        return min(1.0, max(area, out, 1e-6))

    def _marks(self, rig: Rig, preview: bool) -> dict[str, Flags]:
        """Return the squares that each sensor marks, with their margin, by name."""
        marks = {}
        for sensor in rig:
            if sensor.name not in self._sensors:
                cache = self._caches.setdefault(sensor.name, {})
                self._sensors[sensor.name] = VisibleGroundCache(self._search.squares.view, cache)
            marks[sensor.name] = self._sensors[sensor.name].marked(Rig([sensor]), preview)[0]
        return marks

    def _without(self, marks: Mapping[str, Flags], lost: str) -> Flags:
        return self._blind(mark for name, mark in marks.items() if name != lost)

    def _blind(self, marks: Iterable[Flags]) -> Flags:
        """Return the blind squares (NX, NY) of the zone."""
        marked = np.logical_or.reduce(list(marks))
        own, margin = self._search.own, self._search.margin
        blind = blind_squares(marked & ~own, own, self.cells.step)
        inner = tuple(slice(margin, n - margin) for n in blind.shape)
        found: Flags = blind[inner] & self.mask
        return found

    def _area(self, flags: Flags) -> float:
        return float(np.count_nonzero(flags)) * self.cells.step**2
