"""Bodies that are drawn: triangles with colours, the vehicle's by the names of its parts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..engine import pe
from .normals import corner_normals

Floats = NDArray[np.float64]
Rgb = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Paint:
    """A colour (linear), and how much it shines, 0 to 1."""

    rgb: Rgb
    shine: float = 0.0


BODY = Paint((0.43, 0.46, 0.50), 0.7)
GLASS = Paint((0.045, 0.06, 0.075), 1.0)
TYRE = Paint((0.03, 0.03, 0.03))
TRIM = Paint((0.10, 0.105, 0.11), 0.2)
LAMP = Paint((0.78, 0.80, 0.80), 0.8)
TAIL = Paint((0.33, 0.03, 0.02), 0.6)
PLATE = Paint((0.72, 0.72, 0.68), 0.1)
PAINTS = (
    (("tail", "brake"), TAIL),
    (("headl", "lamp", "light"), LAMP),
    (("plate",), PLATE),
    (("wheel", "tyre", "tire"), TYRE),
    (("window", "windshield", "windscreen", "glass"), GLASS),
    (("bumper", "trim", "grille", "mirror", "wiper", "antenna", "rubber"), TRIM),
)
"""By what a part's name holds, the first that fits; else it is painted as the body is."""


@dataclass(frozen=True, eq=False)
class PaintedBody:
    """A body with a paint for each of its parts."""

    body: pe.Vehicle
    paints: tuple[Paint, ...]

    @cached_property
    def normals(self) -> Floats:
        """(F, 3, 3) unit normals of its corners."""
        return corner_normals(self.body.triangles)

    @cached_property
    def colors(self) -> Floats:
        """(P, 4) of its parts: linear red, green, blue, and how much they shine."""
        return np.array([(*paint.rgb, paint.shine) for paint in self.paints])

    def normals_at(self, face: NDArray[np.int64], points: Floats) -> Floats:
        """(N, 3) normals at points of faces, between those of the corners."""
        corners, normals = self.body.triangles[face], self.normals[face]
        share = _shares(corners, points)
        return np.einsum("nk,nkd->nd", share, normals)

    def parts_of(self, face: NDArray[np.int64]) -> NDArray[np.int64]:
        """(N,) parts that faces belong to."""
        return np.asarray(self.body.parts)[face].astype(np.int64)


def painted_vehicle(vehicle: pe.Vehicle) -> PaintedBody:
    """Return a vehicle in quiet colours, glass dark, by the names of its parts."""
    names = vehicle.part_names
    return PaintedBody(vehicle, tuple(GLASS if n in vehicle.glass else _paint_of(n) for n in names))


def _paint_of(name: str) -> Paint:
    lowered = name.lower()
    for words, paint in PAINTS:
        if any(word in lowered for word in words):
            return paint
    return BODY


def _shares(corners: Floats, points: Floats) -> Floats:
    """(N, 3) barycentric coordinates of points in triangles (N, 3, 3), a third each if flat."""
    a, b, p = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    aa, ab, bb, pa, pb = ((u * v).sum(axis=1) for u, v in ((a, a), (a, b), (b, b), (p, a), (p, b)))
    area = aa * bb - ab * ab
    flat = area <= 0.0
    safe = np.where(flat, 1.0, area)
    v, w = (bb * pa - ab * pb) / safe, (aa * pb - ab * pa) / safe
    shares = np.clip(np.stack([1.0 - v - w, v, w], axis=1), 0.0, 1.0)
    return np.where(flat[:, None], 1.0 / 3.0, shares)
