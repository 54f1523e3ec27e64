"""The interactive 3-D view: vehicle, sensors, their fields of view, and ground maps.

Python writes the geometry (of the engine's `graphics`) as plain data; the scripts in this folder
render it with three.js, which is vendored: the page loads nothing from elsewhere.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core import sensors as kinds

from ... import graphics
from ..pictures.sensor_views import sensor_view
from ..report_context import ReportContext
from .packed_data import css_color, housing_data, maps_data, packed_primitives, vehicle_data

HERE = Path(__file__).parent
THREE = HERE / "_vendor" / "three.min.js"
SCRIPTS = (
    *("decode", "lines", "areas", "body", "ground", "sensors", "labels", "viewpoints"),
    *("user_input", "panel", "print", "view"),
)
"""The view's scripts, concatenated to one program in this order."""
TEXTS = {
    "look_from": "Look from {name}",
    "from": "From {name}",
    "from_middle": "From {name}, the middle of its view",
}
"""Texts of the view's program; {name} is a sensor's name."""
MAX_BEAMS = 60_000
"""Beams that are cast of one sensor; a selection of them is drawn."""
BEAMS_EACH, BEAM_M, VIEW_M, FOOT_M = 180, 7.0, 2.5, 20.0
"""Beams drawn of a sensor and their length; length of a field of view; reach of its footprint."""
MAX_RINGS = 10
PALETTE = graphics.PAPER
OCCLUDED = graphics.with_alpha(PALETTE.occluded, 0.9)
BEAM, RING, EDGE, SIDE = 0.5, 0.8, 0.9, 0.12
"""Opacity of a sensor's colour in beams, rings, and edges and sides of its field of view."""
NOTHING = graphics.Primitives.empty()

__all__ = ["scene_data", "scripts", "view"]


def view(context: ReportContext) -> dict[str, Any]:
    """Return what the 3-D view and its panel show."""
    return {
        "script_data": scene_data(context),
        "occluded_color": css_color(graphics.PAPER.occluded),
    }


def scene_data(context: ReportContext) -> dict[str, Any]:
    """Return everything that the view shows of a study, as plain data."""
    scores = context.after.per_sensor
    colors = graphics.sensor_colors_on_paper(context.rig)
    return {
        "vehicle": vehicle_data(context.vehicle, context.display_vehicle),
        "sensors": [
            sensor_data(sensor, colors[sensor.name], scores.get(sensor.name), context.vehicle)
            for sensor in context.rig
        ],
        "maps": maps_data(context.sight, context.rig),
        "texts": TEXTS,
    }


@cache
def scripts() -> tuple[str, ...]:
    """Return three.js, and the view's own program."""
    program = "\n".join((HERE / f"{name}.js").read_text("utf-8") for name in SCRIPTS)
    own = f'(() => {{\n"use strict";\nconst T = PE_THREE;\n\n{program}\n}})();'
    return THREE.read_text("utf-8"), own


def sensor_data(
    sensor: pe.Sensor, color: graphics.Rgb, score: Any, vehicle: pe.Vehicle | None
) -> dict[str, Any]:
    """Return a sensor in its colour; `score` is its `SensorScore` or None."""
    drawing = graphics.drawing_of(sensor.kind)
    layers = _beam_layers if drawing.beams else _view_layers
    field = sensor_view(sensor.kind).image_field(sensor.model)
    return {
        "name": sensor.name,
        "kind": kinds.kind_of(sensor.model).label,
        "model": sensor.model.name,
        "color": css_color(graphics.with_alpha(color, 1.0)),
        "at": list(sensor.pose.position),
        "turned": list(sensor.pose.rotation_deg),
        "axes": sensor.pose.ground_from_sensor.tolist(),
        "field": None if field is None else list(field),
        "drawn_as": "beams" if drawing.beams else "view",
        "share": score.occluded / score.beams if score and score.beams else None,
        "housing": housing_data(sensor.model.name),
        "layers": layers(sensor, vehicle, color),
    }


def _beam_layers(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, color: tuple[float, ...]
) -> dict[str, Any]:
    """Return free beams, occluded beams, and rings where channels meet the ground."""
    beams_cast = graphics.cast(sensor, vehicle, MAX_BEAMS)
    choice = graphics.BeamChoice(BEAMS_EACH, graphics.ChannelMode.FEW)
    beams = graphics.shown_beams(beams_cast, choice)
    colors = np.where(beams.occluded[:, None], OCCLUDED, graphics.with_alpha(color, BEAM))
    around = None if vehicle is None else vehicle.bounds
    rows = _rings(beams_cast)
    ring_colors = np.tile(graphics.with_alpha(color, RING), (len(rows), 1))
    rings = graphics.ground_rings(beams_cast, rows, ring_colors)
    return {
        "fov": _layer(graphics.free_lines(sensor, beams, BEAM_M, colors, around)),
        "occluded": _layer(graphics.occluded_lines(sensor, beams, colors)),
        "ground": _layer(rings),
    }


def _view_layers(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, color: tuple[float, ...]
) -> dict[str, Any]:
    """Return the field of view, what the vehicle occludes of it, and its footprint."""
    drawing = graphics.drawing_of(sensor.kind)
    edge, side = graphics.with_alpha(color, EDGE), graphics.with_alpha(color, SIDE)
    palette = replace(PALETTE, camera=edge, camera_face=side, other=edge)
    lines, faces = (draw(sensor, VIEW_M, palette) for draw in (drawing.lines, drawing.faces))
    layers = {"fov": _layer(lines, faces)}
    if drawing.footprint is None:
        return layers
    outline = drawing.footprint(sensor, FOOT_M)
    around = graphics.footprint_lines(outline, edge)
    layers["occluded"] = _layer(graphics.hidden_lines(sensor, vehicle, OCCLUDED))
    layers["ground"] = _layer(around, graphics.footprint_faces(outline, side))
    return layers


def _rings(beams: graphics.Cast) -> np.ndarray:
    """Return an even selection of the channels that meet the ground near enough to be drawn."""
    near = graphics.ground_distance(beams.sensor, beams.directions) < graphics.RING_FAR_M
    meets = near.reshape(len(beams.rows), -1).any(axis=1)
    rows = beams.rows[meets]
    return rows[np.unique(np.linspace(0, len(rows) - 1, min(MAX_RINGS, len(rows))).astype(int))]


def _layer(lines: graphics.Primitives, faces: graphics.Primitives = NOTHING) -> dict[str, Any]:
    return {
        **({"lines": packed_primitives(lines)} if len(lines.points) else {}),
        **({"faces": packed_primitives(faces)} if len(faces.points) else {}),
    }
