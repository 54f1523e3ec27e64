"""Meshes with paint: colours by part, smooth normals, and simple shapes as triangles."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core.base.arrays import Floats, Ints

Rgb = tuple[float, float, float]

CREASE = math.cos(math.radians(38.0))
"""Cosine of the largest angle between faces that are shaded as one smooth surface."""
WELD_M = 1e-4  # Corners nearer to each other than this count as equal
MAX_FACES_AROUND = 24  # Faces at a corner that contribute to its normal
MAX_SMOOTH_TRIANGLES = 250_000
"""Meshes with more triangles are shaded flat: their triangles are smaller than a pixel."""
AROUND = 28  # Points of a circle


@dataclass(frozen=True, slots=True)
class Paint:
    """A linear colour, and its shine, 0 to 1."""

    rgb: Rgb
    shine: float = 0.0


BODY = Paint((0.43, 0.46, 0.50), 0.7)
GLASS = Paint((0.045, 0.06, 0.075), 1.0)
TYRE = Paint((0.03, 0.03, 0.03))
TRIM = Paint((0.10, 0.105, 0.11), 0.2)
LAMP = Paint((0.78, 0.80, 0.80), 0.8)
TAIL = Paint((0.33, 0.03, 0.02), 0.6)
PLATE = Paint((0.72, 0.72, 0.68), 0.1)
LOOKS = {
    "rear-light": ("tail", "brake"),
    "light": ("headl", "lamp", "light"),
    "plate": ("plate",),
    "rubber": ("wheel", "tyre", "tire"),
    "glass": ("window", "windshield", "windscreen", "glass"),
    "trim": ("bumper", "trim", "grille", "mirror", "wiper", "antenna", "rubber"),
}
"""Words in the names of parts by their look; the first match counts, others look like the body."""
PAINTS = {"rear-light": TAIL, "light": LAMP, "plate": PLATE, "rubber": TYRE}
PAINTS |= {"glass": GLASS, "trim": TRIM, "body": BODY}


def look_of(name: str, vehicle: pe.Vehicle) -> str:
    """Return the look of a part by its name: a key of `LOOKS`, or "body"."""
    if name in vehicle.glass:
        return "glass"
    named = (look for look, words in LOOKS.items() if any(word in name.lower() for word in words))
    return next(named, "body")


@dataclass(frozen=True, eq=False)
class PaintedMesh:
    """A mesh with a paint for each of its parts."""

    mesh: pe.Vehicle
    paints: tuple[Paint, ...]

    @cached_property
    def normals(self) -> Floats:
        """(F, 3, 3) unit normals at the corners of the faces."""
        return corner_normals(self.mesh.triangles)

    @cached_property
    def colors(self) -> Floats:
        """(P, 4) linear red, green, blue and shine of the parts."""
        return np.array([(*paint.rgb, paint.shine) for paint in self.paints])

    def normals_at(self, face: NDArray[np.int64], points: Floats) -> Floats:
        """(N, 3) normals at points on faces, interpolated between the corners."""
        corners, normals = self.mesh.triangles[face], self.normals[face]
        share = _barycentric(corners, points)
        return np.einsum("nk,nkd->nd", share, normals)


def painted_vehicle(vehicle: pe.Vehicle) -> PaintedMesh:
    """Return a vehicle with paint by the names of its parts; glass is dark."""
    paints = (PAINTS[look_of(name, vehicle)] for name in vehicle.part_names)
    return PaintedMesh(vehicle, tuple(paints))


def unit(vectors: Floats) -> Floats:
    """Return vectors (..., 3) normalized to length 1; zero vectors stay zero."""
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return vectors / np.where(length > 0.0, length, 1.0)


def corner_normals(triangles: Floats) -> Floats:
    """(F, 3, 3) unit normals at corners: means over the faces that meet there at small angles.
    Neighbours may have the opposite winding order: a face keeps its own side."""
    sides = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    by_corner = np.repeat(np.cross(*sides), 3, axis=0)  # their length is twice the area
    if len(triangles) > MAX_SMOOTH_TRIANGLES:
        return unit(by_corner).reshape(-1, 3, 3)
    order, start, count = _equal_corners(triangles.reshape(-1, 3))
    weighted, sharp = by_corner[order], unit(by_corner)[order]
    rank = np.arange(len(order)) - start
    total = weighted.copy()
    for step in range(1, min(int(count.max(initial=1)), MAX_FACES_AROUND)):
        corners = np.flatnonzero(count > step)
        other = start[corners] + (rank[corners] + step) % count[corners]
        along = (sharp[corners] * sharp[other]).sum(axis=1)
        share = np.where(np.abs(along) > CREASE, np.sign(along), 0.0)
        total[corners] += share[:, None] * weighted[other]
    smooth = np.empty_like(total)
    smooth[order] = unit(total)
    return smooth.reshape(-1, 3, 3)


def _equal_corners(corners: Floats) -> tuple[Ints, Ints, Ints]:
    """Return an order that groups equal corners, and start and size of each corner's group."""
    cell = np.round(corners / WELD_M).astype(np.int64)
    _, group = np.unique(cell, axis=0, return_inverse=True)
    group = group.reshape(-1)
    order = np.argsort(group, kind="stable")
    sizes = np.bincount(group)
    ordered = group[order]
    return order, (np.cumsum(sizes) - sizes)[ordered], sizes[ordered]


