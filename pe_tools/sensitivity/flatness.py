"""How flat an optimum is: what 1 cm and 1 deg cost, by sensor and axis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pe_core.search import AXES

from .fresh_samples import STEEP_NATS, Difference, FreshSamples
from .moves import Neighbourhood, PoseStep, lone_move

NEAR, FAR = 1.0, 5.0
"""Steps to both sides [cm or deg]."""
FLAT, STEEP = "flat", "steep"


@dataclass(frozen=True, slots=True)
class AxisCost:
    """What moving one sensor alone along one axis costs.

    Attributes
    ----------
    sensor, axis : str
    status : str
        What the search does with the axis: "free", "surface", "slot", "fixed" or "linked".
    cost : mapping of float to Difference
        By step [cm or deg]: how much the entropy rises [nats] (or the expected AP falls); negative:
        it falls (or rises).
    steep : float
        From this cost of one step on the axis is steep.
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
    samples: FreshSamples, neighbourhood: Neighbourhood, steps: tuple[float, ...] = (NEAR, FAR)
) -> Iterator[AxisCost]:
    """Yield the costs of each axis of each sensor, in the rig's order."""
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
            status = neighbourhood.status(sensor.name, axis)
            yield AxisCost(sensor.name, axis, status, cost, samples.steep)
