"""What relaxing a constraint by one size would gain.

A size is what can be bought or built next. Where a housing touches, it is the next smaller housing
of the catalogue, of the same kind of sensor, with which the sensor can go on; the sensor measures
as before, from where it was. Where a mount ends it is the next larger step, and of a list of slots
one slot more, as far away as these are from each other. A few constraints have no sizes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from pe_core import catalog
from pe_core.scene.housing import Housing
from pe_core.scene.rig import Rig, Sensor
from pe_core.search import SlotMount, pose_values

from .flatness import FAR
from .fresh_samples import Difference, FreshSamples
from .moves import Neighbourhood, PoseStep, lone_move, unit_of_axis

HOUSING, LENGTH, SLOT = "housing", "length", "slot"
KINDS = {
    "max_height of ": HOUSING,
    "max_width of ": HOUSING,
    "no_go ": HOUSING,
    "clear housings of ": HOUSING,
    "the body for ": HOUSING,
    "bounds of ": LENGTH,
    "mount ": LENGTH,
    "min_distance of ": LENGTH,
    "link of ": LENGTH,
    "slots of ": SLOT,
}
"""What has sizes, by the beginning of a constraint's text."""
HELD = " held"
"""The end of the text of a held axis, whose size is a length or an angle."""
A_SLOT = "one slot"
NONE = "none"
"""The size of a constraint that has no sizes, or of a housing that no smaller one would help."""
MAX_UNITS = 25
"""With a smaller housing a sensor moves so many cm (or degrees) at most."""
FINE = 10
"""A step with a smaller housing is a whole number of units divided by this: mm."""


