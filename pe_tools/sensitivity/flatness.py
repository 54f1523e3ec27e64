"""Steps from an optimum: what 1 cm and 1 deg cost, and the constraints that forbid better ones. A
constraint is active if it forbids a step of 1 cm or 1 deg of one sensor that would lower the
entropy. Such a step that nothing forbids says that a longer search would gain."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.values import rounded
from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig
from pe_core.scoring.score import SURE
from pe_core.search import (
    AXES,
    POSITION_AXES,
    Objective,
    Parametrization,
    SearchSpace,
    SurfaceMount,
    evaluate_all,
    pose_from_values,
    pose_values,
)
from pe_core.search.parametrization import followers

UNIT_M, UNIT_RAD = 0.01, math.radians(1.0)
"""One unit: 1 cm along x, y and z of the ground frame, 1 deg of roll, pitch and yaw."""
NEAR, FAR = 1.0, 5.0  # Steps to both sides [cm or deg]
FLAT, STEEP = "flat", "steep"
STEEP_NATS, STEEP_AP = 0.01, 0.001
"""From this cost of one step on, an axis is called steep [nats; expected AP]."""
NOTICED = 0.1  # A smaller difference says nothing, in costs of a steep axis
SLACK = 1e-6  # A value this far outside of its bounds is rounding [m or rad]
ON_SURFACE_M = 0.1 * UNIT_M  # A step along a surface ends this near to the surface at most
CLEARANCE = "standoff of "
"""A step off a surface also breaks the rule of its stand-off: one constraint, named once."""
Unmet = Callable[[Rig], Sequence[str]]
"""Names of the requirements that a rig does not meet and that are to be kept."""


class PoseStep(NamedTuple):
    """A number of units along an axis of a sensor."""

    sensor: str
    axis: str
    units: float

    @property
    def text(self) -> str:
        """The step: "roof z +1 cm", "front pitch -1 deg"."""
        return f"{self.sensor} {self.axis} {self.units:+g} {self.unit}"

    @property
    def unit(self) -> str:
        """The unit of the step: "cm" or "deg"."""
        return "cm" if self.axis in POSITION_AXES else "deg"


def unit_of_axis(axis: str) -> float:
    """Return one unit of a step along an axis [m or rad]."""
    return UNIT_M if axis in POSITION_AXES else UNIT_RAD


def lone_move(rig: Rig, step: PoseStep) -> Rig:
    """Return the rig with one sensor moved, all others as they are."""
    return rig.with_poses([_moved(s.pose, step) if s.name == step.sensor else s.pose for s in rig])


def _moved(pose: Pose, step: PoseStep) -> Pose:
    values = pose_values(pose)
    values[step.axis] += step.units * unit_of_axis(step.axis)
    return pose_from_values(values)


@dataclass(frozen=True, slots=True)
class AxisCost:
    """What moving one sensor alone along one axis costs. `status` is what the search does with the
    axis: "free", "surface", "slot", "fixed" or "linked". `cost` is by step [cm or deg] how much the
    entropy rises [nats] (or the expected AP falls), with the standard error `stderr`. From a cost
    of `steep` on the axis is steep."""

    sensor: str
    axis: str
    status: str
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
            "status": self.status,
            "cost": cost,
            "stderr": rounded(self.stderr),
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
        steep: float = STEEP_NATS,
        helpers: Callable[[], Executor | None] = lambda: None,
    ) -> None:
        self.reference = reference
        self.steep = steep
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
        if new:
            by_sample = [
                evaluate_all(objective, list(new.values()), executor=self._helpers())
                for objective in self._objectives
            ]
            self._values |= zip(new, np.array(by_sample).T, strict=True)

    def change(self, rig: Rig, base: Rig | None = None) -> float:
        """Return how much higher the value of a rig is than that of `base` (the reference)."""
        return float(np.mean(self._changes(rig, base)))

    def error(self, rigs: Sequence[Rig]) -> float:
        """Return the standard error of the changes of similar rigs from the reference: the root
        mean square over all of them. 0 for one sample: it has all voxels."""
        count = len(self._objectives)
        if count == 1 or not rigs:
            return 0.0
        variances = [np.var(self._changes(rig), ddof=1) / count for rig in rigs]
        return math.sqrt(float(np.mean(variances)))

    def _changes(self, rig: Rig, base: Rig | None = None) -> Floats:
        """Return by sample how much higher the value of a rig is than that of `base`."""
        pair = rig, self.reference if base is None else base
        self.evaluate(pair)
        return self._values[_key(pair[0])] - self._values[_key(pair[1])]


def _key(rig: Rig) -> tuple[object, ...]:
    return tuple((s.name, s.pose.position, s.pose.rpy) for s in rig)


def flatness(
    samples: StepCosts, status: Callable[[str, str], str], steps: tuple[float, ...] = (NEAR, FAR)
) -> Iterator[AxisCost]:
    """Yield the costs of each axis of each sensor, in the rig's order, for steps to both sides.
    `status` returns what the search does with an axis of a sensor."""
    both = (*(-each for each in steps), *steps)
    for sensor in samples.reference:
        moved = {
            (axis, units): lone_move(samples.reference, PoseStep(sensor.name, axis, units))
            for axis in AXES
            for units in both
        }
        samples.evaluate([samples.reference, *moved.values()])
        error = samples.error([moved[axis, units] for axis in AXES for units in (-NEAR, NEAR)])
        for axis in AXES:
            cost = {units: samples.change(moved[axis, units]) for units in both}
            own = status(sensor.name, axis)
            yield AxisCost(sensor.name, axis, own, cost, samples.steep, error)


@dataclass(frozen=True, slots=True)
class ActiveConstraint:
    """A constraint (or several) that keeps a sensor from a better place. Without a name nothing
    forbids the step: a longer search would gain this. The step is the one that gains most; the gain
    is negative [nats]."""

    constraints: tuple[str, ...]
    step: PoseStep
    gain: float

    @property
    def name(self) -> str:
        """The constraints as text."""
        return " and ".join(self.constraints)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data; `gain` is positive."""
        return {
            "constraints": list(self.constraints),
            "sensor": self.step.sensor,
            "axis": self.step.axis,
            "step": self.step.units,
            "gain": rounded(-self.gain),
        }


