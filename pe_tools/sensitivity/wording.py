"""A sensitivity analysis in lines for the terminal and the panel."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from .analysis import Sensitivity
from .flatness import FLAT, AxisCost
from .fresh_samples import Difference

NAMED = 4
"""How many axes, constraints or runners-up a line names."""


def nats(change: Difference) -> str:
    """Return a difference with its error: "+0.0123 +- 0.0004"."""
    return f"{change.mean + 0.0:+.4f} +- {max(change.stderr, 1e-4):.4f}"


def sensitivity_lines(found: Sensitivity) -> Iterator[str]:
    """Yield the analysis in lines: steep and flat axes, constraints, other optima."""
    yield from _axes_lines(found.axes, unit_of(found))
    yield from _constraint_lines(found)
    yield from _ending_lines(found)


def unit_of(found: Sensitivity) -> str:
    """Return the unit of costs and gains: "nats", or "of AP" after a search by expected AP."""
    return "of AP" if found.by_ap else "nats"


def _axes_lines(axes: Sequence[AxisCost], unit: str) -> Iterator[str]:
    ordered = sorted(axes, key=lambda each: -each.worst.mean)
    steep = [each for each in ordered if each.worst.is_loss][:NAMED]
    if steep:
        named = ", ".join(f"{each.sensor} {each.axis} {each.worst.mean:+.4f}" for each in steep)
        yield f"1 cm or 1 deg off costs most at: {named} {unit}"
    else:
        yield "1 cm or 1 deg off costs nothing that can be measured, at no sensor and axis"
    if flat := [each for each in axes if each.word == FLAT]:
        reach = f"{max(max(each.cost) for each in flat):g}"
        named = "; ".join(
            f"{sensor} {', '.join(row.axis for row in rows)}"
            for sensor, rows in groupby(flat, key=lambda each: each.sensor)
        )
        yield f"flat within {reach} cm or deg: {named}"


def _constraint_lines(found: Sensitivity) -> Iterator[str]:
    unit = unit_of(found)
    for each in found.active[:NAMED]:
        yield f"held by {each.name}: {each.step.text} would gain {gain_text(each.gain)} {unit}"
    if len(found.active) > NAMED:
        yield f"held by {len(found.active) - NAMED} more constraints"
    if not found.active:
        yield "no constraint holds it back: no step that is forbidden would gain"
    if (more := found.unfinished) is not None:
        gain = f"{gain_text(more.gain)} {unit}"
        yield f"not quite settled: {more.step.text} is allowed and would gain {gain}"


def gain_text(gain: Difference) -> str:
    """Return what a step gains, with its error."""
    return f"{-gain.mean:.4f} +- {max(gain.stderr, 1e-4):.4f}"


def _ending_lines(found: Sensitivity) -> Iterator[str]:
    if found.endings is None:
        yield "where the starts ended: not examined, the search was too short"
        return
    count = len(found.endings.runners_up)
    same = found.endings.same_basin
    if not count:
        yield f"one optimum: {same} placements far from it lead to it without a hill between"
        return
    what, unit = "scenes" if found.by_ap else "voxels", unit_of(found)
    yield f"{count + 1} optima found; runners-up, {found.voxels:,} fresh {what}:"
    for number, each in enumerate(found.endings.runners_up, 1):
        yield f"  {number}: {nats(each.behind)} {unit}, with {', '.join(each.moved)} elsewhere"
