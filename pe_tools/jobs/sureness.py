"""How sure a search is, in lines: its analysis, where its starts ended, and why it ended."""

from __future__ import annotations

from ..sensitivity import sensitivity_lines
from .job import Outcome
from .stopping import stop_text


def sureness_lines(outcome: Outcome) -> list[str]:
    """Describe how sure a search is of its result; empty for a score."""
    lines = [] if outcome.sensitivity is None else list(sensitivity_lines(outcome.sensitivity))
    for end in outcome.starts:
        name = f"the start {end.name}" if end.name else "the given start"
        lines.append(f"{name} ended at {end.entropy:.4f} nats, on the sample of the search")
    text = stop_text(outcome.stop_reason, outcome.start.search.goals.stop)
    return [*lines, text] if text else lines
