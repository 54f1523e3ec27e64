"""The vehicle's own body: what it hides, and the room it takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, shown
from ..text.values import A_NAME, Number, numbers
from .frozen import frozen, frozen_copy
from .geometry import FARTHEST_M, cross, dot
from .heights import top_heights
from .raycast import Hits, SeenTriangles
from .space import PerceptionSpace
from .triangle_tree import TriangleTree

Floats = NDArray[np.float64]

DEFAULT_CLEARANCE_M = 0.02
"""How far a flush-mounted sensor is taken to stand proud of the skin."""
CLEARANCE = Number(0.0, 1.0, below=True, unit="m")


@dataclass(frozen=True, eq=False)
class Vehicle:
    """Triangles of the vehicle in the ground frame.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Corners [m]. Open meshes, duplicates and zero-area triangles are allowed.
    parts : (F,) int, optional
        Which of `part_names` each triangle belongs to.
    part_names : sequence of str
        Names of the parts.
    glass : sequence of str
        Parts that cameras see through. They stop LiDAR beams all the same.
    clearance : float
        A sensor nearer to the skin than this, on either side, sees as if it stood proud of it by
        this much: flush mounting does not blind it [m].

    Raises
    ------
    InputError
        When the triangles are not (F, 3, 3), none are left, a coordinate is not finite, or a name
        or the clearance is impossible.
    """

    triangles: Floats
    parts: NDArray[np.int32] = None  # type: ignore[assignment]  # all one part
    part_names: Sequence[str] = ("vehicle",)
    glass: Sequence[str] = ()
    clearance: float = DEFAULT_CLEARANCE_M

    def __post_init__(self) -> None:
        triangles = _checked_triangles(self.triangles)
        parts = (
            frozen(np.zeros(len(triangles), np.int32))
            if self.parts is None
            else _checked_parts(self.parts, len(self.part_names))
        )
        names = tuple(A_NAME.checked("vehicle", "part_names", n) for n in self.part_names)
        if parts.shape != (len(triangles),):
            found = f"{parts.shape} with {len(names)} names"
            raise InputError("vehicle", "parts", "one index into part_names a triangle", found)
        for name in self.glass:
            if name not in names:
                raise InputError("vehicle", "glass", f"one of {', '.join(names)}", shown(name))
        clearance = CLEARANCE.checked("vehicle", "clearance", self.clearance)
        object.__setattr__(self, "clearance", clearance)
        for key, value in (("triangles", triangles), ("parts", parts), ("part_names", names)):
            object.__setattr__(self, key, value)
        object.__setattr__(self, "glass", tuple(self.glass))

    def __reduce__(self) -> tuple[object, ...]:
        """What can be worked out again is not sent to another process."""
        own = self.triangles, self.parts, self.part_names, self.glass, self.clearance
        return type(self), own

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner, each (3,) [m]."""
        corners = self.triangles.reshape(-1, 3)
        return frozen(corners.min(axis=0)), frozen(corners.max(axis=0))

    @cached_property
    def triangle_bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of each triangle, each (3, F) [m]."""
        corners = self.triangles.transpose(2, 1, 0)
        return frozen(corners.min(axis=1)), frozen(corners.max(axis=1))

    @cached_property
    def _opaque(self) -> NDArray[np.int64]:
        glass = [self.part_names.index(name) for name in self.glass]
        return np.flatnonzero(~np.isin(self.parts, glass))

    @cached_property
    def _tree(self) -> TriangleTree:
        return TriangleTree(self.triangles)

    @cached_property
    def _tree_without_glass(self) -> TriangleTree:
        return TriangleTree(self.triangles[self._opaque]) if self.glass else self._tree

    def seen_from(self, position: Sequence[float], through_glass: bool = False) -> SeenMesh:
        """Return the vehicle as a sensor sees it from a position [m]; perhaps through its glass."""
        tree = self._tree_without_glass if through_glass else self._tree
        triangles = self.triangles[self._opaque] if through_glass else self.triangles
        origin = _proud_of_skin(np.asarray(position, dtype=float), triangles, tree, self.clearance)
        return SeenMesh(SeenTriangles(tree, origin), self._opaque if through_glass else None)

    def first_hit(
        self, position: Sequence[float], directions: ArrayLike, through_glass: bool = False
    ) -> Hits:
        """Where rays from a position first meet the vehicle.

        Parameters
        ----------
        position : (3,) float
            Origin of the rays, ground frame [m].
        directions : (B, 3) float
            Unit directions, ground frame.
        through_glass : bool
            Whether the rays pass `glass`, as cameras see through it.

        Returns
        -------
        Hits
            `distance` (B,) [m], inf for a miss; `face` (B,) triangle index, -1 for a miss.
        """
        return self.seen_from(position, through_glass).first_hit(
            np.asarray(directions, dtype=float)
        )

    def first_hit_from(self, point: Floats, directions: Floats) -> Hits:
        """Return first hits as `first_hit` does, but from the point (3,) itself, skin or not."""
        return SeenTriangles(self._tree, point).first_hit(directions)

    def faces_near(self, point: ArrayLike, distance: float) -> NDArray[np.int64]:
        """(N,) the triangles, ascending, that may come as near as `distance` [m] to a point."""
        return self._tree.near(np.asarray(point, dtype=float), distance)

    def top(self, space: PerceptionSpace) -> Floats:
        """(nx, ny) height of the highest surface at each column's centre [m], -inf beside it."""
        return top_heights(self.triangles, space)


