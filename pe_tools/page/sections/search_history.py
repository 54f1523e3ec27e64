"""The search: its convergence curve (SVG), the moves of each sensor, and robustness."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import pe_core as pe
from pe_core import scene, search
from pe_core.base.errors import plural

from ... import advice, jobs
from ..markup import ARROW, Markup, capitalized, escaped, number, signed, table, triple
from ..report_context import ReportContext, Section

WIDTH, HEIGHT = 720, 260
LEFT, RIGHT, TOP, BOTTOM = 54, 14, 14, 38
TICKS = 4
MIN_MOVE_M, MIN_TURN_DEG = 5e-6, 5e-5
"""Smaller moves and turns are rounding errors."""
AxisMap = Callable[[float], float]
"""Maps a value to its position on the drawing."""


def search_history(context: ReportContext) -> Section:
    """Return the section on the search; empty for a study that was only scored."""
    if not context.was_searched:
        return Section("search", "Search", "")
    tables = f"{_move_table(context)}{_robustness_table(context)}"
    inside = f"<p>{_method_text(context)}</p>{_curve(context)}{tables}"
    return Section("search", "Search", inside)


def _method_text(context: ReportContext) -> str:
    settings = context.start.search
    levels, what = jobs.searched_on(context.start)
    stopped = " It was stopped early." if context.outcome.stopped else ""
    return (
        f"Method {escaped(settings.method)}, seed {settings.seed}: "
        f"{plural(context.outcome.evaluations, 'placement')} evaluated on "
        f"{levels} {what}.{stopped}{_ended_text(context)}"
    )


def _ended_text(context: ReportContext) -> str:
    """Return why the search ended early, and where each of its starts ended."""
    outcome, figure = context.outcome, jobs.searched_figure(context.start)
    reason = jobs.stop_text(outcome.stop_reason, context.start)
    sentences = [f" It {reason}."] if reason else []
    for end in outcome.starts:
        name = f"the start {escaped(end.name)}" if end.name else "the given start"
        at = figure.amount(number(figure.to_figure(end.entropy), 4))
        sentences.append(f" From {name}: {at}.")
    return "".join(sentences)


def _curve(context: ReportContext) -> str:
    if len(context.history) < 2:
        return ""
    figure = jobs.searched_figure(context.start)
    found = jobs.best_so_far(context.history)
    points = [(evaluation, figure.to_figure(value)) for evaluation, value in found]
    by_ap = figure.higher_is_better
    unit, digits = (figure.label, 3) if by_ap else ("nats", 2)
    curve = step_curve(points, context.outcome.evaluations, "placements evaluated", unit)
    first, last = (number(points[k][1], digits) for k in (0, -1))
    caption = (
        f"Best expected AP so far: from {first} to {last}, on the samples of the search."
        if by_ap
        else f"Best entropy so far: from {first} to {last} nats, on the samples of the search."
    )
    alt = f"Convergence curve. {caption}"
    return (
        f'<figure class="curve keep" role="img" aria-label="{escaped(alt)}">{curve}'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _move_table(context: ReportContext) -> str:
    heads = (
        "sensor",
        "moved",
        "from x, y, z [m]",
        "to x, y, z [m]",
        "turned",
        "roll, pitch, yaw [deg]",
    )
    return table("Moves of the sensors", heads, _move_rows(context))


def _move_rows(context: ReportContext) -> Iterator[list[str]]:
    for old, new in zip(context.start.rig, context.rig, strict=True):
        moved = math.dist(old.pose.position, new.pose.position)
        turned = _rotation_deg(old.pose, new.pose)
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


def _rotation_deg(old: pe.Pose, new: pe.Pose) -> float:
    """Return the angle of the rotation from one pose to the other [deg]."""
    first, last = (scene.rotation_matrix(*pose.rpy) for pose in (old, new))
    cosine = (float((first * last).sum()) - 1.0) / 2.0  # the sum is trace(first.T @ last)
    return math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))


def _robustness_table(context: ReportContext) -> str:
    robustness = context.robustness
    if robustness is None:
        return ""
    errors = capitalized(advice.off_by(robustness.errors.position, robustness.errors.angle))
    rows = [
        ["As mounted", *_before_after(robustness, "entropy")],
        [f"{errors} (1 sigma), mean", *_before_after(robustness, "mounted_off")],
        ["... worst", *_before_after(robustness, "mounted_worst")],
    ]
    if robustness.after.failed is not None:
        worst = f"... worst ({robustness.after.missed})"
        rows.append(["One sensor lost, mean", *_before_after(robustness, "failed")])
        rows.append([worst, *_before_after(robustness, "failed_worst")])
    what = "objects" if context.after.objects else "voxels"
    title = f"Robustness: entropy in nats, on {robustness.samples:,} {what}"
    return table(title, ("", "before", "after", "change"), rows)


def _before_after(robustness: search.Robustness, field: str) -> list[str | Markup]:
    before, after = getattr(robustness.before, field), getattr(robustness.after, field)
    css = "better" if after < before else "worse" if after > before else ""
    difference = Markup(f'<span class="{css}">{signed(after - before)}</span>')
    return [number(before), number(after), difference]


def _linear_map(first: float, last: float, low: float, high: float) -> AxisMap:
    """Return the linear map from [first, last] to [low, high]."""
    rate = (high - low) / (last - first)
    return lambda value: low + (value - first) * rate


def step_curve(points: Sequence[tuple[float, float]], end: float, x: str, y: str) -> str:
    """Return a step curve as SVG: each value holds until the next point, the last until `end`.

    Parameters
    ----------
    points : sequence of (x, y)
        In order of x.
    end : float
        Last x.
    x, y : str
        Labels of the axes.
    """
    low, high = min(value for _, value in points), max(value for _, value in points)
    tick_values = ticks(low, high)
    low, high = min(low, tick_values[0]), max(high, tick_values[-1])
    to_x = _linear_map(points[0][0], max(end, points[-1][0] + 1), LEFT, WIDTH - RIGHT)
    to_y = _linear_map(high, low, TOP, HEIGHT - BOTTOM)
    start, last = to_y(points[0][1]), points[-1][1]
    path = [f"M{to_x(points[0][0]):.1f} {start:.1f}"]
    path += [f"H{to_x(at):.1f}V{to_y(value):.1f}" for at, value in points[1:]]
    path.append(f"H{to_x(max(end, points[-1][0])):.1f}")
    inside = [
        *_value_axis(tick_values, to_y),
        *_evaluation_axis(ticks(points[0][0], max(end, points[-1][0] + 1)), to_x),
        f'<path class="start" d="M{LEFT} {start:.1f}H{WIDTH - RIGHT}"/>',
        f'<path class="step" d="{"".join(path)}"/>',
        f'<circle class="end" cx="{to_x(points[-1][0]):.1f}" cy="{to_y(last):.1f}" r="4"/>',
        f'<text x="{WIDTH - RIGHT}" y="{HEIGHT - 6}" text-anchor="end">{escaped(x)}</text>',
        f'<text x="4" y="{HEIGHT - 6}">{escaped(y)}</text>',
    ]
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
        f'aria-hidden="true">{"".join(inside)}</svg>'
    )


def ticks(low: float, high: float) -> list[float]:
    """Return round numbers that span the range from `low` to `high`."""
    if high <= low:
        high = low + max(abs(low), 1.0) * 1e-3
    rough = (high - low) / TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * k for k in (1.0, 2.0, 5.0, 10.0) if power * k >= rough * (1.0 - 1e-9))
    first, last = math.floor(low / step), math.ceil(high / step)
    return [round(k * step, 12) for k in range(first, last + 1)]


def _value_axis(tick_values: list[float], to_y: AxisMap) -> Iterator[str]:
    digits = max(0, -math.floor(math.log10(tick_values[1] - tick_values[0]) + 1e-9))
    for tick in tick_values:
        at = to_y(tick)
        yield f'<path class="axis" d="M{LEFT} {at:.1f}H{WIDTH - RIGHT}"/>'
        text = number(tick, digits)
        yield f'<text x="{LEFT - 8}" y="{at + 4:.1f}" text-anchor="end">{text}</text>'


def _evaluation_axis(tick_values: list[float], to_x: AxisMap) -> Iterator[str]:
    for tick in tick_values:
        at = to_x(tick)
        if LEFT <= at <= WIDTH - RIGHT:
            yield f'<text x="{at:.1f}" y="{HEIGHT - 22}" text-anchor="middle">{tick:,.0f}</text>'
