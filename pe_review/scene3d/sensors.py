"""Each sensor as plain data: where it is, and the layers that are drawn of it.

The geometry is the engine's, that of the views in Blender.
"""

from __future__ import annotations

from dataclasses import replace
from math import degrees
from typing import Any

import numpy as np

from ..engine import graphics, kinds, pe
from .body import housing_data
from .packing import css, primitives

MOST_BEAMS = 60_000
"""That are cast of one LiDAR: what is drawn is a choice of them."""
BEAMS_EACH, BEAM_M, VIEW_M, FOOT_M = 180, 7.0, 2.5, 20.0
"""Beams that are drawn of a LiDAR, how long; a camera's view, and how far its ground is drawn."""
MOST_RINGS = 10
PALETTE = graphics.PAPER
STOPPED = graphics.with_alpha(PALETTE.stopped, 0.9)
BEAM, RING, EDGE, SIDE = 0.5, 0.8, 0.9, 0.12
"""How strong a sensor's colour is in its beams, its rings, and its view's edges and sides."""
NOTHING = graphics.Primitives.empty()


def sensor_data(
    number: int, sensor: pe.Sensor, one_score: Any, vehicle: pe.Vehicle | None
) -> dict[str, Any]:
    """Return one sensor of a rig by its number; `one_score` is its row of the score, or None."""
    drawing = graphics.drawing_of(sensor.kind)
    color = graphics.sensor_color_on_paper(number)
    of_kind = _of_beams if drawing.beams else _of_view
    return {
        "name": sensor.name,
        "kind": kinds.kind_of(sensor.model).label,
        "model": sensor.model.name,
        "color": css(graphics.with_alpha(color, 1.0)),
        "at": list(sensor.pose.position),
        "turned": list(sensor.pose.rotation_deg),
        "axes": sensor.pose.ground_from_sensor.tolist(),
        "field": _field(sensor),
        "sees": "beams" if drawing.beams else "view",
        "share": _share(one_score),
        "housing": housing_data(sensor.model.name),
        "layers": of_kind(sensor, vehicle, color),
    }


def _of_beams(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, color: tuple[float, ...]
) -> dict[str, Any]:
    """Free beams, stopped ones, and rings where channels meet the ground."""
    found = graphics.cast(sensor, vehicle, MOST_BEAMS)
    choice = graphics.BeamChoice(BEAMS_EACH, graphics.ChannelMode.FEW)
    beams = graphics.shown_beams(found, choice)
    colors = np.where(beams.stopped[:, None], STOPPED, graphics.with_alpha(color, BEAM))
    around = None if vehicle is None else vehicle.bounds
    rows = _rings(found)
    rings = graphics.ground_rings(
        found, rows, np.tile(graphics.with_alpha(color, RING), (len(rows), 1))
    )
    return {
        "sees": _layer(graphics.free_lines(sensor, beams, BEAM_M, colors, around)),
        "stopped": _layer(graphics.stopped_lines(sensor, beams, colors)),
        "ground": _layer(rings),
    }


def _of_view(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, color: tuple[float, ...]
) -> dict[str, Any]:
    """A view's edges and sides, what of the vehicle is in it, and the ground that it looks at."""
    drawing = graphics.drawing_of(sensor.kind)
    sketch = drawing.sketch(sensor, vehicle, graphics.BeamChoice(1))
    edge, side = graphics.with_alpha(color, EDGE), graphics.with_alpha(color, SIDE)
    palette = replace(PALETTE, camera=edge, camera_face=side, other=edge)
    layers = {"sees": _layer(sketch.lines(VIEW_M, palette), sketch.faces(VIEW_M, palette))}
    if drawing.footprint is None:
        return layers
    outline = drawing.footprint(sensor, FOOT_M)
    around = graphics.footprint_lines(outline, edge)
    layers["stopped"] = _layer(graphics.hidden_lines(sensor, vehicle, STOPPED))
    layers["ground"] = _layer(around, graphics.footprint_faces(outline, side))
    return layers


def _rings(found: graphics.Cast) -> np.ndarray:
    """Channels that meet the ground near enough to be drawn: some, evenly."""
    near = graphics.ground_distance(found.sensor, found.directions) < graphics.RING_FAR_M
    meets = near.reshape(len(found.rows), -1).any(axis=1)
    rows = found.rows[meets]
    return rows[np.unique(np.linspace(0, len(rows) - 1, min(MOST_RINGS, len(rows))).astype(int))]


def _layer(lines: graphics.Primitives, faces: graphics.Primitives = NOTHING) -> dict[str, Any]:
    return {
        **({"lines": primitives(lines)} if len(lines.points) else {}),
        **({"faces": primitives(faces)} if len(faces.points) else {}),
    }


def _field(sensor: pe.Sensor) -> list[float] | None:
    """Width and height of a picture's field [deg]; None for what has no picture."""
    model = sensor.model
    if not isinstance(model, pe.Camera):
        return None
    return [degrees(model.hfov), degrees(model.vfov)]


def _share(one_score: Any) -> float | None:
    """How much of a sensor's beams, or of its picture, the vehicle takes."""
    return one_score.stopped / one_score.beams if one_score and one_score.beams else None
