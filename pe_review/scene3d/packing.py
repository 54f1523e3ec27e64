"""Arrays as texts: whole numbers of few bits, in base64, that a script makes arrays of again."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..engine import graphics

FINEST = 65_535
"""Steps that a length is divided into: the vehicle's places are good to a tenth of a millimetre."""


def packed(values: ArrayLike, kind: str) -> str:
    """Return numbers as base64 of a NumPy type, lowest byte first: ``"u1"``, ``"u2"``, ``"u4"``."""
    return base64.b64encode(np.ascontiguousarray(values, f"<{kind}").tobytes()).decode()


def grid_of(points: NDArray[Any]) -> tuple[NDArray[np.float64], float]:
    """Return the lowest corner (3,) of points (N, 3), and the step that they are counted in [m]."""
    if not len(points):
        return np.zeros(3), 1.0
    low = points.min(axis=0).astype(float)
    return low, max(float((points.max(axis=0) - low).max()) / FINEST, 1e-9)


def counted(points: NDArray[Any], low: NDArray[np.float64], step: float) -> NDArray[np.uint16]:
    """Return points (N, 3) in steps from a corner."""
    return np.clip(np.rint((points - low) / step), 0, FINEST).astype(np.uint16)


def places(points: NDArray[Any]) -> dict[str, Any]:
    """Return points (N, 3) [m] as plain data: a corner, a step, and how many of them."""
    low, step = grid_of(points)
    return {"low": low.tolist(), "step": step, "at": packed(counted(points, low, step), "u2")}


def primitives(some: graphics.Primitives) -> dict[str, Any]:
    """Return lines or triangles as plain data, each point with its colour."""
    colors = np.rint(np.clip(some.colors, 0.0, 1.0) * 255.0)
    return {**places(some.points), "colors": packed(colors, "u1")}


def css(color: graphics.Rgba) -> str:
    """Return a colour as a page writes it."""
    red, green, blue = (round(255 * share) for share in color[:3])
    return f"rgb({red} {green} {blue})"