class Neighbourhood:
    """A placement in the space of a search: what each axis does, and what forbids a step. The
    placement breaks no rule; the space has the bounds that it had at the start of the search."""

    def __init__(self, rig: Rig, space: SearchSpace) -> None:
        self.rig, self._space = rig, space
        self._parametrization = Parametrization(rig, space)
        self._leaders = {
            each.name: each.leader for each in followers(rig, space.mounting, space.vehicle)
        }
        pairs = self._parametrization.positions
        self._variables = {pair: number for number, pair in enumerate(pairs)}
        self._broken_here = self._parametrization.broken(rig)

    def status(self, sensor: str, axis: str) -> str:
        """Return what the search does with an axis of a sensor. "free", "fixed", "linked" (it
        follows another sensor), "surface" or "slot"."""
        if sensor in self._leaders:
            return "linked"
        mount = None if sensor in self._space.fixed else self._space.mounting.mount_of(sensor)
        if (sensor, axis) in self._variables:
            on_surface = isinstance(mount, SurfaceMount) and axis in POSITION_AXES
            return "surface" if on_surface else "free"
        return "fixed" if mount is None or isinstance(mount, SurfaceMount) else "slot"

    def forbidding(self, step: PoseStep) -> tuple[str, ...]:
        """Return the constraints that forbid a step of one sensor alone; none: it is allowed."""
        # The rules that a rig breaks and the placement does not, in their order.
        rig = lone_move(self.rig, step)
        broken = self._parametrization.broken(rig) - self._broken_here
        rules = [rule.text for rule in self._parametrization.rules if rule.text in broken]
        held = self._held(step)
        if held.startswith("mount"):
            rules = [text for text in rules if not text.startswith(CLEARANCE)]
        links = (  # that the sensor would leave if it moved alone
            f"link of {name!r} to {leader!r}"
            for name, leader in self._leaders.items()
            if step.sensor in (name, leader)
        )
        return (*filter(None, (held, *links)), *rules)

    def _held(self, step: PoseStep) -> str:
        """Return what holds a sensor's axis itself; empty where it may take the step."""
        sensor, axis = step.sensor, step.axis
        status = self.status(sensor, axis)
        mount = self._space.mounting.on.get(sensor)
        if status == "linked":
            return ""
        if status in ("fixed", "slot"):
            return f"slots of {mount!r}" if status == "slot" else f"{axis} of {sensor!r} held"
        number = self._variables[sensor, axis]
        vector = list(self._parametrization.start.vector)
        vector[number] += step.units * unit_of_axis(axis)
        if status == "surface":
            there = self._parametrization.candidate(vector).rig[sensor].pose.position
            wanted = lone_move(self.rig, step)[sensor].pose.position
            return "" if math.dist(there, wanted) <= ON_SURFACE_M else f"mount {mount!r}"
        variable = self._parametrization.variables[number]
        within = variable.low - SLACK <= vector[number] <= variable.high + SLACK
        return "" if within else f"bounds of {axis} of {sensor!r}"


def active_constraints(
    table: Iterable[AxisCost], space: Neighbourhood, unmet: Unmet | None = None
) -> tuple[ActiveConstraint, ...]:
    """Return the active constraints, that of the largest gain first; one without names last.
    `table` has what each step costs; `unmet` tells requirements that are to be kept."""
    found: dict[tuple[str, ...], ActiveConstraint] = {}
    for row in table:
        for units in (-NEAR, NEAR):
            if row.cost[units] >= -row.noticed:
                continue
            step = PoseStep(row.sensor, row.axis, units)
            broken = () if unmet is None else unmet(lone_move(space.rig, step))
            names = (*space.forbidding(step), *(f"requirement {name!r}" for name in broken))
            known = found.get(names)
            if known is None or row.cost[units] < known.gain:
                found[names] = ActiveConstraint(names, step, row.cost[units])
    return tuple(sorted(found.values(), key=lambda each: (not each.constraints, each.gain)))
