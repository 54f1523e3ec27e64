"""Meshes with paint: colours by part, normals, and simple shapes as triangles."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

import pe_core as pe
from pe_core.base.arrays import Floats

Rgb = tuple[float, float, float]

AROUND = 28  # Points of a circle
BEVEL = 0.12  # Of a box's edges, as a share of its least half size

BODY = (0.60, 0.63, 0.67)
GLASS = (0.045, 0.06, 0.075)
TYRE = (0.03, 0.03, 0.03)
TRIM = (0.10, 0.105, 0.11)
LAMP = (0.78, 0.80, 0.80)
TAIL = (0.33, 0.03, 0.02)
PLATE = (0.72, 0.72, 0.68)
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
    """A mesh with a linear colour for each of its parts."""

    mesh: pe.Vehicle
    paints: tuple[Rgb, ...]

    @cached_property
    def normals(self) -> Floats:
        """(F, 3) unit normals of the faces."""
        a, b, c = np.moveaxis(self.mesh.triangles, 1, 0)
        return unit(np.cross(b - a, c - a))

    @cached_property
    def colors(self) -> Floats:
        """(P, 3) linear colours of the parts."""
        return np.array(self.paints)


def painted_vehicle(vehicle: pe.Vehicle) -> PaintedMesh:
    """Return a vehicle with paint by the names of its parts; glass is dark."""
    paints = (PAINTS[look_of(name, vehicle)] for name in vehicle.part_names)
    return PaintedMesh(vehicle, tuple(paints))


def unit(vectors: Floats) -> Floats:
    """Return vectors (..., 3) normalized to length 1; zero vectors stay zero."""
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return vectors / np.where(length > 0.0, length, 1.0)


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
        low_next = np.roll(low, -1, axis=0)
        high_next = np.roll(high, -1, axis=0)
        faces += [np.stack([low, low_next, high_next], 1), np.stack([low, high_next, high], 1)]
    triangles = np.concatenate(faces)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[(normal * normal).sum(axis=1) > 1e-18]


def rounded_box(half: Floats) -> Floats:
    """(F, 3, 3) triangles of a box of half sizes (3,) with bevelled edges."""
    _, _, z = half.tolist()
    cut = BEVEL * float(half.min())
    rings = []
    for inset, height in ((cut, -z), (0.0, cut - z), (0.0, z - cut), (cut, z)):
        x, y = (half[:2] - inset).tolist()
        a = x - cut
        b = y - cut
        flat = [(x, -b), (x, b), (a, y), (-a, y), (-x, b), (-x, -b), (-a, -y), (a, -y)]
        rings.append(np.array([(*point, height) for point in flat]))
    return capped(rings)


def capped(rings: Sequence[Floats]) -> Floats:
    """(F, 3, 3) triangles of a loft with closed ends."""
    ends = [np.tile(ring.mean(axis=0), (len(ring), 1)) for ring in (rings[0], rings[-1])]
    return loft([ends[0], *rings, ends[1]])
