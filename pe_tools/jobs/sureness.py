"""How sure a search is, in lines: its analysis, where its starts ended, and why it ended."""

from __future__ import annotations

from ..sensitivity import sensitivity_lines
from .job import Outcome
from .searched_figure import searched_figure
from .stopping import stop_text


def sureness_lines(outcome: Outcome) -> list[str]:
    """Describe how sure a search is of its result; empty for a score."""
    figure = searched_figure(outcome.start)
    lines = [] if outcome.sensitivity is None else list(sensitivity_lines(outcome.sensitivity))
    for end in outcome.starts:
        name = f"the start {end.name}" if end.name else "the given start"
        at = figure.amount(f"{figure.to_figure(end.entropy):.4f}")
        lines.append(f"{name} ended at {at}, on the sample of the search")
    text = stop_text(outcome.stop_reason, outcome.start)
    return [*lines, text] if text else lines