def lathe(profile: Sequence[tuple[float, float]], around: int = AROUND) -> Floats:
    """(F, 3, 3) triangles of a profile (radius, height) rotated about the z axis."""
    turn = np.arange(around) * 2.0 * np.pi / around
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    rings = [np.column_stack([radius * circle, np.full(around, z)]) for radius, z in profile]
    return loft(rings)


def loft(rings: Sequence[Floats]) -> Floats:
    """(F, 3, 3) triangles between rings of equally many points (N, 3), without degenerate ones."""
    faces = []
    for low, high in pairwise(rings):
        low_next, high_next = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
        faces += [np.stack([low, low_next, high_next], 1), np.stack([low, high_next, high], 1)]
    triangles = np.concatenate(faces)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[(normal * normal).sum(axis=1) > 1e-18]


BEVEL = 0.12  # Of a box's edges, as a share of its least half size


def rounded_box(half: Floats) -> Floats:
    """(F, 3, 3) triangles of a box of half sizes (3,) with bevelled edges."""
    (_, _, z), cut, rings = half.tolist(), BEVEL * float(half.min()), []
    for inset, height in ((cut, -z), (0.0, cut - z), (0.0, z - cut), (cut, z)):
        x, y = (half[:2] - inset).tolist()
        a, b = x - cut, y - cut
        flat = [(x, -b), (x, b), (a, y), (-a, y), (-x, b), (-x, -b), (-a, -y), (a, -y)]
        rings.append(np.array([(*point, height) for point in flat]))
    return capped(rings)


def capped(rings: Sequence[Floats]) -> Floats:
    """(F, 3, 3) triangles of a loft with closed ends."""
    ends = [np.tile(ring.mean(axis=0), (len(ring), 1)) for ring in (rings[0], rings[-1])]
    return loft([ends[0], *rings, ends[1]])


def _barycentric(corners: Floats, points: Floats) -> Floats:
    """(N, 3) barycentric coordinates of points in triangles (N, 3, 3), a third each if flat."""
    a, b, p = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    aa, ab, bb, pa, pb = ((u * v).sum(axis=1) for u, v in ((a, a), (a, b), (b, b), (p, a), (p, b)))
    area = aa * bb - ab * ab
    flat = area <= 0.0
    safe = np.where(flat, 1.0, area)
    v, w = (bb * pa - ab * pb) / safe, (aa * pb - ab * pa) / safe
    shares = np.clip(np.stack([1.0 - v - w, v, w], axis=1), 0.0, 1.0)
    return np.where(flat[:, None], 1.0 / 3.0, shares)
