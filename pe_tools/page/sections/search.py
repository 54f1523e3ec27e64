"""The search: its convergence curve, moves, robustness, and how sure its result is."""

from __future__ import annotations

import math
from typing import Any

from markupsafe import Markup

from pe_core import scene

from ... import advice, jobs
from ... import sensitivity as sure
from ..markup import capitalized, number
from ..pictures.charts import cost_bars, step_curve
from ..report_context import ReportContext

STATUS = {
    "free": "free",
    "surface": "on its mount",
    "slot": "in its slot",
    "fixed": "held",
    "linked": "linked",
}
"""What the search does with an axis, in the table."""


def search_history(context: ReportContext) -> dict[str, Any] | None:
    """Return the course of a search; None for a study that was only scored."""
    if not context.was_searched:
        return None
    outcome, robustness = context.outcome, context.outcome.robustness
    levels, what = jobs.searched_on(context.start)
    figure = jobs.searched_figure(context.start)
    curve, caption = _curve(context, figure)
    moves = []  # how far each sensor was moved [m] and turned [deg]
    for old, new in zip(context.start.rig, context.rig, strict=True):
        first, last = (scene.rotation_matrix(*each.pose.rpy) for each in (old, new))
        cosine = (float((first * last).sum()) - 1.0) / 2.0  # the sum is trace(first.T @ last)
        turned = math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))
        moves.append((old, new, math.dist(old.pose.position, new.pose.position), turned))
    return {
        "levels": levels,
        "what": what,
        "reason": jobs.stop_text(outcome.stop_reason, context.start),
        "searched": figure,
        "curve": curve,
        "caption": caption,
        "moves": moves,
        "robustness": robustness,
        "errors": capitalized(
            advice.off_by(robustness.errors.position, robustness.errors.angle) if robustness else ""
        ),
    }


def _curve(context: ReportContext, figure: jobs.SearchedFigure) -> tuple[Markup | str, str]:
    """Return the convergence curve and its caption; empty texts without any progress."""
    if len(context.outcome.history) < 2:
        return "", ""
    found = jobs.best_so_far(context.outcome.history)
    points = [(evaluation, figure.to_figure(value)) for evaluation, value in found]
    by_ap = figure.higher_is_better
    first, last = (number(points[k][1], 3 if by_ap else 2) for k in (0, -1))
    what, unit = ("expected AP", "") if by_ap else ("entropy", " nats")
    caption = f"Best {what} so far: from {first} to {last}{unit}, on the samples of the search."
    label = figure.label if by_ap else "nats"
    alt = f"Convergence curve. {caption}"
    evaluations = context.outcome.evaluations
    return step_curve(points, evaluations, "placements evaluated", label, alt), caption


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
