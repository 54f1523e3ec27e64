"""The ground plan as DXF, by ezdxf: millimetres, a layer a sensor."""

from __future__ import annotations

import io
from collections.abc import Iterable
from contextlib import contextmanager
from typing import Any

import ezdxf
from ezdxf import units

from pe_core.outputs import BLIND, SeenGround, hex_color

MM = 1000.0
VEHICLE, BLIND_GROUND, LABELS = "VEHICLE", "BLIND_GROUND", "LABELS"
MARK_M, AHEAD_M, TEXT_M = 0.06, 0.5, 0.15
"""Of a sensor: the radius of its circle, its stroke to where it looks, its letters [m]."""
GREY = (90, 90, 90)


def dxf_bytes(plan: Any) -> bytes:
    """Return a `GroundPlan` as a drawing: x forward, y left, the origin at (0, 0)."""
    with _same_every_time():
        drawing = ezdxf.new("R2010", units=units.MM)
        space = drawing.modelspace()
        _layer(drawing, VEHICLE, GREY)
        _layer(drawing, BLIND_GROUND, _rgb(hex_color(BLIND)))
        _layer(drawing, LABELS, GREY)
        _outlines(space, VEHICLE, plan.vehicle)
        _outlines(space, BLIND_GROUND, plan.blind)
        for each in plan.footprints:
            layer = f"SENSOR_{each.plain}"
            _layer(drawing, layer, _rgb(hex_color(each.color)))
            _outlines(space, layer, each.outlines)
            _mark(space, layer, each)
        text = io.StringIO()
        drawing.write(text)
    return text.getvalue().encode()


@contextmanager
def _same_every_time() -> Any:
    """Have no dates and no random names in the file."""
    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


def _layer(drawing: Any, name: str, color: tuple[int, int, int]) -> None:
    drawing.layers.add(name, true_color=ezdxf.rgb2int(color))


def _outlines(space: Any, layer: str, outlines: Iterable[Any]) -> None:
    for outline in outlines:
        points = [(x * MM, y * MM) for x, y in outline[:-1].tolist()]
        space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})


def _mark(space: Any, layer: str, each: SeenGround) -> None:
    """Draw where a sensor is, at its height, and where it looks; its name beside it."""
    place = [value * MM for value in each.pose.position]
    ahead = each.pose.ground_from_sensor[:, 0] * AHEAD_M * MM
    own = {"layer": layer}
    space.add_circle(place, MARK_M * MM, dxfattribs=own)
    space.add_line(place, [a + b for a, b in zip(place, ahead.tolist(), strict=True)], own)
    label = space.add_text(each.name, height=TEXT_M * MM, dxfattribs={"layer": LABELS})
    label.set_placement((place[0] + 2.0 * MARK_M * MM, place[1] + 2.0 * MARK_M * MM))


def _rgb(color: str) -> tuple[int, int, int]:
    red, green, blue = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue
