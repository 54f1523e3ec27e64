"""The first screen: what was asked, what changed, what is met, what got worse, and what remains
blind. Whether a difference is one is decided by the rule of all front ends (`advice`)."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from pe_core.scoring.score import SURE
from pe_core.search import ENTROPY, FIGURES, REQUIREMENTS, Figure, KeyFigures, Reading

from ... import advice
from ...wording import margin_text
from ..markup import joined
from ..report_context import ReportContext

SENSORS_NAMED = 4  # With more, how many
SAME = 0
BETTER = -1
WORSE = 1


class FigureRow(NamedTuple):
    """A figure as the first screen shows it. `before` is empty without a search. `sense`: whether
    it is better, worse, or no different beyond its error. `met` is None without a limit."""

    key: str
    label: str
    unit: str
    before: str
    after: str
    sense: int
    wanted: str
    met: bool | None
    kept: bool


def decision(context: ReportContext) -> dict[str, Any]:
    """Return what a reader decides by: rows of figures, and what is met and what is not."""
    rows = list(figure_rows(context))
    outcome = context.outcome
    missed = [verdict for verdict in outcome.verdicts if not verdict.met]
    limits = [row for row in rows if row.met is not None and row.key != REQUIREMENTS]
    return {
        "rows": rows,
        "asked": asked(context),
        "moved": advice.moved_words(context.start.rig, context.rig),
        "worse": [row for row in rows if row.sense == WORSE],
        "better": [row for row in rows if row.sense == BETTER],
        "met": sum(row.met is True for row in limits) + len(outcome.verdicts) - len(missed),
        "of": len(limits) + len(outcome.verdicts),
        "missed": [
            *(f"{row.label} {row.after}, wanted {row.wanted}" for row in limits if not row.met),
            *(f"{verdict.name}: {margin_text(verdict.summary)}" for verdict in missed),
        ],
    }


def asked(context: ReportContext) -> str:
    """Return what was asked of a search: by what, and what it had to keep; empty for a score."""
    if not context.was_searched:
        return ""
    limits = context.start.limits
    kept = [FIGURES[key].name for key, limit in limits if limit.kept]
    moved = [sensor.name for sensor in context.start.rig]
    names = joined(moved) if len(moved) <= SENSORS_NAMED else f"{len(moved)} sensors"
    keeping = f", keeping {joined(kept)}" if kept else ""
    return f"better positions for {names}, by {context.outcome.figure.label}{keeping}"


def figure_rows(context: ReportContext) -> Iterator[FigureRow]:
    """Yield the rows of the dashboard, with what they were before a search."""
    outcome = context.outcome
    first = None if outcome.figures is None or not context.was_searched else outcome.figures[0]
    errors = outcome.change_errors if context.was_searched else {}
    for reading in outcome.dashboard:
        figure = reading.figure
        if reading.value is None:
            continue
        before = _before(context, reading, first)
        wanted = "" if reading.wanted is None else figure.number(reading.wanted)
        yield FigureRow(
            key=figure.key,
            label=figure.label,
            unit=figure.unit.replace("m2", "m²"),
            before="" if before is None else figure.number(before),
            after=("≥ " if reading.is_cut else "") + figure.number(reading.value),
            sense=_sense(figure, before, reading.value, errors.get(figure.key, 0.0)),
            wanted=wanted,
            met=reading.met,
            kept=reading.kept,
        )


def _before(context: ReportContext, reading: Reading, first: KeyFigures | None) -> float | None:
    """Return a figure before the search; None without one, or where it is not known."""
    if not context.was_searched:
        return None
    if reading.figure.key == ENTROPY:
        return context.outcome.before.entropy
    return reading.figure.value(first) if reading.figure.is_seen else None


def _sense(figure: Figure, before: float | None, after: float, error: float) -> int:
    if before is None or figure.number(before) == figure.number(after):
        return SAME
    if abs(after - before) <= SURE * error:
        return SAME
    return WORSE if figure.cost_of(after) > figure.cost_of(before) else BETTER
