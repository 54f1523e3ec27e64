"""Charts as SVG: the curve of a search, what steps of sensors cost, pairs of objectives."""

import math
from collections.abc import Callable, Iterator, Sequence

from ...templating import Markup
from ..markup import MINUS, number
from .svg import Canvas

AxisMap = Callable[[float], float]  # Maps a value to its position on the drawing
Points = Sequence[tuple[float, float]]


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
    first = math.floor(low / step)
    last = math.ceil(high / step)
    return [round(k * step, 12) for k in range(first, last + 1)]


def step_curve(
    points: Sequence[tuple[float, float]], end: float, x: str, y: str, alt: str
) -> Markup:
    """Return a step curve: each value holds until the next point, the last until `end`. `points`
    are (x, y) in order of x; `x` and `y` are labels of the axes."""
    width = 720.0
    height = 260.0
    left = 54.0
    right = 706.0
    top = 14.0
    bottom = 222.0
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
    begin = f"M{to_x(first):.1f} {start:.1f}"
    stop = f"H{to_x(max(end, points[-1][0])):.1f}"
    canvas.add("path", css="start", d=f"M{left:.0f} {start:.1f}H{right:.0f}")
    canvas.add("path", css="step", d=f"{begin}{path}{stop}")
    canvas.add("circle", css="end", cx=to_x(points[-1][0]), cy=to_y(values[-1]), r=4.0)
    canvas.text(right, height - 6.0, x, text_anchor="end")
    canvas.text(4.0, height - 6.0, y)
    return canvas.svg()


def pareto_plot(front: Points, others: Points, labels: tuple[str, str], alt: str) -> Markup:
    """Return designs by two objectives: those of the front with their numbers."""
    size = 330.0
    left = 62.0
    right = 316.0
    top = 12.0
    bottom = 286.0
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


def ticks_around(values: Sequence[float]) -> list[float]:
    """Return a few round numbers, the first below all values and the last above."""
    low = min(values)
    high = max(values)
    width = (high - low) or max(abs(high), 1.0) * 0.1
    step = next(step for step in round_steps() if width / step <= 4)
    first = math.ceil(low / step - 1e-9) - 1
    last = math.floor(high / step + 1e-9) + 1
    return [round(k * step, 12) for k in range(first, last + 1)]


def four_digits(value: float) -> str:
    """Return a figure of the axis or the table with four digits."""
    text = f"{value:,.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    return ("0" if float(text.replace(",", "")) == 0.0 else text).replace("-", MINUS)
