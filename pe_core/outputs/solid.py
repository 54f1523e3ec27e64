"""Closed solids of fields of view: all of one, what is left free of it, what the vehicle takes.

Every edge of a solid has two triangles, which run along it in opposite directions; they turn
counter-clockwise as seen from outside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .views import NEAREST_M, MountedView

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A closed surface: `points` (N, 3) in the ground frame [m], `faces` (F, 3) outwards."""

    name: str
    points: Floats
    faces: Ints

    @classmethod
    def of(cls, name: str, points: Floats, faces: Ints) -> Solid:
        """Keep the points that faces use."""
        used, index = np.unique(faces, return_inverse=True)
        return cls(name, points[used], index.reshape(-1, 3))

    @property
    def volume(self) -> float:
        """[m3]: the sum of the tetrahedra under its triangles."""
        a, b, c = (self.points[self.faces[:, k]] - self.points[0] for k in range(3))
        return float((a * np.cross(b, c)).sum() / 6.0)


def whole_solid(name: str, view: MountedView) -> Solid:
    """Return all that a sensor would see without the vehicle."""
    return _star(name, view, np.full(len(view.ends), view.reach))


def free_solid(name: str, view: MountedView) -> Solid:
    """Return what a sensor sees, up to the vehicle where that stops it."""
    return _star(name, view, view.ends)


def hidden_solid(name: str, view: MountedView) -> Solid | None:
    """Return what the vehicle takes of a field of view: what lies behind it; None if nothing."""
    stopped = view.ends < view.reach - NEAREST_M
    if not stopped[view.faces].any():
        return None
    taken = _without_pinches(view.faces, stopped[view.faces].any(axis=1))
    faces, count = view.faces[taken], len(view.directions)
    outer = view.origin + view.directions * view.reach
    inner = view.origin + view.directions * np.minimum(view.ends, view.reach - NEAREST_M)[:, None]
    a, b = border(faces).T
    walls = [np.stack([b, a, a + count], axis=1), np.stack([b, a + count, b + count], axis=1)]
    return Solid.of(
        name, np.vstack([outer, inner]), np.vstack([faces, faces[:, ::-1] + count, *walls])
    )


def border(faces: Ints) -> Ints:
    """Return edges (E, 2) that one face alone has, as it runs along them."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    size = int(faces.max()) + 1 if len(faces) else 1
    there, back = edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0]
    return edges[~np.isin(there, back)]


def _star(name: str, view: MountedView, ends: Floats) -> Solid:
    """Return the solid between a sensor and the ends of its directions."""
    points = np.vstack([view.origin + view.directions * ends[:, None], view.origin])
    edges = border(view.faces)
    sides = np.stack([np.full(len(edges), len(points) - 1), edges[:, 1], edges[:, 0]], axis=1)
    return Solid.of(name, points, np.vstack([view.faces, sides]))


def _without_pinches(faces: Ints, taken: Flags) -> Flags:
    """Take more faces until no two pieces of those taken touch in a point alone.

    Walls over such a point would have an edge in common with four triangles.
    """
    while True:
        starts = np.bincount(border(faces[taken])[:, 0], minlength=int(faces.max()) + 1)
        more = (starts > 1)[faces].any(axis=1) & ~taken
        if not more.any():
            return taken
        taken = taken | more
