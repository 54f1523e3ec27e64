"""What the search does with each axis of a sensor, and the constraints that are active.

A constraint is active if it forbids a step of 1 cm or 1 deg of one sensor that would lower the
entropy. Such a step that nothing forbids says that a longer search would gain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from pe_core.scene.rig import Rig
from pe_core.search import AXES, POSITION_AXES, Parametrization, SearchSpace, SurfaceMount
from pe_core.search.parametrization import followers
from pe_core.search.search_space import Trial

from .flatness import NEAR, UNIT_M, AxisCost, PoseStep, lone_move, unit_of_axis
from .fresh_samples import Difference

SLACK = 1e-6
"""A value this far outside of its bounds is rounding [m or rad]."""
ON_SURFACE_M = 0.1 * UNIT_M
"""A step along a surface ends this near to the surface at most."""
CLEARANCE = "standoff of "
"""A step off a surface also breaks the rule of its stand-off: one constraint, named once."""
Unmet = Callable[[Rig], Sequence[str]]
"""Names of the requirements that a rig does not meet and that are to be kept."""


@dataclass(frozen=True, slots=True)
class ActiveConstraint:
    """A constraint (or several) that keeps a sensor from a better place.

    Without a name nothing forbids the step: a longer search would gain this. The step is the one
    that gains most; the gain is negative [nats].
    """

    constraints: tuple[str, ...]
    step: PoseStep
    gain: Difference

    @property
    def name(self) -> str:
        """The constraints as text."""
        return " and ".join(self.constraints)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data; `gain` is positive."""
        mean, stderr = self.gain.to_list()
        return {
            "constraints": list(self.constraints),
            "sensor": self.step.sensor,
            "axis": self.step.axis,
            "step": self.step.units,
            "gain": -mean,
            "stderr": stderr,
        }


class Neighbourhood:
    """A placement in the space of a search: what each axis does, and what forbids a step.

    The placement breaks no rule; the space has the bounds that it had at the start of the search.
    """

    def __init__(self, rig: Rig, space: SearchSpace) -> None:
        self.rig, self._space = rig, space
        self._parametrization = Parametrization(rig, space)
        self._leaders = {
            each.name: each.leader for each in followers(rig, space.mounting, space.vehicle)
        }
        self._variables = dict(self._positions())
        self._broken_here = self._broken(rig)

    def status(self, sensor: str, axis: str) -> str:
        """Return what the search does with an axis of a sensor.

        "free", "fixed", "linked" (it follows another sensor), "surface" or "slot".
        """
        if sensor in self._leaders:
            return "linked"
        mount = None if sensor in self._space.fixed else self._space.mounting.mount_of(sensor)
        if (sensor, axis) in self._variables:
            on_surface = isinstance(mount, SurfaceMount) and axis in POSITION_AXES
            return "surface" if on_surface else "free"
        return "fixed" if mount is None or isinstance(mount, SurfaceMount) else "slot"

    def forbidding(self, step: PoseStep) -> tuple[str, ...]:
        """Return the constraints that forbid a step of one sensor alone; none: it is allowed."""
        rules = self._rules(lone_move(self.rig, step))
        held = self._held(step)
        if held.startswith("mount"):
            rules = [text for text in rules if not text.startswith(CLEARANCE)]
        return (*filter(None, (held, *self._links(step.sensor))), *rules)

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

    def _links(self, sensor: str) -> Iterator[str]:
        """Yield the links that a sensor would leave if it moved alone."""
        for name, leader in self._leaders.items():
            if sensor in (name, leader):
                yield f"link of {name!r} to {leader!r}"

    def _rules(self, rig: Rig) -> list[str]:
        """Return the rules that a rig breaks and the placement does not, in their order."""
        broken = self._broken(rig) - self._broken_here
        return [rule.text for rule in self._parametrization.rules if rule.text in broken]

    def _broken(self, rig: Rig) -> frozenset[str]:
        trial = Trial(rig, self._space)
        return frozenset(r.text for r in self._parametrization.rules if r.broken(trial))

    def _positions(self) -> Iterator[tuple[tuple[str, str], int]]:
        """Yield sensor and axis of each design variable, with its position in the vector."""
        names = (sensor.name for sensor in self.rig if sensor.name not in self._leaders)
        variables = ((name, axis) for name in names for axis in self._axes_of(name))
        yield from ((variable, number) for number, variable in enumerate(variables))

    def _axes_of(self, name: str) -> tuple[str, ...]:
        if name in self._space.fixed:
            return ()
        bounds, mount = self._space.bounds.get(name, {}), self._space.mounting.mount_of(name)
        if mount is None:
            return tuple(axis for axis in AXES if axis in bounds)
        if isinstance(mount, SurfaceMount):
            return (*POSITION_AXES, *(axis for axis in AXES[3:] if axis in bounds))
        return ("slot",)


def active_constraints(
    table: Iterable[AxisCost], space: Neighbourhood, unmet: Unmet | None = None
) -> tuple[ActiveConstraint, ...]:
    """Return the active constraints, that of the largest gain first; one without names last.

    `table` has what each step costs; `unmet` tells requirements that are to be kept.
    """
    found: dict[tuple[str, ...], ActiveConstraint] = {}
    for row in table:
        for units in (-NEAR, NEAR):
            if not row.cost[units].is_gain:
                continue
            step = PoseStep(row.sensor, row.axis, units)
            broken = () if unmet is None else unmet(lone_move(space.rig, step))
            names = (*space.forbidding(step), *(f"requirement {name!r}" for name in broken))
            known = found.get(names)
            if known is None or row.cost[units].mean < known.gain.mean:
                found[names] = ActiveConstraint(names, step, row.cost[units])
    return tuple(sorted(found.values(), key=lambda each: (not each.constraints, each.gain.mean)))
