"""The search: its convergence curve, moves, robustness, and how sure its result is."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from pe_core import scene

from ... import advice, jobs
from ... import sensitivity as sure
from ..markup import capitalized, number, triple
from ..pictures.charts import cost_bars, step_curve
from ..report_context import ReportContext

MIN_MOVE_M, MIN_TURN_DEG = 5e-6, 5e-5
"""Smaller moves and turns are rounding errors."""
ARROW = "\N{RIGHTWARDS ARROW}"
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
    return {
        "levels": levels,
        "what": what,
        "reason": jobs.stop_text(outcome.stop_reason, context.start),
        "starts": [
            (end.name, figure.amount(number(figure.to_figure(end.entropy), 4)))
            for end in outcome.starts
        ],
        "curve": curve,
        "caption": caption,
        "moves": list(_moves(context)),
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


def _moves(context: ReportContext) -> Iterator[list[str]]:
    """Yield how far each sensor was moved and turned."""
    for old, new in zip(context.start.rig, context.rig, strict=True):
        moved = math.dist(old.pose.position, new.pose.position)
        # The angle of the rotation from one pose to the other [deg].
        first, last = (scene.rotation_matrix(*pose.rpy) for pose in (old.pose, new.pose))
        cosine = (float((first * last).sum()) - 1.0) / 2.0  # the sum is trace(first.T @ last)
        turned = math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))
        angles = triple(new.pose.rotation_deg, 1)
        if turned >= MIN_TURN_DEG:
            angles = f"{triple(old.pose.rotation_deg, 1)} {ARROW} {angles}"
        yield [
            new.name,
            f"{number(moved)} m" if moved >= MIN_MOVE_M else "no",
            triple(old.pose.position),
            triple(new.pose.position),
            f"{number(turned, 1)}°" if turned >= MIN_TURN_DEG else "no",
            angles,
        ]


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
