"""Values that can be mounted: positions and angles in whole steps, near the result of a search.

A bracket is drilled to 5 mm, not to 0.01 mm. A placement is brought onto the grid, then walked over
it: all neighbours, one step off along one coordinate, are evaluated, until none is better. What is
on the grid are the free coordinates of a sensor in a box; two coordinates of its position on a
surface, which gives the third; its free angles. Slots and sensors that follow others stay theirs.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from math import ceil, floor

import numpy as np

from ..base.errors import InputError
from ..base.setting import Panel, check_settings, setting
from ..base.values import Angle, Number
from ..geometry.poses import FARTHEST_M
from ..scene.rig import Rig
from .domains import METRE, POSITION_AXES, RADIAN, SurfaceDomain
from .objective import NO_VALUE, Value
from .parametrization import Candidate, Parametrization

WALKS = 30  # How often all neighbours of the best placement on the grid are evaluated at most
MET_M = 2e-6
"""A position is on the grid if it is so near to it: its rounding then hits it exactly [m]."""
TRIES = 20  # How often the foot on a surface is moved until the sensor is on the grid
SLACK = 1e-9  # Relative rounding error of a bound that is on the grid
GridSteps = tuple[int, ...]
"""A placement on the grid: how many steps each coordinate is from 0."""
EvaluateRigs = Callable[[Sequence[Rig]], Sequence[Value]]


@dataclass(frozen=True, slots=True)
class MountingGrid:
    """The steps in which positions and angles can be mounted, as its fields say; 0: any value."""

    position: float = setting(
        0.0,
        Number(0.0, 1.0, unit="m", noun="length"),
        "Positions that a search ends on are multiples of this; 0: any",
        Panel("grid_position", "Grid", precision=3, step=0.1),
    )
    angle: float = setting(
        0.0,
        Angle(0.0, 45.0),
        "Angles that a search ends on are multiples of this; 0: any",
        Panel("grid_angle", "Grid °", precision=2, step=10.0),
    )

    def __post_init__(self) -> None:
        check_settings(self, "optimize", "grid.")

    @property
    def is_on(self) -> bool:
        """Whether anything is to be on a grid."""
        return self.position > 0.0 or self.angle > 0.0


@dataclass(frozen=True, slots=True)
class _Coordinate:
    """A coordinate on the grid: its index in the vector, the sensor and the axis, the step, and the
    lowest and highest number of steps. `of_pose`: Whether it is one of the pose on a surface, whose
    bounds are a rule of the search."""

    index: int
    name: str
    axis: str
    step: float
    low: int
    high: int
    of_pose: bool

    def clipped(self, number: int) -> int:
        """Return a number of steps clipped to the bounds."""
        return min(max(number, self.low), self.high)


@dataclass(frozen=True, slots=True)
class OnGrid:
    """The best placement on a grid near another one.

    `rig`: The placement; None where none that is near breaks no rule and no limit.
    `evaluations`: How many placements were evaluated.
    `off`: Coordinates whose bounds have no value on the grid, such as "roof z".
    """

    rig: Rig | None
    evaluations: int
    off: tuple[str, ...]


class GridWalk:
    """Walks over the grid near the start of a parametrization."""

    def __init__(self, parametrization: Parametrization, grid: MountingGrid) -> None:
        if not grid.is_on:
            raise InputError("optimize", "grid", "a step of positions or angles", "none")
        self._parametrization = parametrization
        self._grid = grid
        self._start = parametrization.start
        every = list(self._coordinates())
        self._known = [each for each in every if each.high >= each.low]
        self.off = tuple(f"{e.name} {e.axis}" for e in every if e not in self._known)

    def nearest(self) -> GridSteps:
        """Return the numbers of steps of the start, each rounded to the nearest."""
        numbers = []
        for each in self._known:
            numbers.append(each.clipped(round(self._value(each) / each.step)))
        return tuple(numbers)

    def best(self, evaluate: EvaluateRigs) -> OnGrid:
        """Return the best placement: walk from the nearest one to better neighbours."""
        values: dict[GridSteps, Value] = {}
        rigs: dict[GridSteps, Rig] = {}

        def look_at(several: Sequence[GridSteps]) -> None:
            new = [numbers for numbers in several if numbers not in values]
            placed = {numbers: self.candidate(numbers) for numbers in new}
            known = {n: c.rig for n, c in placed.items() if c is not None}
            rigs.update(known)
            values.update(dict.fromkeys(new, NO_VALUE))
            values.update(zip(known, evaluate(list(known.values())), strict=True))

        at = self.nearest()
        look_at([at])
        for _ in range(WALKS):
            look_at(self._neighbours(at))
            if not values[self._least(values)].is_feasible:
                look_at(self._two_steps(at))
            if (least := self._least(values)) == at:
                break
            at = least
        found = rigs.get(at) if values[at].is_feasible else None
        return OnGrid(found, len(rigs), self.off)

    @staticmethod
    def _least(values: dict[GridSteps, Value]) -> GridSteps:
        return min(values, key=lambda numbers: (values[numbers], numbers))

    def holds(self, rig: Rig) -> bool:
        """Whether a placement is the start itself, and that is on the grid."""
        candidate = self.candidate(self.nearest())
        return candidate is not None and _poses(candidate.rig) == _poses(rig)

    def candidate(self, numbers: GridSteps) -> Candidate | None:
        """Return the placement at numbers of steps; None where it breaks a rule, or the surface has
        no such point."""
        vector = list(self._start.vector)
        targets = zip(self._known, numbers, strict=True)
        wanted = [(each, number * each.step) for each, number in targets]
        for each, value in wanted:
            if not each.of_pose:
                vector[each.index] = value
        on_surface = [(each, value) for each, value in wanted if each.of_pose]
        candidate = self._parametrization.candidate(vector)
        for _ in range(TRIES if on_surface else 0):
            off = [(e, v - self._position(candidate, e)) for e, v in on_surface]
            if all(abs(lack) <= MET_M for _, lack in off):
                break
            for each, lack in off:
                vector[each.index] += lack
            candidate = self._parametrization.candidate(vector)
        else:
            if on_surface:
                return None
        return candidate if self._parametrization.allowed(candidate.rig) else None

    def _neighbours(self, numbers: GridSteps) -> list[GridSteps]:
        return [self._moved(numbers, {k: step}) for k in range(len(numbers)) for step in (-1, 1)]

    def _two_steps(self, numbers: GridSteps) -> list[GridSteps]:
        return [
            self._moved(numbers, {j: one, k: other})
            for j, k in combinations(range(len(numbers)), 2)
            for one, other in product((-1, 1), repeat=2)
        ]

    def _moved(self, numbers: GridSteps, steps: dict[int, int]) -> GridSteps:
        moved = []
        for k, (each, number) in enumerate(zip(self._known, numbers, strict=True)):
            moved.append(each.clipped(number + steps.get(k, 0)))
        return tuple(moved)

    def _value(self, each: _Coordinate) -> float:
        if each.of_pose:
            return self._position(self._start, each)
        return self._start.vector[each.index]

    @staticmethod
    def _position(candidate: Candidate, each: _Coordinate) -> float:
        return candidate.rig[each.name].pose.position[POSITION_AXES.index(each.axis)]

    def _coordinates(self) -> Iterator[_Coordinate]:
        variables = self._parametrization.variables
        for index, (name, axis) in enumerate(self._parametrization.positions):
            variable = variables[index]
            step = {METRE: self._grid.position, RADIAN: self._grid.angle}.get(variable.unit, 0.0)
            domain = self._parametrization.domain_of(name)
            of_pose = isinstance(domain, SurfaceDomain) and axis in POSITION_AXES
            if step <= 0.0 or (of_pose and axis == self._third(name)):
                continue
            reach = (-FARTHEST_M, FARTHEST_M) if of_pose else (variable.low, variable.high)
            low, high = (end / step for end in reach)
            slack = SLACK * max(abs(low), abs(high), 1.0)
            first = ceil(low - slack)
            last = floor(high + slack)
            yield _Coordinate(index, name, axis, step, low=first, high=last, of_pose=of_pose)

    def _third(self, name: str) -> str:
        """Return the axis of a position that follows from the other two on a sensor's surface."""
        domain = self._parametrization.domain_of(name)
        assert isinstance(domain, SurfaceDomain)
        base = domain.base(self._start.rig[name].pose)
        _, face = domain.surface.closest(base)
        return POSITION_AXES[int(np.abs(domain.surface.outward(face)).argmax())]


def _poses(rig: Rig) -> list[object]:
    return [(sensor.name, sensor.pose) for sensor in rig]
