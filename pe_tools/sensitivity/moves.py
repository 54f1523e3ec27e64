"""Small moves of one sensor round a placement, and which constraints forbid each of them.

A *lone move* takes one sensor along one axis, wherever that leads: it says what an error costs. A
*design move* takes along the sensors that are linked to it, and stays on a surface: it says what
the search could do next, and what holds it back where it cannot.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from pe_core.geometry.poses import Pose
from pe_core.scene.housing import Housing
from pe_core.scene.rig import Rig
from pe_core.search import (
    AXES,
    POSITION_AXES,
    Parametrization,
    SearchSpace,
    SurfaceMount,
    pose_from_values,
    pose_values,
)
from pe_core.search.linkage import followers
from pe_core.search.rules import Trial

UNIT_M, UNIT_RAD = 0.01, math.radians(1.0)
"""One step: 1 cm along x, y and z of the ground frame, 1 deg of roll, pitch and yaw."""
SLACK = 1e-6
"""A value this far outside of its bounds is rounding [m or rad]."""
CLEARANCE = "standoff of "
"""A raw move off a surface also breaks the rule of its stand-off: one constraint, told once."""


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


@dataclass(frozen=True, slots=True)
class Move:
    """A design move: where it leads, and the constraints that forbid it (none: it is allowed)."""

    step: PoseStep
    rig: Rig
    forbidden_by: tuple[str, ...]


def lone_move(rig: Rig, step: PoseStep) -> Rig:
    """Return the rig with one sensor moved, all others as they are."""
    return rig.with_poses([_moved(rig, s.name, step) for s in rig])


class Neighbourhood:
    """The moves round a placement in the space of a search.

    Parameters
    ----------
    rig : Rig
        The placement; it breaks no rule.
    space : SearchSpace
        That of the search, with the bounds that it had at its start.
    """

    def __init__(self, rig: Rig, space: SearchSpace) -> None:
        self.rig, self.space = rig, space
        self.parametrization = Parametrization(rig, space)
        self._followers = followers(rig, space.mounting, space.vehicle)
        self._following = {each.name: each.leader for each in self._followers}
        self._variables = dict(self._positions())
        self._broken_here = self._broken(rig)

    @property
    def leaders(self) -> tuple[str, ...]:
        """Names of the sensors that follow no other."""
        return tuple(s.name for s in self.rig if s.name not in self._following)

    @property
    def links(self) -> dict[str, str]:
        """The leader of each sensor that follows another, by name."""
        return dict(self._following)

    def status(self, sensor: str, axis: str) -> str:
        """Return what the search does with an axis of a sensor.

        "free", "fixed", "linked" (it follows another sensor), "surface" or "slot".
        """
        if sensor in self._following:
            return "linked"
        mount = None if sensor in self.space.fixed else self.space.mounting.mount_of(sensor)
        if (sensor, axis) in self._variables:
            on_surface = isinstance(mount, SurfaceMount) and axis in POSITION_AXES
            return "surface" if on_surface else "free"
        return "fixed" if mount is None or isinstance(mount, SurfaceMount) else "slot"

    def with_housings(self, housings: Mapping[str, Housing]) -> Neighbourhood | None:
        """Return the same moves with other housings; None where these have no room.

        Each sensor keeps its origin, and what it is mounted on.
        """
        other = copy.copy(self)
        other.space = replace(self.space, housings=housings)
        other._broken_here = other._broken(self.rig)
        return other if other._broken_here <= self._broken_here else None

    def design_moves(self, units: float = 1.0) -> Iterator[Move]:
        """Yield the moves of each leader along each axis, back and forth."""
        for name in self.leaders:
            for axis in AXES:
                for step in (PoseStep(name, axis, -units), PoseStep(name, axis, units)):
                    yield self.design_move(step)

    def design_move(self, step: PoseStep) -> Move:
        """Return the move of a leader along an axis."""
        status = self.status(step.sensor, step.axis)
        if status == "surface":
            return self._along_surface(step)
        if status == "free":
            return self._within_bounds(step)
        mount = self.space.mounting.on.get(step.sensor)
        held = f"slots of {mount!r}" if status == "slot" else f"{step.axis} of {step.sensor!r} held"
        rig = self._carried(step)
        return Move(step, rig, (held, *self._rules(rig)))

    def _within_bounds(self, step: PoseStep) -> Move:
        number = self._variables[step.sensor, step.axis]
        variable, vector = self.parametrization.variables[number], list(self._vector)
        vector[number] += step.units * unit_of_axis(step.axis)
        if variable.low - SLACK <= vector[number] <= variable.high + SLACK:
            rig = self.parametrization.candidate(vector).rig
            return Move(step, rig, tuple(self._rules(rig)))
        rig = self._carried(step)
        held = f"bounds of {step.axis} of {step.sensor!r}"
        return Move(step, rig, (held, *self._rules(rig)))

    def _along_surface(self, step: PoseStep) -> Move:
        """Slide along the surface; where that leads nowhere, off its edge or away from it."""
        number, vector = self._variables[step.sensor, step.axis], list(self._vector)
        vector[number] += step.units * unit_of_axis(step.axis)
        rig = self.parametrization.candidate(vector).rig
        here, there = (each[step.sensor].pose.position for each in (self.rig, rig))
        if math.dist(here, there) >= 0.5 * abs(step.units) * UNIT_M:
            return Move(step, rig, tuple(self._rules(rig)))
        rig = self._carried(step)
        rules = (text for text in self._rules(rig) if not text.startswith(CLEARANCE))
        return Move(step, rig, (f"mount {self.space.mounting.on[step.sensor]!r}", *rules))

    @property
    def _vector(self) -> tuple[float, ...]:
        return self.parametrization.start.vector

    def _rules(self, rig: Rig) -> list[str]:
        """Return the rules that a rig breaks and the placement does not, in their order."""
        broken = self._broken(rig) - self._broken_here
        return [rule.text for rule in self.parametrization.rules if rule.text in broken]

    def _broken(self, rig: Rig) -> frozenset[str]:
        """Return the texts of the rules that a rig breaks, with the housings of the space."""
        trial = Trial(rig, self.space)
        return frozenset(r.text for r in self.parametrization.rules if r.broken(trial))

    def _carried(self, step: PoseStep) -> Rig:
        """Return the rig with a sensor moved, and all that follow it."""
        poses = {s.name: _moved(self.rig, s.name, step) for s in self.rig}
        for each in self._followers:
            poses[each.name] = each.pose(poses[each.leader])
        return self.rig.with_poses([poses[s.name] for s in self.rig])

    def _positions(self) -> Iterator[tuple[tuple[str, str], int]]:
        """Yield sensor and axis of each design variable, with its position in the vector."""
        number = 0
        for name in self.leaders:
            for axis in self._axes_of(name):
                yield (name, axis), number
                number += 1

    def _axes_of(self, name: str) -> tuple[str, ...]:
        if name in self.space.fixed:
            return ()
        bounds, mount = self.space.bounds.get(name, {}), self.space.mounting.mount_of(name)
        if mount is None:
            return tuple(axis for axis in AXES if axis in bounds)
        if isinstance(mount, SurfaceMount):
            return (*POSITION_AXES, *(axis for axis in AXES[3:] if axis in bounds))
        return ("slot",)


def unit_of_axis(axis: str) -> float:
    """Return one unit of a step along an axis [m or rad]."""
    return UNIT_M if axis in POSITION_AXES else UNIT_RAD


def _moved(rig: Rig, name: str, step: PoseStep) -> Pose:
    pose = rig[name].pose
    if name != step.sensor:
        return pose
    values = pose_values(pose)
    values[step.axis] += step.units * unit_of_axis(step.axis)
    return pose_from_values(values)
