"""The 3-D view's data as plain JSON: the vehicle's mesh, housings, ground maps.

Arrays are packed: numbers are quantized to integers of few bits and encoded as base64, which a
script on the page decodes.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import pe_core as pe
from pe_core import catalog

from ... import graphics
from ..pictures.painted_mesh import look_of

MAX_STEPS = 65_535
"""Quantization steps of the longest side: a vehicle's points are exact to 0.1 mm."""
MAX_TRIANGLES = 40_000
"""Of the vehicle in the 3-D view: a phone renders so many smoothly."""
STEP_M = 1.0
MAX_MAP_CELLS = 40_000
"""Limit of cells of a map: a space of hundreds of metres has larger cells."""
MAPS = {
    graphics.ENTROPY: "Entropy",
    graphics.COVERAGE: "Coverage",
    graphics.SENSORS: "Number of sensors",
}


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
    points, indices = corners[first], which.reshape(-1)
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
    (x0, x1), (y0, y1) = sight.space.x, sight.space.y
    step = max(STEP_M, float(np.sqrt((x1 - x0) * (y1 - y0) / MAX_MAP_CELLS)))
    ground = sight.ground(rig, step=step)
    return [_map(graphics.ground_map(ground, name, 1.0), name, MAPS[name]) for name in MAPS]


def _map(shape: graphics.LayerShape, name: str, label: str) -> dict[str, Any]:
    sheet, legend = shape.sheet, shape.legend
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
