"""Charts as SVG: the curve of a search, what steps of sensors cost, pairs of objectives."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

import pe_core as pe
from pe_core.base.arrays import Floats

from ... import sensitivity as sure
from ..markup import MINUS, number
from .svg import Canvas

AxisMap = Callable[[float], float]
"""Maps a value to its position on the drawing."""
LEAST_NATS, LEAST_AP = 0.004, 0.0004
"""The axis of costs shows at least this, so that noise does not look like a slope [nats; AP]."""


def round_steps() -> Iterator[float]:
    """Yield 1, 2, 5, 10, ... times 1e-12: steps of an axis."""
    power = -12
    while True:
        yield from (float(f"{digit}e{power}") for digit in (1, 2, 5))
        power += 1


def linear_map(first: float, last: float, low: float, high: float) -> AxisMap:
    """Return the linear map from [first, last] to [low, high]."""
    rate = (high - low) / (last - first)
    return lambda value: low + (value - first) * rate


def ticks(low: float, high: float, most: int = 4) -> list[float]:
    """Return round numbers that span the range from `low` to `high`, in `most` steps or so."""
    if high <= low:
        high = low + max(abs(low), 1.0) * 1e-3
    least = (high - low) / most * (1.0 - 1e-9)
    step = next(step for step in round_steps() if step >= least)
    first, last = math.floor(low / step), math.ceil(high / step)
    return [round(k * step, 12) for k in range(first, last + 1)]


def step_curve(
    points: Sequence[tuple[float, float]], end: float, x: str, y: str, alt: str
) -> Markup:
    """Return a step curve: each value holds until the next point, the last until `end`. `points`
    are (x, y) in order of x; `x` and `y` are labels of the axes."""
    width, height, left, right, top, bottom = 720.0, 260.0, 54.0, 706.0, 14.0, 222.0
    canvas = Canvas(width, height, alt, "curve")
    values = [value for _, value in points]
    tick_values = ticks(min(values), max(values))
    first = points[0][0]
    last = max(end, points[-1][0] + 1)
    to_x = linear_map(first, last, left, right)
    to_y = linear_map(max(*values, tick_values[-1]), min(*values, tick_values[0]), top, bottom)
    digits = max(0, -math.floor(math.log10(tick_values[1] - tick_values[0]) + 1e-9))
    for tick in tick_values:
        at = to_y(tick)
        canvas.add("path", css="axis", d=f"M{left:.0f} {at:.1f}H{right:.0f}")
        canvas.text(left - 8.0, at + 4.0, number(tick, digits), text_anchor="end")
    for tick in ticks(first, last):
        if left <= to_x(tick) <= right:
            canvas.text(to_x(tick), height - 22.0, f"{tick:,.0f}", text_anchor="middle")
    start = to_y(values[0])
    path = "".join(f"H{to_x(at):.1f}V{to_y(value):.1f}" for at, value in points[1:])
    begin, stop = f"M{to_x(first):.1f} {start:.1f}", f"H{to_x(max(end, points[-1][0])):.1f}"
    canvas.add("path", css="start", d=f"M{left:.0f} {start:.1f}H{right:.0f}")
    canvas.add("path", css="step", d=f"{begin}{path}{stop}")
    canvas.add("circle", css="end", cx=to_x(points[-1][0]), cy=to_y(values[-1]), r=4.0)
    canvas.text(right, height - 6.0, x, text_anchor="end")
    canvas.text(4.0, height - 6.0, y)
    return canvas.svg()


def cost_bars(found: sure.Sensitivity, status: dict[str, str], alt: str) -> Markup:
    """Return what one step back and forth costs, a row for each axis of each sensor. `status` says
    what the search does with an axis, where that is more than to move it."""
    width, left, right, row_height, group, top = 484.0, 120.0, 444.0, 18.0, 30.0, 10.0
    sensors = list(dict.fromkeys(row.sensor for row in found.axes))
    costs = [row.cost[step] for row in found.axes for step in (-sure.NEAR, sure.NEAR)]
    least = LEAST_AP if found.by_ap else LEAST_NATS
    low = min(-least, *(each.mean - each.stderr for each in costs))
    high = max(least, *(each.mean + each.stderr for each in costs))
    to_x = linear_map(low, high, left, right)
    height = top + len(sensors) * group + len(found.axes) * row_height + 26.0
    canvas = Canvas(width, height, alt, "curve flatness")
    step = next(u for u in round_steps() if int(high / u) + int(-low / u) <= 5)
    for k in range(-int(-low / step), int(high / step) + 1):
        x = to_x(k * step)
        grid = {"x1": x, "x2": x, "y1": top, "y2": height - 26.0}
        canvas.add("line", css="grid" if k else "axis", **grid)
        text = f"{round(k * step, 6):+g}".replace("-", MINUS) if k else "0"
        canvas.text(x, height - 7.0, text, text_anchor="middle")
    canvas.text(width - 4.0, height - 7.0, "AP" if found.by_ap else "nats", text_anchor="end")
    y = top
    for sensor in sensors:
        y += group
        canvas.text(4.0, y - 8.0, sensor, css="name")
        for row in (each for each in found.axes if each.sensor == sensor):
            note = f" ({status[row.status]})" if row.status in status else ""
            canvas.text(left - 8.0, y + 11.0, f"{row.axis}{note}", text_anchor="end")
            for at, cost in ((y + 2.0, row.cost[-sure.NEAR]), (y + 8.0, row.cost[sure.NEAR])):
                _draw_cost(canvas, to_x, at, cost)
            y += row_height
    return canvas.svg()


def _draw_cost(canvas: Canvas, to_x: AxisMap, y: float, cost: sure.Difference) -> None:
    """Draw a bar, and its standard error as a line."""
    a, b = sorted((to_x(0.0), to_x(cost.mean)))
    css = "rise" if cost.mean >= 0.0 else "fall"
    canvas.add("rect", css=css, x=a, y=y, width=max(b - a, 0.5), height=5.0)
    ends = {"x1": to_x(cost.mean - cost.stderr), "x2": to_x(cost.mean + cost.stderr)}
    canvas.add("line", css="error", y1=y + 2.5, y2=y + 2.5, **ends)


Points = Sequence[tuple[float, float]]


def pareto_plot(front: Points, others: Points, labels: tuple[str, str], alt: str) -> Markup:
    """Return designs by two objectives: those of the front with their numbers."""
    size, left, right, top, bottom = 330.0, 62.0, 316.0, 12.0, 286.0
    canvas = Canvas(size, size, alt, "fronts")
    x_ticks, y_ticks = (ticks_around([point[k] for point in (*others, *front)]) for k in (0, 1))
    to_x = linear_map(x_ticks[0], x_ticks[-1], left, right)
    to_y = linear_map(y_ticks[0], y_ticks[-1], bottom, top)
    for tick in x_ticks:
        canvas.add("line", x1=to_x(tick), x2=to_x(tick), y1=top, y2=bottom)
        canvas.text(to_x(tick), bottom + 16.0, four_digits(tick), text_anchor="middle")
    for tick in y_ticks:
        canvas.add("line", x1=left, x2=right, y1=to_y(tick), y2=to_y(tick))
        canvas.text(left - 6.0, to_y(tick) + 4.0, four_digits(tick), text_anchor="end")
    for a, b in others:
        canvas.add("circle", css="beaten", cx=to_x(a), cy=to_y(b), r=4.0)
    for rank, (a, b) in enumerate(front, 1):
        canvas.add("circle", cx=to_x(a), cy=to_y(b), r=9.0)
        canvas.text(to_x(a), to_y(b) + 4.0, str(rank), text_anchor="middle", css="number")
    style = {"text_anchor": "middle", "css": "label"}
    canvas.text((left + right) / 2.0, size - 8.0, labels[0], **style)
    middle = (top + bottom) / 2.0
    turned = f"rotate(-90 14 {middle:.0f})"
    canvas.text(14.0, middle, labels[1], transform=turned, **style)
    return canvas.svg()


def curve_plot(
    curve: pe.ApCurve, m: Floats, ap: Floats, used: NDArray[np.bool_], alt: str
) -> Markup:
    """Return AP against the measurement on a logarithmic axis: the curve, and the points of a fit;
    those left out are empty circles."""
    width, height, left, right, top, bottom = 480.0, 330.0, 62.0, 466.0, 12.0, 286.0
    canvas = Canvas(width, height, alt, "fronts")
    low, high = (math.log10(end) for end in (m[m > 0.0].min() / 1.5, m.max() * 1.5))
    to_x, to_y = linear_map(low, high, left, right), linear_map(0.0, 1.0, bottom, top)
    for power in range(math.ceil(low), math.floor(high) + 1):
        canvas.add("line", x1=to_x(power), x2=to_x(power), y1=top, y2=bottom)
        canvas.text(to_x(power), bottom + 16.0, f"{10.0**power:g}", text_anchor="middle")
    for tick in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0):
        canvas.add("line", x1=left, x2=right, y1=to_y(tick), y2=to_y(tick))
        canvas.text(left - 6.0, to_y(tick) + 4.0, f"{tick:g}", text_anchor="end")
    drawn = [low + (high - low) * k / 199.0 for k in range(200)]
    heights = (min(max(curve.a * math.log(10.0) * at + curve.b, 0.001), 0.999) for at in drawn)
    line = [(to_x(at), to_y(height)) for at, height in zip(drawn, heights, strict=True)]
    canvas.path([np.array(line)], closed=False, css="fit")
    for x, y, is_used in zip(m, ap, used, strict=True):
        if x > 0.0:
            css = {} if is_used else {"css": "beaten"}
            canvas.add("circle", cx=to_x(math.log10(x)), cy=to_y(float(y)), r=4.0, **css)
    canvas.text(
        (left + right) / 2.0, height - 8.0, "measurement, m", text_anchor="middle", css="label"
    )
    canvas.text(14.0, top + 4.0, "AP", css="label")
    return canvas.svg()


def ticks_around(values: Sequence[float]) -> list[float]:
    """Return a few round numbers, the first below all values and the last above."""
    low, high = min(values), max(values)
    width = (high - low) or max(abs(high), 1.0) * 0.1
    step = next(step for step in round_steps() if width / step <= 4)
    first, last = math.ceil(low / step - 1e-9) - 1, math.floor(high / step + 1e-9) + 1
    return [round(k * step, 12) for k in range(first, last + 1)]


def four_digits(value: float) -> str:
    """Return a figure of the axis or the table with four digits."""
    text = f"{value:,.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    return ("0" if float(text.replace(",", "")) == 0.0 else text).replace("-", MINUS)
