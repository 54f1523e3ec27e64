"""The ground plan as DXF, written with ezdxf: in millimetres, one layer per sensor."""

from __future__ import annotations

import io
from collections.abc import Iterable
from contextlib import contextmanager
from typing import Any

import ezdxf
from ezdxf import units

from pe_tools.graphics import color_text
from pe_tools.outputs import BLIND, OutputRequest, SceneOutput
from pe_tools.outputs.ground_plan import GroundFootprint, ground_plan

FILE = "footprints.dxf"
MM = 1000.0
VEHICLE, BLIND_GROUND, LABELS = "VEHICLE", "BLIND_GROUND", "LABELS"
MARK_M, AHEAD_M, TEXT_M = 0.06, 0.5, 0.15
"""Of a sensor: the radius of its circle, its stroke to where it looks, its letters [m]."""
GREY = (90, 90, 90)


def write(request: OutputRequest) -> tuple[dict[str, bytes], list[str]]:
    """Return the plan from above as DXF, and lines on what is not in it."""
    plan, lines = ground_plan(request)
    return {FILE: dxf_bytes(plan)}, lines


def dxf_bytes(plan: Any) -> bytes:
    """Return a `GroundPlan` as a drawing: x forward, y left, the origin at (0, 0)."""
    with _same_every_time():
        drawing = ezdxf.new("R2010", units=units.MM)
        space = drawing.modelspace()
        _layer(drawing, VEHICLE, GREY)
        _layer(drawing, BLIND_GROUND, _rgb(color_text(BLIND)))
        _layer(drawing, LABELS, GREY)
        _outlines(space, VEHICLE, plan.vehicle)
        _outlines(space, BLIND_GROUND, plan.blind)
        for footprint in plan.footprints:
            layer = f"SENSOR_{footprint.plain}"
            _layer(drawing, layer, _rgb(color_text(footprint.color)))
            _outlines(space, layer, footprint.outlines)
            _mark(space, layer, footprint)
        text = io.StringIO()
        drawing.write(text)
    return text.getvalue().encode()


@contextmanager
def _same_every_time() -> Any:
    """Make the file reproducible: no dates and no random names."""
    previous = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = previous


def _layer(drawing: Any, name: str, color: tuple[int, int, int]) -> None:
    drawing.layers.add(name, true_color=ezdxf.rgb2int(color))


def _outlines(space: Any, layer: str, outlines: Iterable[Any]) -> None:
    for outline in outlines:
        points = [(x * MM, y * MM) for x, y in outline[:-1].tolist()]
        space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})


def _mark(space: Any, layer: str, footprint: GroundFootprint) -> None:
    """Draw a sensor's position, at its height, its viewing direction, and its name."""
    position = [value * MM for value in footprint.pose.position]
    ahead = footprint.pose.ground_from_sensor[:, 0] * AHEAD_M * MM
    attributes = {"layer": layer}
    space.add_circle(position, MARK_M * MM, dxfattribs=attributes)
    space.add_line(
        position, [a + b for a, b in zip(position, ahead.tolist(), strict=True)], attributes
    )
    label = space.add_text(footprint.name, height=TEXT_M * MM, dxfattribs={"layer": LABELS})
    label.set_placement((position[0] + 2.0 * MARK_M * MM, position[1] + 2.0 * MARK_M * MM))


def _rgb(color: str) -> tuple[int, int, int]:
    red, green, blue = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue


OUTPUT = SceneOutput("footprints-dxf", "Footprints on the Ground (DXF)", FILE, write)
