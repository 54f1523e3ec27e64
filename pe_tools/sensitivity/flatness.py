"""How flat an optimum is: what 1 cm and 1 deg cost, by sensor and axis."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig
from pe_core.search import AXES, POSITION_AXES, pose_from_values, pose_values

from .fresh_samples import STEEP_NATS, Difference, FreshSamples

UNIT_M, UNIT_RAD = 0.01, math.radians(1.0)
"""One unit: 1 cm along x, y and z of the ground frame, 1 deg of roll, pitch and yaw."""

NEAR, FAR = 1.0, 5.0
"""Steps to both sides [cm or deg]."""
FLAT, STEEP = "flat", "steep"


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
    """What moving one sensor alone along one axis costs.

    `status` is what the search does with the axis: "free", "surface", "slot", "fixed" or "linked".
    `cost` is by step [cm or deg] how much the entropy rises [nats] (or the expected AP falls). From
    a cost of `steep` on the axis is steep.
    """

    sensor: str
    axis: str
    status: str
    cost: Mapping[float, Difference]
    steep: float = STEEP_NATS

    @property
    def worst(self) -> Difference:
        """The higher cost of one step back or forth."""
        return max((self.cost[-NEAR], self.cost[NEAR]), key=lambda each: each.mean)

    @property
    def word(self) -> str:
        """ "steep", "flat" (no step as far as was looked has a cost), or empty."""
        if self.worst.is_loss and self.worst.mean >= self.steep:
            return STEEP
        return "" if any(each.is_loss or each.is_gain for each in self.cost.values()) else FLAT

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        cost = {f"{step:+g}": each.to_list() for step, each in sorted(self.cost.items())}
        return {"sensor": self.sensor, "axis": self.axis, "status": self.status, "cost": cost}


def flatness(
    samples: FreshSamples,
    status: Callable[[str, str], str],
    steps: tuple[float, ...] = (NEAR, FAR),
) -> Iterator[AxisCost]:
    """Yield the costs of each axis of each sensor, in the rig's order, for steps to both sides.

    `status` returns what the search does with an axis of a sensor.
    """
    both = (*(-each for each in steps), *steps)
    for sensor in samples.reference:
        moved = {
            (axis, units): lone_move(samples.reference, PoseStep(sensor.name, axis, units))
            for axis in AXES
            for units in both
        }
        samples.evaluate([samples.reference, *moved.values()])
        for axis in AXES:
            cost = {units: samples.change(moved[axis, units]) for units in both}
            own = status(sensor.name, axis)
            yield AxisCost(sensor.name, axis, own, cost, samples.steep)
