"""Requirements on blind ground: how much of a zone's ground is blind, and how far out.

Blind squares are those of `sight.blind_ground`: never too few, edges at most 0.15 m too far out.
What each sensor marks is cached by sensor, so a moved sensor and a lost one cost only their own.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...base.arrays import Flags, Floats
from ...geometry.grids import PerceptionSpace
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ..sight.blind_ground import STEP_M, BlindSearch, blind_squares, body_rectangle
from ..sight.ground_cells import GroundCells
from .body_checks import SceneCaches
from .criteria import Criterion, Requirement
from .verdict import GroundFigures, Samples, Verdict, growth, rounded_down
from .zones import INSIDE_M, PlacedZone, signed_distance

FAR_OFF_M = 10.0  # Blind ground this much too far out is as far off as can be
MAX_CELLS = 120_000  # A zone is grown as long as its ground has no more squares


class GroundCheck:
    """Holds rigs to a requirement on blind ground in a space. The `vehicle` occludes; distances are
    from the rectangle of the `anchor`, the vehicle as drawn."""

    def __init__(
        self,
        requirement: Requirement,
        zone: PlacedZone,
        space: PerceptionSpace,
        vehicle: Vehicle | None,
        anchor: Vehicle | None,
        caches: SceneCaches,
    ) -> None:
        self.requirement = requirement
        self._zone = zone
        self._space = space
        self._vehicle = vehicle
        self._anchor = anchor
        self._caches = caches
        self._own = _ZoneGround(self, 0.0)
        self._grown: dict[float, _ZoneGround | None] = {}

    def verdict(self, rig: Rig, preview: bool, cases: Sequence[Rig] = ()) -> Verdict:
        """Return the verdict on a rig; a preview has no margin, and is without losses that need not
        count."""
        own = self.requirement
        ground = self._own
        marks = ground.marks(rig)
        blind = ground.blind(marks.values())
        lost = {}
        if own.robust_to.one_lost or not preview:
            lost = {name: ground.blind_without(marks, name) for name in marks}
        counted = [blind, *(lost.values() if own.robust_to.one_lost else ())]
        for number, case in self._asked(cases):
            counted += self._blinds(ground, ground.marks(case, number))
        met_whole = self._meets(blind)
        met = all(map(self._meets, counted))
        margin, at_least = (None, False) if preview else self._margin(rig, met, cases)
        i, j = np.nonzero(blind)
        worst = None
        if len(i):
            k = int(np.argmin(ground.distance[i, j]))
            x = ground.cells.x[i[k]]
            y = ground.cells.y[j[k]]
            worst = round(float(x), 3), round(float(y), 3)
        return Verdict(
            requirement=own,
            met=met,
            margin=margin,
            at_least=at_least,
            share=1.0 - np.count_nonzero(blind) / max(int(np.count_nonzero(ground.mask)), 1),
            worst=worst,
            body=None,
            seen_by=(),
            why=dict,
            without={name: self._meets(each) for name, each in lost.items()},
            sensors=(0, 0),
            samples=Samples(self._zone, np.zeros((0, 2)), np.zeros(0), ground.mask),
            passed=np.zeros(0, bool),
            met_whole=met_whole,
            preview=preview,
            ground=self._figures(blind, counted),
        )

    def shortfall(self, rig: Rig, cases: Sequence[Rig] = ()) -> float:
        """Return how far a rig is off the requirement, 0 where it is met, else above 0 to 1."""
        blinds = self._blinds(self._own, self._own.marks(rig))
        for number, case in self._asked(cases):
            blinds += self._blinds(self._own, self._own.marks(case, number))
        return max(map(self._off, blinds))

    def _asked(self, cases: Sequence[Rig]) -> list[tuple[int, Rig]]:
        """Return the rigs with mounting errors that count, with their numbers as scenes."""
        return list(enumerate(cases, start=1)) if self.requirement.robust_to.mounting else []

    def _blinds(self, ground: "_ZoneGround", marks: Mapping[str, Flags]) -> list[Flags]:
        """Return all blind squares that count: of a whole rig, and with each sensor lost."""
        found = [ground.blind(marks.values())]
        if self.requirement.robust_to.one_lost:
            found += [ground.blind_without(marks, name) for name in marks]
        return found

    def _meets(self, blind: Flags) -> bool:
        """Whether blind squares (NX, NY) of the zone meet the requirement."""
        return self._own.fails_at(blind, self.requirement.criterion) > INSIDE_M

    def _margin(self, rig: Rig, met: bool, cases: Sequence[Rig]) -> tuple[float, bool]:
        """Return how far the zone could grow [m] or has to shrink, and whether it could more."""
        criterion = self.requirement.criterion
        looked = 0.0
        step = self._own.cells.step
        for grown in (self._zone.grow, *growth(self._zone)):
            if grown not in self._grown:
                low, high = self._zone.bounds
                count = math.prod(((high - low + 2.0 * grown) / STEP_M).tolist())
                self._grown[grown] = _ZoneGround(self, grown) if count <= MAX_CELLS else None
            ground = self._grown[grown]
            if ground is None:
                break
            blinds = self._blinds(ground, ground.marks(rig))
            for number, case in self._asked(cases):
                blinds += self._blinds(ground, ground.marks(case, number))
            at = min(ground.fails_at(blind, criterion) for blind in blinds)
            if at < math.inf:
                margin = rounded_down(at - step)
                return (max(margin, 0.0) if met else min(margin, -step)), False
            looked = grown
        return (rounded_down(looked), True) if met else (-step, False)

    def _figures(self, blind: Flags, counted: Sequence[Flags]) -> GroundFigures:
        """Return the blind ground in figures, and what of it is to spare in the worst case."""
        criterion = self.requirement.criterion
        ground = self._own
        area, out = (max(map(measure, counted)) for measure in (ground.area, ground.farthest_out))
        return GroundFigures(
            math.ceil(ground.area(blind) * 100.0 - 1e-6) / 100.0,
            math.ceil(ground.farthest_out(blind) * 100.0 - 1e-6) / 100.0,
            None if criterion.blind_m2 is None else rounded_down(criterion.blind_m2 - area),
            None
            if criterion.max_blind_distance is None
            else rounded_down(criterion.max_blind_distance - out),
            blind=blind,
            cells=ground.cells,
        )

    def _off(self, blind: Flags) -> float:
        if self._meets(blind):
            return 0.0
        criterion = self.requirement.criterion
        ground = self._own
        area = 0.0
        most = max(ground.area(ground.mask), STEP_M)
        if criterion.blind_m2 is not None:
            area = max(ground.area(blind) - criterion.blind_m2, 0.0) / most
        out = 0.0
        if criterion.max_blind_distance is not None:
            out = max(ground.farthest_out(blind) - criterion.max_blind_distance, 0.0) / FAR_OFF_M
        return min(1.0, max(area, out, 1e-6))


@dataclass(frozen=True, eq=False)
class _ZoneGround:
    """The ground of a zone that is grown by some metres, as squares, and the sensors on it."""

    check: GroundCheck
    grown: float

    @cached_property
    def cells(self) -> GroundCells:
        """The squares."""
        (x0, y0), (x1, y1) = (w.tolist() for w in self.check._zone.bounds)
        room = self.grown + STEP_M
        around = ((x0 - room, x1 + room), (y0 - room, y1 + room))
        return GroundCells.of(self.check._space, STEP_M, around)

    @cached_property
    def distance(self) -> Floats:
        """Distance (NX, NY) of the squares' middles to the zone, negative inside [m]."""
        return self.check._zone.distance(self._middles).reshape(self.cells.shape)

    @cached_property
    def mask(self) -> Flags:
        """The squares (NX, NY) of the grown zone on which somebody can stand."""
        outline = self.check._zone.planes.outline
        free = signed_distance(self._middles, outline).reshape(self.cells.shape) > 0.0
        return np.asarray(free & (self.distance <= self.grown + INSIDE_M))

    @property
    def _middles(self) -> Floats:
        """Middles (N, 2) of the squares [m]."""
        grid = np.meshgrid(self.cells.x, self.cells.y, indexing="ij")
        return np.stack(grid, axis=-1).reshape(-1, 2)

    @cached_property
    def out(self) -> Floats:
        """How far from the vehicle's rectangle (NX, NY) each square ends [m]."""
        (x0, x1), (y0, y1) = body_rectangle(self.check._anchor)
        cells = self.cells
        dx = np.maximum(np.maximum(cells.x1 - x1, x0 - cells.x0), 0.0)
        dy = np.maximum(np.maximum(cells.y1 - y1, y0 - cells.y0), 0.0)
        return np.hypot(dx[:, None], dy)

    @cached_property
    def _searches(self) -> dict[int, BlindSearch]:
        return {}

    def marks(self, rig: Rig, number: int = 0) -> dict[str, Flags]:
        """Return the squares that each sensor marks in a scene, with their margin, by name."""
        check = self.check
        if number not in self._searches:
            height = check.requirement.criterion.blind_height
            caches = check._caches[number]
            self._searches[number] = BlindSearch.of(self.cells, height, check._vehicle, caches)
        search = self._searches[number]
        search.squares.marked(rig)
        counting = {s.name for s in rig if check.requirement.criterion.counts(s.kind)}
        return {
            name: marked & ~search.own & (name in counting)
            for name, marked in search.squares.by_sensor.items()
        }

    def blind(self, marks: Iterable[Flags]) -> Flags:
        """Return the blind squares (NX, NY) of the grown zone."""
        search = self._searches[0]
        marked = np.zeros(search.own.shape, bool)
        for each in marks:
            marked |= each
        blind = blind_squares(marked, search.own, self.cells.step)
        inner = tuple(slice(search.margin, n - search.margin) for n in blind.shape)
        found: Flags = blind[inner] & self.mask
        return found

    def blind_without(self, marks: Mapping[str, Flags], lost: str) -> Flags:
        """Return the blind squares without one sensor."""
        return self.blind(mark for name, mark in marks.items() if name != lost)

    def area(self, flags: Flags) -> float:
        """Return the area of some squares [m2]."""
        return float(np.count_nonzero(flags)) * self.cells.step**2

    def farthest_out(self, blind: Flags) -> float:
        """Return how far from the vehicle's rectangle the farthest blind square ends [m]."""
        return float(self.out[blind].max(initial=0.0))

    def fails_at(self, blind: Flags, criterion: Criterion) -> float:
        """Return by how much the zone can grow (shrink, below 0) until it fails [m]; inf: never."""
        away = np.sort(self.distance[blind])
        at = math.inf
        if criterion.blind_m2 is not None:
            allowed = math.floor(criterion.blind_m2 / self.cells.step**2 + INSIDE_M)
            at = float(away[allowed]) if allowed < len(away) else math.inf
        if criterion.max_blind_distance is not None:
            beyond = blind & (self.out > criterion.max_blind_distance)
            at = min(at, float(self.distance[beyond].min(initial=math.inf)))
        return at