@dataclass(frozen=True, slots=True)
class SeenMesh:
    """A vehicle as seen from one point; face indices are those of the whole vehicle."""

    seen: SeenTriangles
    faces: NDArray[np.int64] | None

    def first_hit(self, directions: Floats) -> Hits:
        """First hit along (B, 3) ground-frame unit directions."""
        hits = self.seen.first_hit(directions)
        if self.faces is None or not len(self.faces):
            return hits
        return Hits(hits.distance, np.where(hits.face < 0, -1, self.faces[hits.face]))


def _checked_triangles(values: ArrayLike) -> Floats:
    expected = "(F, 3, 3) numbers, F > 0"
    plain = isinstance(values, np.ndarray) and values.dtype.kind in "iuf"
    if (found := values if plain else numbers(values)) is None:
        raise InputError("vehicle", "triangles", expected, shown(values))
    triangles: Floats = frozen_copy(found, np.float64)
    if triangles.ndim != 3 or triangles.shape[1:] != (3, 3) or not len(triangles):
        raise InputError("vehicle", "triangles", expected, triangles.shape)
    bad = ~np.isfinite(triangles).all(axis=(1, 2))
    if bad.any():
        which = f"triangle {int(np.flatnonzero(bad)[0])} with NaN or infinity"
        raise InputError("vehicle", "triangles", "finite coordinates", which)
    far = np.abs(triangles).max(axis=(1, 2)) > FARTHEST_M
    if far.any():
        which = f"triangle {int(np.flatnonzero(far)[0])} beyond"
        expected = f"coordinates within +-{FARTHEST_M:g} m"
        raise InputError("vehicle", "triangles", expected, which)
    return triangles


def _checked_parts(values: ArrayLike, names: int) -> NDArray[np.int32]:
    """Return indices into that many names, or raise `InputError`."""
    try:
        parts = np.asarray(values)
    except ValueError:  # rows of different lengths
        parts = np.array(None)
    whole = parts.dtype.kind in "iu" and parts.size > 0
    if not whole or parts.min() < 0 or parts.max() >= names:
        found = f"{shown(values)} with {names} names"
        raise InputError("vehicle", "parts", "one index into part_names a triangle", found)
    return frozen_copy(parts, np.int32)


def _proud_of_skin(
    position: Floats, triangles: Floats, tree: TriangleTree, clearance: float
) -> Floats:
    """Lift a position nearer to the skin than `clearance` to that distance, on the open side."""
    beside = triangles[tree.near(position, clearance * 1.001 + 1e-9)]
    low, high = beside.min(axis=1), beside.max(axis=1)
    gap = np.maximum(np.maximum(low - position, position - high), 0.0)
    near = beside[dot(gap, gap) < clearance**2]
    if not len(near):
        return position
    points = closest_points(position, near)
    distance = np.sqrt(dot(points - position, points - position))
    nearest = int(np.argmin(distance))
    if distance[nearest] >= clearance:
        return position
    normal = cross(near[nearest, 1] - near[nearest, 0], near[nearest, 2] - near[nearest, 0])
    length = float(np.sqrt(dot(normal, normal)))
    if length == 0.0:
        return position
    lift = clearance * normal / length
    return points[nearest] + _open_side(points[nearest], lift, tree)


def _open_side(point: Floats, lift: Floats, tree: TriangleTree) -> Floats:
    """Of ``+lift`` and ``-lift``, the side where a ray along it runs farther (outside)."""
    direction = lift / np.sqrt(dot(lift, lift))
    free = [
        SeenTriangles(tree, point + side * lift).first_hit(side * direction[None])
        for side in (1.0, -1.0)
    ]
    return lift if free[0].distance[0] >= free[1].distance[0] else -lift


def closest_points(point: Floats, triangles: Floats) -> Floats:
    """Closest point (F, 3) to a point on each triangle (F, 3, 3).

    Voronoi regions as in Ericson, Real-Time Collision Detection (2005), section 5.1.5, put
    together as: the foot on the plane where it lies inside, else the best of the three edges.
    """
    a, b, c = (triangles[:, i] for i in range(3))
    best = np.stack([_closest_on_edge(point, p, q) for p, q in ((a, b), (b, c), (c, a))])
    square = dot(best - point, best - point)
    result = best[np.argmin(square, axis=0), np.arange(len(triangles))]
    normal = cross(b - a, c - a)
    size = dot(normal, normal)
    flat = size == 0.0
    height = dot(point - a, normal) / np.where(flat, 1.0, size)
    foot = point - height[:, None] * normal
    sides = [dot(cross(q - p, foot - p), normal) for p, q in ((a, b), (b, c), (c, a))]
    inside = ~flat & (np.min(sides, axis=0) >= 0.0)
    return np.where(inside[:, None], foot, result)


def _closest_on_edge(point: Floats, start: Floats, end: Floats) -> Floats:
    along = end - start
    size = dot(along, along)
    t = dot(point - start, along) / np.where(size == 0.0, 1.0, size)
    return start + np.clip(t, 0.0, 1.0)[:, None] * along
