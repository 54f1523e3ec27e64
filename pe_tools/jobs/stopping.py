"""When a search ends before its budget does, and how sure it is of its result then."""

import math
import time
from collections import deque
from collections.abc import Sequence
from statistics import stdev

from pe_core.base.values import rounded
from pe_core.search import Objective, Step, Stop, Value
from pe_core.search.goals import GAIN_OVER

from ..advice import flatness_lines
from .job import Outcome
from .searched_figure import IN_NATS, SearchedFigure

# Reasons, as result.json names them
TARGET = "target"
SECONDS = "seconds"
GAIN = "gain"
APART = 2.0
"""Within so many standard deviations of the descents of one search, another seed's result lies."""


class StopWatch:
    """Watches the steps of one search. There is an objective for each level: a target that is
    reached on few voxels is checked on the last one. `started` is `time.monotonic()` when the first
    search of a job began; `target` is the figure that ends the search."""

    def __init__(
        self,
        stop: Stop,
        objectives: Sequence[Objective],
        started: float,
        figure: SearchedFigure = IN_NATS,
        target: float | None = None,
    ) -> None:
        self._stop = stop
        self._objectives = objectives
        self._started = started
        self._figure = figure
        self._target = None if target is None else figure.to_value(target)
        self._bests: deque[Value] = deque(maxlen=GAIN_OVER + 1)
        self._checked: Value | None = None

    def reason(self, step: Step) -> str:
        """Return why the search ends after a step; empty where it goes on."""
        if self._is_at_target(step):
            return TARGET
        if self._stop.gain is not None and step.level == len(self._objectives) - 1:
            self._bests.append(step.value)
            full = len(self._bests) == GAIN_OVER + 1
            if full and self._bests[0].rise_from(self._bests[-1]) < self._stop.gain:
                return GAIN
        seconds = self._stop.seconds
        is_over = seconds is not None and time.monotonic() - self._started >= seconds
        return SECONDS if is_over else ""

    def _is_at_target(self, step: Step) -> bool:
        target = self._target
        if target is None or step.value > target:
            return False
        if step.level == len(self._objectives) - 1:
            return True
        if step.value == self._checked:
            return False
        self._checked = step.value
        return self._objectives[-1].value(step.best) <= target


def stop_text(outcome: Outcome) -> str:
    """Return why a search ended early, as text; empty without a reason."""
    stop = outcome.start.search.goals.stop
    figure = outcome.figure
    target = figure.target(outcome.start)
    at = "" if target is None else f" of {figure.amount(f'{target:g}')}"
    gain = figure.amount(f"{stop.gain or 0.0:g}")
    return {
        TARGET: f"ended at its target{at}",
        SECONDS: f"ended after {stop.seconds or 0.0:g} s",
        GAIN: f"ended: {GAIN_OVER} placements gained less than {gain}",
    }.get(outcome.stop_reason, "")


def seed_scatter(ends: Sequence[Value]) -> float | None:
    """Return within what another seed would probably end [nats], by where descents of one search
    ended that shared nothing but their start; None where they are fewer than two, or infeasible."""
    figures = [each.objective for each in ends]
    if len(ends) < 2 or not all(map(math.isfinite, figures)):
        return None
    return rounded(APART * stdev(figures))


def scatter_text(outcome: Outcome) -> str:
    """Return how far from a result another seed would end, as text; empty where nothing tells."""
    if outcome.seed_scatter is None:
        return ""
    unit = "of expected AP" if outcome.figure.higher_is_better else "nats"
    return f"another seed would probably end within {outcome.seed_scatter:.3f} {unit}"


def sureness_lines(outcome: Outcome) -> list[str]:
    """Describe how sure a search is of its result; empty for a score."""
    figure = outcome.figure
    sample = "" if outcome.own is not None else ", on the sample of the search"
    lines = [] if outcome.flatness is None else list(flatness_lines(outcome.flatness))
    unit = "of expected AP" if figure.higher_is_better else "nats"
    lines += [] if outcome.rounding is None else outcome.rounding.lines(unit)
    lines += [] if outcome.consensus is None else outcome.consensus.lines(unit)
    for end in outcome.starts:
        name = f"the start {end.name}" if end.name else "the given start"
        lines.append(f"{name} ended {figure.ended(end.value)}{sample}")
    told = scatter_text(outcome), stop_text(outcome)
    return [*lines, *filter(None, told)]
