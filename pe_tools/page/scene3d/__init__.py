"""The interactive 3-D view: vehicle, sensors, their fields of view, and ground maps. Python writes
the geometry (of the engine's `graphics`) as plain data; the scripts in this folder render it with
three.js, which is vendored: the page loads nothing from elsewhere. Arrays are packed: numbers are
quantized to integers of few bits and encoded as base64, which a script decodes."""

import base64
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import pe_core as pe
from pe_core import catalog
from pe_core import sensors as kinds

from ... import graphics
from ..pictures.brackets import post_of
from ..pictures.painted_mesh import look_of
from ..pictures.sensor_views import sensor_view
from ..report_context import ReportContext

MAX_STEPS = 65_535  # Quantization steps of the longest side: a vehicle's points are exact to 0.1 mm
MAX_TRIANGLES = 40_000  # Of the vehicle in the 3-D view: a phone renders so many smoothly
STEP_M = 1.0
MAX_MAP_CELLS = 40_000  # Limit of cells of a map: a space of hundreds of metres has larger cells
MAPS = {
    graphics.ENTROPY: "Entropy",
    graphics.COVERAGE: "Coverage",
    graphics.SENSORS: "Number of sensors",
}
HERE = Path(__file__).parent
THREE = HERE / "_vendor" / "three.min.js"
SCRIPTS = (
    "decode",
    "lines",
    "areas",
    "body",
    "ground",
    "sensors",
    "labels",
    "viewpoints",
    "user_input",
    "panel",
    "print",
    "view",
)
"""The view's scripts, concatenated to one program in this order."""
TEXTS = {
    "look_from": "Look from {name}",
    "from": "From {name}",
    "from_middle": "From {name}, the middle of its view",
}  # Texts of the view's program; {name} is a sensor's name
MAX_BEAMS = 60_000  # Beams that are cast of one sensor; a selection of them is drawn
BEAMS_EACH = 180
BEAM_M = 7.0
VIEW_M = 2.5
FOOT_M = 20.0
"""Beams drawn of a sensor and their length; length of a field of view; reach of its footprint."""
MAX_RINGS = 10
PALETTE = graphics.PAPER
OCCLUDED = graphics.with_alpha(PALETTE.occluded, 0.9)
BEAM = 0.5
RING = 0.8
EDGE = 0.9
SIDE = 0.12
"""Opacity of a sensor's colour in beams, rings, and edges and sides of its field of view."""
NOTHING = graphics.Primitives.empty()
__all__ = ["scene_data", "scripts", "view"]


def packed(values: ArrayLike, kind: str) -> str:
    """Return numbers as base64 of a little-endian NumPy type: ``"u1"``, ``"u2"``, ``"u4"``."""
    return base64.b64encode(np.ascontiguousarray(values, f"<{kind}").tobytes()).decode()


def quantization(points: NDArray[Any]) -> tuple[NDArray[np.float64], float]:
    """Return the minimum (3,) of points (N, 3), and the quantization step [m]."""
    if not len(points):
        return np.zeros(3), 1.0
    low = points.min(axis=0).astype(float)
    return low, max(float((points.max(axis=0) - low).max()) / MAX_STEPS, 1e-9)


def quantized(points: NDArray[Any], low: NDArray[np.float64], step: float) -> NDArray[np.uint16]:
    """Return points (N, 3) as numbers of steps from the minimum."""
    return np.clip(np.rint((points - low) / step), 0, MAX_STEPS).astype(np.uint16)


def packed_points(points: NDArray[Any]) -> dict[str, Any]:
    """Return points (N, 3) [m] as plain data: minimum, step, and packed numbers of steps."""
    low, step = quantization(points)
    return {"low": low.tolist(), "step": step, "at": packed(quantized(points, low, step), "u2")}


def packed_primitives(primitives: graphics.Primitives) -> dict[str, Any]:
    """Return the points and colours of lines or triangles as plain data."""
    colors = np.rint(np.clip(primitives.colors, 0.0, 1.0) * 255.0)
    return {**packed_points(primitives.points), "colors": packed(colors, "u1")}


def css_color(color: graphics.Rgba) -> str:
    """Return a colour in CSS notation."""
    red, green, blue = (round(255 * share) for share in color[:3])
    return f"rgb({red} {green} {blue})"


