"""How sure the search is: what steps cost, active constraints, other optima."""

from __future__ import annotations

from typing import Any

from ... import jobs
from ... import sensitivity as sure
from ..pictures.charts import cost_bars
from ..report_context import ReportContext

STATUS = {
    "free": "free",
    "surface": "on its mount",
    "slot": "in its slot",
    "fixed": "held",
    "linked": "linked",
}
"""What the search does with an axis, in the table."""


def sensitivity(context: ReportContext) -> dict[str, Any] | None:
    """Return how sure the search is; None without the analysis."""
    found = context.outcome.sensitivity
    if found is None:
        return None
    noted = {key: text for key, text in STATUS.items() if key not in ("free", "surface")}
    alt = "What a step of each sensor along each axis costs; the figures are in the table below."
    return {
        "found": found,
        "what": jobs.searched_on(context.start)[1],
        "picture": cost_bars(found, noted, alt),
        "status": STATUS,
        "steps": sorted({step for row in found.axes for step in row.cost}),
        "gain_text": sure.gain_text,
    }