@dataclass(frozen=True, slots=True)
class SizeGain:
    """What one size more (of a mount) or less (of a housing) would gain.

    Attributes
    ----------
    size : str
        The model whose housing is the next smaller one, "5 cm", "one slot", or "none".
    sensors : tuple of str
        The sensors that would have that housing; empty for another size.
    step : PoseStep or None
        The step that gains most; None without a size.
    gain : Difference or None
        How much the entropy changes: negative is better [nats].
    """

    size: str
    sensors: tuple[str, ...] = ()
    step: PoseStep | None = None
    gain: Difference | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data; `gain` is positive."""
        if self.step is None or self.gain is None:
            return {"size": self.size}
        mean, stderr = self.gain.to_list()
        return {
            "size": self.size,
            "housing_of": list(self.sensors),
            "axis": self.step.axis,
            "step": self.step.units,
            "gain": -mean,
            "stderr": stderr,
        }


class SizePricing:
    """Finds what a size of each constraint would gain.

    Parameters
    ----------
    samples : FreshSamples
    neighbourhood : Neighbourhood
    """

    def __init__(self, samples: FreshSamples, neighbourhood: Neighbourhood) -> None:
        self._samples, self._around = samples, neighbourhood

    def gain(self, constraints: Sequence[str], step: PoseStep) -> SizeGain:
        """Return the gain where each of the constraints that forbid a step is relaxed by a size."""
        kinds = {_kind(text) for text in constraints}
        if "" in kinds or not kinds or kinds >= {HOUSING, SLOT}:
            return SizeGain(NONE)
        if HOUSING in kinds:
            return self._with_smaller_housing(constraints, step)
        if SLOT in kinds:
            return self._with_a_slot_more(constraints, step)
        return self._with_a_larger_step(constraints, step)

    def _with_a_larger_step(self, constraints: Sequence[str], step: PoseStep) -> SizeGain:
        larger = PoseStep(step.sensor, step.axis, math.copysign(FAR, step.units))
        steps = [step, larger] if self._is_allowed(larger, constraints) else [step]
        return self._best(f"{FAR:g} {step.unit}", (), steps)

    def _with_a_slot_more(self, constraints: Sequence[str], step: PoseStep) -> SizeGain:
        units = self._slot_spacing(step)
        further = PoseStep(step.sensor, step.axis, math.copysign(units, step.units))
        if not units or not self._is_allowed(further, constraints):
            return SizeGain(NONE)
        return self._best(A_SLOT, (), [further])

    def _slot_spacing(self, step: PoseStep) -> float:
        """Return the smallest distance of two slots along the axis of a step [cm or deg], or 0."""
        mount = self._around.space.mounting.mount_of(step.sensor)
        slots = mount.slots if isinstance(mount, SlotMount) else ()
        values = sorted({round(pose_values(slot.pose)[step.axis], 6) for slot in slots})
        gaps = [b - a for a, b in pairwise(values)]
        return round(min(gaps, default=0.0) / unit_of_axis(step.axis), 1)

    def _with_smaller_housing(self, constraints: Sequence[str], step: PoseStep) -> SizeGain:
        """Return the best gain that a smaller housing of one sensor (or one pair) brings."""
        others = [text for text in constraints if _kind(text) != HOUSING]
        longest = FAR if others else MAX_UNITS
        gains = [
            self._best(model, sensors, self._steps(step, reach))
            for sensors in self._who_touch(constraints)
            for model, reach in [self._next_smaller(sensors, step, others, longest)]
            if reach
        ]
        return min(gains, key=_mean, default=SizeGain(NONE))

    def _who_touch(self, constraints: Sequence[str]) -> Iterator[tuple[str, ...]]:
        """Yield the sensors that constraints name, each with its mirror image, once."""
        pairs = [tuple(pair) for pair in self._around.space.mounting.pairs]
        named = [s.name for s in self._around.rig if any(repr(s.name) in c for c in constraints)]
        groups = [next((pair for pair in pairs if name in pair), (name,)) for name in named]
        yield from dict.fromkeys(groups)

    def _next_smaller(
        self, sensors: tuple[str, ...], step: PoseStep, others: Sequence[str], longest: float
    ) -> tuple[str, float]:
        """Return the next smaller housing with which a step is possible, and how far [units]."""
        known = self._around.space.housings
        if sensors[0] in known:
            today = _reach(self._around, step, others, longest)
            for model, housing in smaller_housings(self._around.rig[sensors[0]], known[sensors[0]]):
                around = self._around.with_housings({**known, **dict.fromkeys(sensors, housing)})
                if around and (reach := _reach(around, step, others, longest)) > today:
                    return model, reach
        return NONE, 0.0

    def _is_allowed(self, step: PoseStep, relaxed: Sequence[str]) -> bool:
        """Whether a step breaks no other constraints than those that are relaxed."""
        if step.sensor in self._around.links:
            return True  # a lone move: the link is all that holds it
        return set(self._around.design_move(step).forbidden_by) <= set(relaxed)

    @staticmethod
    def _steps(step: PoseStep, reach: float) -> list[PoseStep]:
        """Return the step as far as it goes, half as far, and itself if it is within."""
        far = {reach, round(reach / 2.0, 1), *([1.0] if reach > 1.0 else [])} - {0.0}
        return [step._replace(units=math.copysign(each, step.units)) for each in sorted(far)]

    def _best(self, size: str, sensors: tuple[str, ...], steps: Sequence[PoseStep]) -> SizeGain:
        rigs = [self._moved(step) for step in steps]
        self._samples.evaluate(rigs)
        return min(
            (
                SizeGain(size, sensors, step, self._samples.change(rig))
                for step, rig in zip(steps, rigs, strict=True)
            ),
            key=_mean,
        )

    def _moved(self, step: PoseStep) -> Rig:
        if step.sensor in self._around.links:
            return lone_move(self._around.rig, step)
        return self._around.design_move(step).rig


def smaller_housings(sensor: Sensor, housing: Housing) -> Iterator[tuple[str, Housing]]:
    """Yield the housings of the catalogue with less volume, of the same kind, largest first.

    Of models with equal housings the first is named.
    """
    own, found = _volume(housing), dict[tuple[float, ...], tuple[float, str, Housing]]()
    for name in catalog.names(sensor.kind):
        other = catalog.housing(name)
        if other is not None and _volume(other) < own:
            key = (*other.size, *other.optical_center)
            found.setdefault(key, (_volume(other), name, other))
    for _, name, other in sorted(found.values(), key=lambda each: -each[0]):
        yield name, other


def _volume(housing: Housing) -> float:
    share = math.pi / 4.0 if housing.shape == "cylinder" else 1.0
    return share * math.prod(housing.size)


def _reach(around: Neighbourhood, step: PoseStep, others: Sequence[str], longest: float) -> float:
    """Return how far a sensor may go with other housings: whole units, then tenths [units]."""

    def is_free(tenths: int) -> bool:
        units = math.copysign(tenths / FINE, step.units)
        return set(around.design_move(step._replace(units=units)).forbidden_by) <= set(others)

    reach, most = 0, round(longest * FINE)
    for stride in (FINE, 1):
        while reach + stride <= most and is_free(reach + stride):
            reach += stride
    return reach / FINE


def _kind(constraint: str) -> str:
    """Return what kind of sizes a constraint has; empty: none."""
    if constraint.endswith(HELD):
        return LENGTH
    return next((kind for start, kind in KINDS.items() if constraint.startswith(start)), "")


def _mean(size: SizeGain) -> float:
    return math.inf if size.gain is None else size.gain.mean
