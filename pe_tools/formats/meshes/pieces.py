"""Steps that the Collada and USD readers share: triangulation and node transforms."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError

from .. import FoundMesh

Floats = NDArray[np.float64]


class Piece(NamedTuple):
    """Triangles (F, 3, 3) of one part, in the file's axes and units."""

    name: str
    triangles: Floats


def cut(points: Floats, counts: NDArray[Any], corners: NDArray[Any]) -> Floats:
    """Cut polygons into fans: triangles (F, 3, 3); all corners are in one list."""
    sizes = np.asarray(counts, np.int64)
    fans = np.maximum(sizes - 2, 0)
    polygons = np.repeat(np.arange(len(sizes)), fans)
    step = np.arange(len(polygons)) - np.repeat(np.cumsum(fans) - fans, fans)
    first = (np.cumsum(sizes) - sizes)[polygons]
    order = np.stack([first, first + step + 1, first + step + 2], axis=1)
    return points[np.asarray(corners, np.int64)[order]]


def placed(triangles: Floats, matrix: Floats) -> Floats:
    """Transform triangles by a matrix (4, 4) for column vectors; mirroring keeps the outside."""
    x, y, z = (triangles[..., k] for k in range(3))
    rows = [row[0] * x + row[1] * y + row[2] * z + row[3] for row in matrix[:3]]
    moved = np.stack(rows, axis=-1)
    return moved[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0.0 else moved


def found(source: str, pieces: list[Piece], metres: float, up: str) -> FoundMesh:
    """Join pieces into one mesh; `metres` is the file's unit [m], `up` its up axis."""
    if not (np.isfinite(metres) and metres > 0.0):
        raise InputError(source, "unit", "a length in metres", metres)
    sizes = [len(piece.triangles) for piece in pieces]
    triangles = np.concatenate([np.zeros((0, 3, 3)), *(piece.triangles for piece in pieces)])
    if metres != 1.0:
        triangles = triangles * metres
    parts = np.repeat(np.arange(len(pieces), dtype=np.int32), sizes)
    return FoundMesh(triangles, parts, [piece.name for piece in pieces], up)
