"""A drive-by as a strip: AP of each sensor over time, and the moments of a body's track."""

from __future__ import annotations

from markupsafe import Markup

from pe_core.motion import SeenBody, Story

from ... import graphics
from ..markup import number
from .charts import linear_map, ticks
from .svg import Canvas

WIDTH, LEFT, RIGHT = 720.0, 130.0, 640.0
ENDS = LEFT, RIGHT
TOP, ROW, GAP, FOOT = 22.0, 16.0, 5.0, 34.0


def time_strip(story: Story, body: SeenBody, alt: str) -> Markup:
    """Return rows of AP over time, of the rig and each sensor, and the probability of a track.

    Vertical lines: confirmed with the story's probability; the last moment to brake.
    """
    rows = graphics.strip_rows(body)
    height = TOP + len(rows) * (ROW + GAP) + FOOT
    canvas = Canvas(WIDTH, height, alt, "curve")
    half = 0.5 / story.rate_hz
    start, end = float(story.times[0]) - half, float(story.times[-1]) + half
    to_x = linear_map(start, end, LEFT, RIGHT)
    y = TOP
    width = to_x(half * 2.0) - to_x(0.0)
    for name, cells in rows.items():
        canvas.text(LEFT - 8.0, y + ROW - 4.0, name, text_anchor="end")
        for first, last, ap in cells:
            box = {"x": LEFT + first * width, "y": y, "width": (last - first) * width}
            color = graphics.color_text(graphics.color_of_ap(ap, graphics.NEVER))
            canvas.add("rect", fill=color, height=ROW, **box)
        y += ROW + GAP
    for tick in ticks(start, end, 6):
        if start <= tick <= end:
            canvas.text(to_x(tick), height - 18.0, f"{number(tick, 1)} s", text_anchor="middle")
    _mark(canvas, to_x(max(story.brake_s, start)), y, "must brake", "#c4320a", left=False)
    if (moment := body.moments[story.chance]) is not None:
        text = f"confirmed {story.chance:.0%}, {moment.distance_m:.1f} m"
        _mark(canvas, to_x(moment.time_s), y, text, "#1a7f4b", left=True)
    return canvas.svg()


def _mark(canvas: Canvas, x: float, bottom: float, text: str, color: str, left: bool) -> None:
    canvas.add("line", x1=x, x2=x, y1=TOP - 6.0, y2=bottom, stroke=color, stroke_width=2.0)
    to_left = left and x > LEFT + 150.0
    anchor, away = ("end", -5.0) if to_left else ("start", 5.0)
    canvas.text(x + away, TOP - 9.0, text, text_anchor=anchor, fill=color)
