"""The ground plan as SVG to scale: footprints of sensors, the vehicle's outline, blind ground. The
sheet's units are metres, with a layer per sensor.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from pe_tools.exchange import Written
from pe_tools.graphics import color_text
from pe_tools.outputs import SceneOutput
from pe_tools.outputs.ground_plan import ClosedLines, GroundFootprint, GroundPlan, ground_plan
from pe_tools.outputs.request import BLIND, BODY, OutputRequest

FILE = "footprints.svg"
SCALE = 100
"""Denominator of the scale of the sheet, 1:SCALE."""
SVG, INKSCAPE = "http://www.w3.org/2000/svg", "http://www.inkscape.org/namespaces/inkscape"
INK = "#333333"
GRID_M, MARGIN_M, MARK_M = 10.0, 2.0, 0.8
MIN_HALF_M = 15.0
"""The sheet is at least twice as wide: the legend has room."""
BLIND_TEXT = "ground within 10 m of the body that no sensor sees"
LINE, TEXT = 1.1, 0.75
"""Height of a line of the legend and of its letters [m]."""
STYLE = """
text { font-family: Arial, Helvetica, sans-serif; fill: #333333; }
.grid { stroke: #dddddd; stroke-width: 0.03; fill: none; }
.body { stroke-width: 0.05; fill-rule: evenodd; }
.seen { fill-opacity: 0.16; stroke-width: 0.06; fill-rule: evenodd; }
.blind { fill-opacity: 0.5; fill-rule: evenodd; }
.scale { stroke: #333333; stroke-width: 0.08; fill: none; }
"""
OnPaper = tuple[float, float, float, float]


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return the plan as a drawing, and lines on what is not in it."""
    plan, lines = ground_plan(request)
    return {FILE: svg_text(plan).encode()}, lines


def svg_text(plan: GroundPlan) -> str:
    """Return a drawing: x to the right, y up, the vehicle's origin at (0, 0)."""
    x0, y0, x1, y1 = box = _box(plan)
    top = -y1 - LINE * (len(plan.footprints) + 2.5)
    width, height = x1 - x0, -y0 - top
    paper = [f"{1000.0 * side / SCALE:.1f}mm" for side in (width, height)]
    left, low = x0 + MARGIN_M / 2.0, -y0 - MARGIN_M / 2.0
    bar = [f'<path class="scale" d="M{left:g},{low - 0.3:g}v0.3h{GRID_M:g}v-0.3"/>']
    bar.append(_text(left, low - 0.5, f"{GRID_M:g} m, 1:{SCALE}"))
    sheet = f'x="{x0:.2f}" y="{top:.2f}" width="{width:.2f}" height="{height:.2f}"'
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="{SVG}" xmlns:inkscape="{INKSCAPE}" width="{paper[0]}" height="{paper[1]}"'
        f' viewBox="{x0:.2f} {top:.2f} {width:.2f} {height:.2f}">',
        f"<title>Footprints of sensors on the ground, 1:{SCALE}</title>",
        f"<style>{STYLE}</style>",
        f'<rect {sheet} fill="#ffffff"/>',
        *_layer("grid", "Grid", _grid(box)),
        *(
            line
            for f in plan.footprints
            for line in _layer(
                f"sensor-{f.plain}", f.name, _path(f.outlines, "seen", color_text(f.color))
            )
        ),
        *_layer("blind-ground", "Blind ground", _path(plan.blind, "blind", color_text(BLIND))),
        *_layer("vehicle", "Vehicle", _path(plan.vehicle, "body", color_text(BODY))),
        *_layer("sensors", "Sensors", [line for f in plan.footprints for line in _mark(f)]),
        *_layer("legend", "Legend", _legend(plan, left, top)),
        *_layer("scale", "Scale", bar),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _box(plan: GroundPlan) -> OnPaper:
    """Return the extent of the sheet, x0, y0, x1, y1, in whole metres; it contains the origin."""
    loops = [*plan.vehicle, *plan.blind, *(loop for f in plan.footprints for loop in f.outlines)]
    points = np.vstack([*loops, [f.pose.position[:2] for f in plan.footprints], [[0.0, 0.0]]])
    low, high = points.min(axis=0) - MARGIN_M, points.max(axis=0) + MARGIN_M
    low[0], high[0] = min(low[0], -MIN_HALF_M), max(high[0], MIN_HALF_M)
    (x0, y0), (x1, y1) = np.floor(low).tolist(), np.ceil(high).tolist()
    return x0, y0, x1, y1


def _layer(key: str, label: str, parts: Iterable[str]) -> list[str]:
    """Return a group that drawing programs show as a layer."""
    name = f"id={quoteattr(key)} inkscape:label={quoteattr(label)}"
    return [f'<g {name} inkscape:groupmode="layer">', *parts, "</g>"]


def _path(loops: ClosedLines, kind: str, color: str) -> list[str]:
    """Return closed outlines as one shape, in which one inside another is a hole."""
    steps = ("M" + "L".join(f"{x:.3f},{-y:.3f}" for x, y in loop[:-1].tolist()) for loop in loops)
    data = "Z".join(steps)
    line = "" if kind == "blind" else f' stroke="{INK if kind == "body" else color}"'
    return [f'<path class="{kind}" fill="{color}"{line} d="{data}Z"/>'] if data else []


def _mark(footprint: GroundFootprint) -> list[str]:
    """Return a disc at a sensor's position, and a line in its viewing direction."""
    x, y, _ = footprint.pose.position
    ahead = footprint.pose.ground_from_sensor[:2, 0] * MARK_M
    color = color_text(footprint.color)
    ends = f'x1="{x:.3f}" y1="{-y:.3f}" x2="{x + ahead[0]:.3f}" y2="{-y - ahead[1]:.3f}"'
    return [
        f'<line {ends} stroke="{INK}" stroke-width="0.05"/>',
        f'<circle cx="{x:.3f}" cy="{-y:.3f}" r="0.12" fill="{color}" stroke="{INK}"'
        f' stroke-width="0.04"><title>{escape(footprint.name)}</title></circle>',
    ]


def _grid(box: OnPaper) -> list[str]:
    x0, y0, x1, y1 = box
    across = np.arange(math.ceil(x0 / GRID_M), math.floor(x1 / GRID_M) + 1) * GRID_M
    along = np.arange(math.ceil(y0 / GRID_M), math.floor(y1 / GRID_M) + 1) * GRID_M
    lines = [f"M{x:g},{-y1:g}V{-y0:g}" for x in across] + [f"M{x0:g},{-y:g}H{x1:g}" for y in along]
    return [f'<path class="grid" d="{"".join(lines)}"/>']


def _legend(plan: GroundPlan, x: float, top: float) -> list[str]:
    rows = []
    for f in plan.footprints:
        reach = f"to {f.reach:g} m" if f.outlines else "sees no ground"
        height = f"{f.pose.position[2]:.2f} m high"
        rows.append((color_text(f.color), f"{f.name} ({f.model}), {height}, {reach}"))
    rows += [(color_text(BLIND), BLIND_TEXT)] if plan.blind else []
    parts = []
    for number, (color, text) in enumerate(rows, 1):
        y = top + LINE * number + MARGIN_M / 4.0
        mark = f'x="{x:.2f}" y="{y - TEXT:.2f}" width="{TEXT}" height="{TEXT}"'
        parts.append(f'<rect {mark} fill="{color}" fill-opacity="0.7"/>')
        parts.append(_text(x + 2.0 * TEXT, y - 0.1, text))
    return parts


def _text(x: float, y: float, text: str) -> str:
    return f'<text x="{x:.2f}" y="{y:.2f}" font-size="{TEXT}">{escape(text)}</text>'


OUTPUT = SceneOutput("footprints-svg", "Footprints on the Ground (SVG)", FILE, write)