def vehicle_data(
    vehicle: pe.Vehicle | None, simplified: tuple[pe.Vehicle | None, float]
) -> dict[str, Any] | None:
    """Return the vehicle's points, its triangles by part, and how much it was simplified.
    `simplified` is the vehicle that all pictures of the page share, and how far its surface moved
    [m]; `vehicle` has all its triangles."""
    if vehicle is None or simplified[0] is None:
        return None
    shown, moved = graphics.simplified(simplified[0], MAX_TRIANGLES)
    order = np.argsort(shown.parts, kind="stable")
    low, step = quantization(shown.triangles.reshape(-1, 3))
    corners = quantized(shown.triangles[order].reshape(-1, 3), low, step)
    # The distinct points among corners (N, 3), and the index (N,) of each corner's.
    keys = corners.astype(np.int64) @ np.array([1 << 32, 1 << 16, 1])
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    points = corners[first]
    indices = which.reshape(-1)
    kind = "u2" if len(points) <= 1 << 16 else "u4"
    return {
        "low": low.tolist(),
        "step": step,
        "at": packed(points, "u2"),
        "triangles": packed(indices, kind),
        "wide": kind == "u4",
        "parts": _parts(shown, order),
        "bounds": [bound.tolist() for bound in vehicle.bounds],
        "shown": len(shown.triangles),
        "all": len(vehicle.triangles),
        "error": simplified[1] + moved,
    }


def housing_data(model: str) -> dict[str, Any] | None:
    """Return the housing of a model by its name; None if its size is not known."""
    housing = catalog.housing(model)
    if housing is None:
        return None
    return {"shape": housing.shape, "size": list(housing.size), "center": housing.center.tolist()}


def _parts(vehicle: pe.Vehicle, order: NDArray[np.int64]) -> list[dict[str, Any]]:
    """Return name, look, first triangle and number of triangles of each part with triangles."""
    counts = np.bincount(vehicle.parts[order], minlength=len(vehicle.part_names))
    starts = np.cumsum(counts) - counts
    return [
        {
            "name": name,
            "look": look_of(name, vehicle).replace("trim", "body"),
            "first": int(first),
            "count": int(count),
        }
        for name, first, count in zip(vehicle.part_names, starts, counts, strict=True)
        if count
    ]


def maps_data(sight: pe.Sight, rig: pe.Rig) -> list[dict[str, Any]]:
    """Return the ground maps of a rig, averaged over height as in a score."""
    x0, x1 = sight.space.x
    y0, y1 = sight.space.y
    step = max(STEP_M, float(np.sqrt((x1 - x0) * (y1 - y0) / MAX_MAP_CELLS)))
    ground = sight.ground(rig, step=step)
    return [_map(graphics.ground_map(ground, name, 1.0), name, MAPS[name]) for name in MAPS]


def _map(shape: graphics.LayerShape, name: str, label: str) -> dict[str, Any]:
    sheet = shape.sheet
    legend = shape.legend
    assert sheet is not None and legend is not None
    rows, columns = sheet.image.shape[:2]
    return {
        "name": name.lower(),
        "label": label,
        "size": [columns, rows],
        "low": list(sheet.low),
        "high": list(sheet.high),
        "colors": packed(np.rint(sheet.image * 255.0), "u1"),
        "legend": {
            "title": legend.title,
            "scale": [css_color(color) for color in legend.scale],
            "ticks": list(legend.ticks),
            "values": list(legend.values),
            "classes": [[css_color(color), name] for color, name in legend.classes],
        },
    }


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
        "post": _post(sensor, vehicle),
        "layers": layers(sensor, vehicle, color),
    }


def _post(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> list[list[float]] | None:
    """Return the two ends of the post that holds a sensor off the vehicle; None without one."""
    housing = catalog.housing(sensor.model.name)
    if vehicle is None or housing is None:
        return None
    post = post_of(vehicle, housing, sensor.pose)
    return None if post is None else [post.foot.tolist(), post.head.tolist()]


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
        "fov": _layer(graphics.free_lines(sensor, beams, BEAM_M, colors, around=around)),
        "occluded": _layer(graphics.occluded_lines(sensor, beams, colors)),
        "ground": _layer(rings),
    }


def _view_layers(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, color: tuple[float, ...]
) -> dict[str, Any]:
    """Return the field of view, what the vehicle occludes of it, and its footprint."""
    drawing = graphics.drawing_of(sensor.kind)
    edge = graphics.with_alpha(color, EDGE)
    side = graphics.with_alpha(color, SIDE)
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
