"""The curve of a search as a drawing that scales (SVG)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

from .figures import number
from .markup import escaped

WIDTH, HEIGHT = 720, 260
LEFT, RIGHT, TOP, BOTTOM = 54, 14, 14, 38
TICKS = 4
Onto = Callable[[float], float]
"""Takes a value to where it stands on the drawing."""


def _line(first: float, last: float, low: float, high: float) -> Onto:
    """Return what takes values from one range to another, as a straight line does."""
    rate = (high - low) / (last - first)
    return lambda value: low + (value - first) * rate


def step_curve(points: Sequence[tuple[float, float]], end: float, x: str, y: str) -> str:
    """Return a curve that keeps each value until the next, from the first point to `end`.

    Parameters
    ----------
    points : sequence of (x, y)
        By growing x.
    end : float
        Where it ends along x.
    x, y : str
        What stands at the axes.
    """
    low, high = min(value for _, value in points), max(value for _, value in points)
    marks = ticks(low, high)
    low, high = min(low, marks[0]), max(high, marks[-1])
    to_x = _line(points[0][0], max(end, points[-1][0] + 1), LEFT, WIDTH - RIGHT)
    to_y = _line(high, low, TOP, HEIGHT - BOTTOM)
    start, last = to_y(points[0][1]), points[-1][1]
    path = [f"M{to_x(points[0][0]):.1f} {start:.1f}"]
    path += [f"H{to_x(at):.1f}V{to_y(value):.1f}" for at, value in points[1:]]
    path.append(f"H{to_x(max(end, points[-1][0])):.1f}")
    inside = [
        *_across(marks, to_y),
        *_along(ticks(points[0][0], max(end, points[-1][0] + 1)), to_x),
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
    """Round numbers from at or below one to at or above the other."""
    if high <= low:
        high = low + max(abs(low), 1.0) * 1e-3
    rough = (high - low) / TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * k for k in (1.0, 2.0, 5.0, 10.0) if power * k >= rough * (1.0 - 1e-9))
    first, last = math.floor(low / step), math.ceil(high / step)
    return [round(k * step, 12) for k in range(first, last + 1)]


def _across(marks: list[float], to_y: Onto) -> Iterator[str]:
    digits = max(0, -math.floor(math.log10(marks[1] - marks[0]) + 1e-9))
    for mark in marks:
        at = to_y(mark)
        yield f'<path class="axis" d="M{LEFT} {at:.1f}H{WIDTH - RIGHT}"/>'
        text = number(mark, digits)
        yield f'<text x="{LEFT - 8}" y="{at + 4:.1f}" text-anchor="end">{text}</text>'


def _along(marks: list[float], to_x: Onto) -> Iterator[str]:
    for mark in marks:
        at = to_x(mark)
        if LEFT <= at <= WIDTH - RIGHT:
            yield f'<text x="{at:.1f}" y="{HEIGHT - 22}" text-anchor="middle">{mark:,.0f}</text>'
