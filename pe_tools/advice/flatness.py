"""How flat the optimum of a search is: what 1 and 5 cm or degrees off cost, each sensor alone, on
samples that the search did not use. Nothing here changes a result."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.values import rounded
from pe_core.scene.rig import Rig
from pe_core.scoring.score import SURE
from pe_core.search import (
    AXES,
    POSITION_AXES,
    Objective,
    evaluate_all,
    pose_from_values,
    pose_values,
)
from pe_core.study.study import EXPECTED_AP

UNIT_M = 0.01
UNIT_RAD = math.radians(1.0)
"""One unit: 1 cm along x, y and z of the ground frame, 1 deg of roll, pitch and yaw."""
# Steps to both sides [cm or deg]
NEAR = 1.0
FAR = 5.0
FLAT = "flat"
STEEP = "steep"
STEEP_NATS = 0.01
STEEP_AP = 0.001
"""From this cost of one step on, an axis is called steep [nats; expected AP]."""
NOTICED = 0.1  # A smaller difference says nothing, in costs of a steep axis
SHARE = 8  # The steps evaluate at most the search's evaluations divided by this
NAMED = 4  # How many axes a line names


def moved_alone(rig: Rig, name: str, axis: str, units: float) -> Rig:
    """Return the rig with one sensor moved by a number of units along an axis."""
    values = pose_values(rig[name].pose)
    values[axis] += units * (UNIT_M if axis in POSITION_AXES else UNIT_RAD)
    moved = pose_from_values(values)
    return rig.with_poses([moved if s.name == name else s.pose for s in rig])


@dataclass(frozen=True, slots=True)
class AxisCost:
    """What moving one sensor alone along one axis costs. `cost` is by step [cm or deg] how much the
    entropy rises [nats] (or the expected AP falls), with the standard error `stderr`. From a cost
    of `steep` on the axis is steep."""

    sensor: str
    axis: str
    cost: Mapping[float, float]
    steep: float = STEEP_NATS
    stderr: float = 0.0

    @property
    def worst(self) -> float:
        """The higher cost of one step back or forth."""
        return max(self.cost[-NEAR], self.cost[NEAR])

    @property
    def noticed(self) -> float:
        """The smallest cost or gain that is told from 0."""
        return max(NOTICED * self.steep, SURE * self.stderr)

    @property
    def word(self) -> str:
        """ "steep", "flat" (no step as far as was looked has a cost), or empty."""
        if self.worst >= max(self.steep, self.noticed):
            return STEEP
        return "" if any(abs(each) > self.noticed for each in self.cost.values()) else FLAT

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        cost = {f"{step:+g}": rounded(each) for step, each in sorted(self.cost.items())}
        return {
            "sensor": self.sensor,
            "axis": self.axis,
            "cost": cost,
            "stderr": rounded(self.stderr),
        }


@dataclass(frozen=True, slots=True)
class Flatness:
    """What a step costs, by sensor and axis, and how many rigs were evaluated. `by_ap`: whether
    costs are differences of the expected AP; positive is still worse."""

    evaluations: int
    axes: tuple[AxisCost, ...]
    by_ap: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data, as result.json holds it."""
        return {
            "evaluations": self.evaluations,
            "axes": [each.to_dict() for each in self.axes],
            **({"objective": EXPECTED_AP} if self.by_ap else {}),
        }


