"""The sensitivity analysis of a search's result: what is computed, its data, and its lines."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from pe_core.search import AXES, Objective
from pe_core.search.goals import FULL, OFF
from pe_core.study.condition_table import is_by_ap
from pe_core.study.requirement_search import RequirementConstraint
from pe_core.study.study import EXPECTED_AP, Study

from .flatness import (
    FAR,
    FLAT,
    NEAR,
    STEEP_AP,
    STEEP_NATS,
    ActiveConstraint,
    AxisCost,
    Neighbourhood,
    StepCosts,
    Unmet,
    active_constraints,
    flatness,
)
from .optima import BETWEEN, EXAMINED, Archive, Basins, Endings

SHARE = 8  # The analysis evaluates at most the search's evaluations divided by this
ENDINGS_NEED = EXAMINED * (1 + len(BETWEEN))
"""Evaluations that the endings of a search take at most, about."""
NAMED = 4  # How many axes, constraints or runners-up a line names


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """How sure a search is of its result. `evaluations`: rigs that were evaluated. `axes`: what a
    step costs, by sensor and axis. `constraints`: those that are active; one without names says
    that a longer search would gain. `endings`: where the starts ended; None where the budget was
    too small. `by_ap`: whether costs and gains are differences of the expected AP; positive is
    still worse."""

    evaluations: int
    axes: tuple[AxisCost, ...]
    constraints: tuple[ActiveConstraint, ...]
    endings: Endings | None
    by_ap: bool = False

    @property
    def active(self) -> tuple[ActiveConstraint, ...]:
        """The active constraints."""
        return tuple(each for each in self.constraints if each.constraints)

    @property
    def unfinished(self) -> ActiveConstraint | None:
        """An allowed step that would be better: the search was too short for it."""
        return next((each for each in self.constraints if not each.constraints), None)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data, as result.json holds it."""
        return {
            "evaluations": self.evaluations,
            "axes": [each.to_dict() for each in self.axes],
            "constraints": [each.to_dict() for each in self.constraints],
            "endings": None if self.endings is None else self.endings.to_dict(),
            **({"objective": EXPECTED_AP} if self.by_ap else {}),
        }


def budget_of(study: Study, evaluations: int) -> tuple[tuple[float, ...], bool] | None:
    """Return the steps of the table and whether the endings are examined; None for no analysis.
    Short searches have less, so that the analysis does not outlast them."""
    wanted, sensors = study.search.goals.sensitivity, len(study.rig)
    if wanted == OFF:
        return None
    if wanted == FULL:
        return (NEAR, FAR), True
    left = evaluations // SHARE
    near = 2 * len(AXES) * sensors  # back and forth
    if left < near:
        return None
    steps = (NEAR, FAR) if left >= 2 * near else (NEAR,)
    return steps, left >= 2 * near + ENDINGS_NEED


def analyse(
    start: Study,
    best: Study,
    archive: Archive,
    evaluations: int,
    objectives: Sequence[Objective],
    helpers: Callable[[], Executor | None] = lambda: None,
    goes_on: Callable[[], bool] = lambda: True,
) -> Sensitivity | None:
    """Return the sensitivity analysis of a search's result; None where its budget is too small. The
    result depends on the study alone, not on workers or time. `start` is the study as it was given,
    `best` with the result, `archive` what the search evaluated in so many `evaluations`.
    `objectives` are what the search minimised, on samples that it did not use. Where `goes_on`
    returns False, it is given up."""
    parts = budget_of(best, evaluations)
    if parts is None or not goes_on():
        return None
    steps, with_endings = parts
    space, by_ap = start.search_space(), is_by_ap(best)
    samples = StepCosts(best.rig, objectives, STEEP_AP if by_ap else STEEP_NATS, helpers)
    design = Neighbourhood(best.rig, space)
    axes = []
    for row in flatness(samples, design.status, steps):
        axes.append(row)
        if not goes_on():
            return None
    found = active_constraints(axes, design, _unmet_by(best))
    endings = Basins(samples, space).endings(archive.placements()) if with_endings else None
    return Sensitivity(samples.evaluations, tuple(axes), found, endings, by_ap)


def _unmet_by(study: Study) -> Unmet | None:
    """Return what names the kept requirements that a rig does not meet; None without any."""
    if not study.search.requirements or not study.requirements:
        return None
    held, names = RequirementConstraint(study), [each.name for each in study.requirements]
    return lambda rig: [n for n, off in zip(names, held.shortfalls(rig), strict=True) if off]


def sensitivity_lines(found: Sensitivity) -> Iterator[str]:
    """Yield the analysis in lines: steep and flat axes, constraints, other optima."""
    unit, axes = "of AP" if found.by_ap else "nats", found.axes
    ordered = sorted(axes, key=lambda each: -each.worst)
    steep = [each for each in ordered if each.worst > each.noticed][:NAMED]
    if steep:
        named = ", ".join(f"{each.sensor} {each.axis} {each.worst:+.4f}" for each in steep)
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
    for each in found.active[:NAMED]:
        yield f"held by {each.name}: {each.step.text} would gain {-each.gain:.4f} {unit}"
    if len(found.active) > NAMED:
        yield f"held by {len(found.active) - NAMED} more constraints"
    if not found.active:
        yield "no constraint limits the result"
    if (more := found.unfinished) is not None:
        gain = f"{-more.gain:.4f} {unit}"
        yield f"not quite settled: {more.step.text} is allowed and would gain {gain}"
    yield from _ending_lines(found, unit)


def _ending_lines(found: Sensitivity, unit: str) -> Iterator[str]:
    if found.endings is None:
        yield "where the starts ended: not examined, the search was too short"
        return
    count = len(found.endings.runners_up)
    if not count:
        same = found.endings.same_basin
        yield f"one optimum: {same} placements far from it lead to it without a hill between"
        return
    yield f"{count + 1} optima found; runners-up:"
    for number, each in enumerate(found.endings.runners_up, 1):
        sure = f" +- {each.stderr:.4f}" if each.stderr else ""
        moved = ", ".join(each.moved)
        yield f"  {number}: {each.behind:+.4f}{sure} {unit}, with {moved} elsewhere"
