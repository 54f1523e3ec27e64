"""A drive-by as a strip: AP of each sensor over time, and the moments of a body's track."""

from pe_core.motion import Scenario, SeenBody

from ... import graphics
from ...templating import Markup
from ..markup import number
from .charts import linear_map, ticks
from .svg import Canvas

WIDTH = 720.0
LEFT = 130.0
RIGHT = 640.0
TOP = 36.0
ROW = 16.0
GAP = 5.0
FOOT = 34.0
LETTERS = 14.0
INKS = {graphics.BRAKE: "#c4320a", graphics.CONFIRMED: "#1a7f4b"}
"""Colours of moments on a light ground, by those on a dark one."""


def strip_data(scenario: Scenario) -> str:
    """Return what moves a cursor: times and places of both ends, and the time of a film's start."""
    return " ".join(map(str, (*graphics.strip_ends(scenario), LEFT, RIGHT, scenario.start_s)))


def time_strip(scenario: Scenario, body: SeenBody, alt: str) -> Markup:
    """Return rows of AP over time, of the rig and each sensor, and the probability of a track.
    Vertical lines: confirmed with the scenario's probability; the last moment to brake."""
    rows = graphics.strip_rows(body)
    height = TOP + len(rows) * (ROW + GAP) + FOOT
    canvas = Canvas(WIDTH, height, alt, "curve")
    start, end = graphics.strip_ends(scenario)
    to_x = linear_map(start, end, LEFT, RIGHT)
    y = TOP
    width = (RIGHT - LEFT) / len(scenario.times)
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
    for row, mark in enumerate(graphics.marks_of(scenario, body)):
        x = to_x(mark.time_s)
        ink = INKS[mark.color]
        base = TOP - 9.0 - LETTERS * row
        canvas.add("line", x1=x, x2=x, y1=base - 9.0, y2=y, stroke=ink, stroke_width=2.0)
        anchor, away = ("end", -5.0) if x > (LEFT + RIGHT) / 2.0 else ("start", 5.0)
        canvas.text(x + away, base, mark.text, text_anchor=anchor, fill=ink)
    return canvas.svg()