class StepCosts:
    """The objective of a search around its result, the `reference`; each rig is evaluated once.
    With a tolerance it is the mean (or the worst) over mounting errors and failures. Requirements
    are left out. `objectives` are it on several samples: values are their mean, and the scatter of
    differences is their error. `helpers` returns the executor that evaluates rigs."""

    def __init__(
        self,
        reference: Rig,
        objectives: Sequence[Objective],
        helpers: Callable[[], Executor | None] = lambda: None,
    ) -> None:
        self.reference = reference
        self._objectives = tuple(objectives)
        self._helpers = helpers
        self._values: dict[tuple[object, ...], Floats] = {}

    @property
    def evaluations(self) -> int:
        """How many rigs were evaluated so far."""
        return len(self._values)

    def evaluate(self, rigs: Iterable[Rig]) -> None:
        """Evaluate rigs side by side, as far as they are not known."""
        new = {key: rig for rig in rigs if (key := _key(rig)) not in self._values}
        executor = self._helpers()
        keys = list(new)
        # Here rig by rig: rays that are cast for one sample are those of the others, too.
        for some in [keys] if executor is not None and keys else [[key] for key in keys]:
            rigs = [new[key] for key in some]
            by_sample = [
                [each.objective for each in evaluate_all(o, rigs, executor=executor)]
                for o in self._objectives
            ]
            self._values |= zip(some, np.array(by_sample).T, strict=True)

    def change(self, rig: Rig) -> float:
        """Return how much higher the value of a rig is than that of the reference."""
        return float(np.mean(self._changes(rig)))

    def error(self, rigs: Sequence[Rig]) -> float:
        """Return the standard error of the changes of similar rigs from the reference: the root
        mean square over all of them. 0 for one sample: it has all voxels."""
        count = len(self._objectives)
        if count == 1:
            return 0.0
        variances = [np.var(self._changes(rig), ddof=1) / count for rig in rigs]
        return math.sqrt(float(np.mean(variances)))

    def _changes(self, rig: Rig) -> Floats:
        """Return by sample how much higher the value of a rig is than that of the reference."""
        return self._values[_key(rig)] - self._values[_key(self.reference)]


def _key(rig: Rig) -> tuple[object, ...]:
    return tuple((s.name, s.pose.position, s.pose.rpy) for s in rig)


def flatness_of(
    rig: Rig,
    objectives: Sequence[Objective],
    evaluations: int,
    by_ap: bool = False,
    helpers: Callable[[], Executor | None] = lambda: None,
    goes_on: Callable[[], bool] = lambda: True,
) -> Flatness | None:
    """Return what steps from the result of a search cost; None where the search was too short: the
    steps evaluate an eighth as many rigs at most.

    Parameters
    ----------
    rig : Rig
        The result.
    objectives : sequence of Objective
        What the search minimised, on samples that it did not use.
    evaluations : int
        Rigs that the search evaluated.
    by_ap : bool
        Whether the objective is the expected AP.
    helpers : callable
        Returns the executor that evaluates rigs, or None.
    goes_on : callable
        Where it returns False the analysis is given up: None is returned.
    """
    near = 2 * len(AXES) * len(rig)  # back and forth
    left = evaluations // SHARE
    if left < near:
        return None
    steps = (NEAR, FAR) if left >= 2 * near else (NEAR,)
    samples = StepCosts(rig, objectives, helpers)
    axes: list[AxisCost] = []
    for sensor in rig:
        if not goes_on():
            return None
        axes += axis_costs(samples, sensor.name, steps, STEEP_AP if by_ap else STEEP_NATS)
    return Flatness(samples.evaluations, tuple(axes), by_ap)


def axis_costs(
    samples: StepCosts, name: str, steps: Sequence[float] = (NEAR, FAR), steep: float = STEEP_NATS
) -> list[AxisCost]:
    """Return the costs of each axis of a sensor, for steps to both sides."""
    both = (*(-each for each in steps), *steps)
    moved = {
        (axis, units): moved_alone(samples.reference, name, axis, units)
        for axis in AXES
        for units in both
    }
    samples.evaluate([samples.reference, *moved.values()])
    error = samples.error([moved[axis, units] for axis in AXES for units in (-NEAR, NEAR)])
    return [
        AxisCost(
            sensor=name,
            axis=axis,
            cost={units: samples.change(moved[axis, units]) for units in both},
            steep=steep,
            stderr=error,
        )
        for axis in AXES
    ]


def flatness_lines(found: Flatness) -> Iterator[str]:
    """Yield the steep and the flat axes in lines."""
    unit = "of AP" if found.by_ap else "nats"
    ordered = sorted(found.axes, key=lambda each: -each.worst)
    steep = [each for each in ordered if each.worst > each.noticed][:NAMED]
    if steep:
        named = ", ".join(f"{each.sensor} {each.axis} {each.worst:+.4f}" for each in steep)
        yield f"1 cm or 1 deg off costs most at: {named} {unit}"
    else:
        yield "1 cm or 1 deg off costs nothing that can be measured, at no sensor and axis"
    if flat := [each for each in found.axes if each.word == FLAT]:
        reach = f"{max(max(each.cost) for each in flat):g}"
        named = "; ".join(
            f"{sensor} {', '.join(row.axis for row in rows)}"
            for sensor, rows in groupby(flat, key=lambda each: each.sensor)
        )
        yield f"flat within {reach} cm or deg: {named}"
