"""The vehicle's body, and the housings of sensors, as plain data."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..engine import catalog, pe, scene
from .packing import counted, grid_of, packed

MOST_TRIANGLES = 40_000
"""That the page draws: a phone turns so many without a stop."""
LOOKS = {
    "wheel": "rubber",
    "tyre": "rubber",
    "tire": "rubber",
    "window": "glass",
    "windshield": "glass",
    "windscreen": "glass",
    "glass": "glass",
    "headlight": "light",
    "taillight": "rear-light",
    "plate": "plate",
}
"""How a part looks, by what its name says."""


def vehicle_data(
    vehicle: pe.Vehicle | None, lighter: tuple[pe.Vehicle | None, float]
) -> dict[str, Any] | None:
    """Return the body's corners, its triangles part by part, and what was left out.

    `lighter` is the vehicle of fewer triangles that all of the page shares, and how far its surface
    moved for that [m].
    """
    if vehicle is None or lighter[0] is None:
        return None
    shown, moved = scene.simplified(lighter[0], MOST_TRIANGLES)
    order = np.argsort(shown.parts, kind="stable")
    low, step = grid_of(shown.triangles.reshape(-1, 3))
    corners = counted(shown.triangles[order].reshape(-1, 3), low, step)
    points, number = _welded(corners)
    kind = "u2" if len(points) <= 1 << 16 else "u4"
    return {
        "low": low.tolist(),
        "step": step,
        "at": packed(points, "u2"),
        "triangles": packed(number, kind),
        "wide": kind == "u4",
        "parts": _parts(shown, order),
        "bounds": [bound.tolist() for bound in vehicle.bounds],
        "shown": len(shown.triangles),
        "all": len(vehicle.triangles),
        "error": lighter[1] + moved,
    }


def housing_data(model: str) -> dict[str, Any] | None:
    """Return a sensor's housing by its model's name, None where its size is not known."""
    housing = catalog.housing(model)
    if housing is None:
        return None
    return {"shape": housing.shape, "size": list(housing.size), "center": housing.center.tolist()}


def _welded(corners: NDArray[np.uint16]) -> tuple[NDArray[np.uint16], NDArray[np.int64]]:
    """Return the points that occur among corners (N, 3), and (N,) which of them each is."""
    numbers = corners.astype(np.int64) @ np.array([1 << 32, 1 << 16, 1])
    _, first, which = np.unique(numbers, return_index=True, return_inverse=True)
    return corners[first], which.reshape(-1)


def _parts(vehicle: pe.Vehicle, order: NDArray[np.int64]) -> list[dict[str, Any]]:
    """Name, look, first triangle and number of triangles of each part that has some."""
    counts = np.bincount(vehicle.parts[order], minlength=len(vehicle.part_names))
    starts = np.cumsum(counts) - counts
    return [
        {"name": name, "look": _look(name, vehicle), "first": int(first), "count": int(count)}
        for name, first, count in zip(vehicle.part_names, starts, counts, strict=True)
        if count
    ]


def _look(name: str, vehicle: pe.Vehicle) -> str:
    if name in vehicle.glass:
        return "glass"
    return next((look for word, look in LOOKS.items() if word in name.lower()), "body")
