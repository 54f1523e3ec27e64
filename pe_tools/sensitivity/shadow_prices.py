"""Active constraints, and what relaxing each by 1 cm or 1 deg would gain: shadow prices.

A constraint is active if a step of 1 cm or 1 deg that it forbids lowers the entropy. The gain of
the best such step is a lower bound of the shadow price: after it, other sensors could follow. A
step that several constraints forbid is told with all of them. `sizes` adds what a size would gain.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pe_core.scene.rig import Rig
from pe_core.search import AXES

from .flatness import AxisCost
from .fresh_samples import Difference, FreshSamples
from .moves import Neighbourhood, PoseStep
from .sizes import SizeGain, SizePricing

Unmet = Callable[[Rig], Sequence[str]]
"""Names of the requirements that a rig does not meet and that are to be kept."""


@dataclass(frozen=True, slots=True)
class ShadowPrice:
    """A constraint (or several) that keeps a sensor from a better place.

    Attributes
    ----------
    constraints : tuple of str
        What forbids the step; none: nothing does, so a longer search would gain this.
    step : PoseStep
        The step that gains most.
    gain : Difference
        How much the entropy changes: negative [nats].
    size : SizeGain or None
        What one size would gain; None where the budget of the analysis was spent.
    """

    constraints: tuple[str, ...]
    step: PoseStep
    gain: Difference
    size: SizeGain | None = None

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
            "size": None if self.size is None else self.size.to_dict(),
        }


def with_sizes(
    prices: Iterable[ShadowPrice], sizes: SizePricing, has_budget: Callable[[], bool] = lambda: True
) -> tuple[ShadowPrice, ...]:
    """Return active constraints with what one size of each would gain, as the budget allows."""
    return tuple(
        replace(each, size=sizes.gain(each.constraints, each.step))
        if each.constraints and has_budget()
        else each
        for each in prices
    )


def shadow_prices(
    samples: FreshSamples,
    neighbourhood: Neighbourhood,
    table: Iterable[AxisCost],
    unmet: Unmet | None = None,
) -> tuple[ShadowPrice, ...]:
    """Return the active constraints, the highest price first; without a constraint last.

    Parameters
    ----------
    samples : FreshSamples
    neighbourhood : Neighbourhood
    table : iterable of AxisCost
        Lone moves: the price of a link is what one of the linked sensors gains alone.
    unmet : callable, optional
        Requirements that are to be kept.
    """
    found: dict[tuple[str, ...], ShadowPrice] = {}
    for price in (
        *_of_design(samples, neighbourhood, unmet),
        *_of_links(neighbourhood, table),
    ):
        known = found.get(price.constraints)
        if known is None or price.gain.mean < known.gain.mean:
            found[price.constraints] = price
    return tuple(sorted(found.values(), key=lambda p: (not p.constraints, p.gain.mean)))


def _of_design(
    samples: FreshSamples, neighbourhood: Neighbourhood, unmet: Unmet | None
) -> Iterator[ShadowPrice]:
    moves = list(neighbourhood.design_moves())
    samples.evaluate(move.rig for move in moves)
    for move in moves:
        gain = samples.change(move.rig)
        if gain.is_gain:
            broken = () if unmet is None else unmet(move.rig)
            names = (*move.forbidden_by, *(f"requirement {name!r}" for name in broken))
            yield ShadowPrice(names, move.step, gain)


def _of_links(neighbourhood: Neighbourhood, table: Iterable[AxisCost]) -> Iterator[ShadowPrice]:
    """Yield what a linked sensor would gain if it could move alone."""
    links = neighbourhood.links
    for row in table:
        leader = links.get(row.sensor)
        if leader is None or row.axis not in AXES:
            continue
        for units in (-1.0, 1.0):
            if row.cost[units].is_gain:
                name = f"link of {row.sensor!r} to {leader!r}"
                yield ShadowPrice((name,), PoseStep(row.sensor, row.axis, units), row.cost[units])
