"""The vehicle's body: first hits of rays, clearance of flush-mounted sensors, covers of radars.

Whether a point is inside, and which side of a surface is outside, is told by first hits of rays
alone, so holes, double surfaces and a missing underbody do not matter.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import Floats, ReadOnlyDict, read_only, read_only_copy
from ..base.errors import InputError, require_name, shown
from ..base.notebook import Tabular
from ..base.setting import Panel, check_settings, setting
from ..base.values import A_NAME, Number, numbers
from ..geometry.grids import PerceptionSpace, top_heights
from ..geometry.poses import FARTHEST_M, cross, dot
from ..geometry.ray_traversal import TriangleTree
from ..geometry.raycast import Hits, VisibleTriangles

LOSS_DB = Number(0.0, 100.0, unit="dB", noun="loss")
DEFAULT_CLEARANCE_M = 0.02
"""Distance from the vehicle's surface at which a flush-mounted sensor is evaluated."""
CLEARANCE = Number(0.0, 1.0, below=True, unit="m")
AROUND = 256
BELOW_DEG = 10.0
ENCLOSED = 0.9
"""Number of directions of the inside test, lowest elevation below the horizon, and the share of
directions that must hit the body. A sensor under the body is not inside: it sees out sideways."""
SIDES = 64
LIFT_M = 1e-3
GRAZING = 0.2
"""Open side of a surface: number of directions, distance of the start points from the surface, and
minimum cosine between a direction and the normal, as rays along the surface are no evidence."""
SHAFT_M = 0.3
SHAFT_FROM_M = 0.1
"""Half width of the shaft that has to be empty (wider than a window is high), and distance of its
start from the position: nearer triangles may be the surface on which the sensor is mounted."""


def checked_covers(covers: Any, names: Sequence[str]) -> Mapping[str, float]:
    """Return the loss of covers, one way, by part [dB]. `InputError` when it is no table, a part is
    unknown (near names are offered), or a loss impossible."""
    if not isinstance(covers, Mapping):
        raise InputError("vehicle", "covers", "a table of parts and losses", shown(covers))
    for name in covers:
        require_name("vehicle", "covers", name, names)
    items = covers.items()
    return ReadOnlyDict({k: LOSS_DB.checked("vehicle", f"covers.{k}", v) for k, v in items})


@dataclass(frozen=True, eq=False)
class Vehicle(Tabular):
    """Triangles of the vehicle in the ground frame.

    `InputError` when the triangles are not (F, 3, 3), there are none, a coordinate is not finite or
    beyond 10 km, or a name or the clearance is not valid.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Corners [m]. Open meshes, duplicates and zero-area triangles are allowed.
    parts : (F,) int, optional
        Part of each triangle: an index into `part_names`.
    part_names : sequence of str
        Names of the parts.
    glass : sequence of str
        Parts that cameras see through. They occlude LiDAR beams.
    clearance : float
        A sensor nearer to the surface than this, on either side, is evaluated at this distance
        outside the surface [m]. So a flush-mounted sensor is not occluded by its own surface.
    covers : mapping of str to float
        Parts that radars measure through, and their loss one way [dB]. They occlude all others.
    drawn : Vehicle, optional
        The vehicle as it is drawn, if this is the vehicle in a state. What stands on the ground is
        placed round the vehicle as drawn: a door that opens moves no zone, object or path.
    """

    triangles: Floats
    parts: NDArray[np.int32] = None  # type: ignore[assignment]  # all one part
    part_names: Sequence[str] = ("vehicle",)
    glass: Sequence[str] = ()
    clearance: float = setting(
        DEFAULT_CLEARANCE_M,
        CLEARANCE,
        "How far a flush-mounted sensor counts as outside of the vehicle's skin",
        Panel("clearance", "Clearance", max=0.99),
        scored=True,
    )
    covers: Mapping[str, float] = field(default_factory=dict)
    drawn: "Vehicle | None" = field(default=None, repr=False)

    def __post_init__(self) -> None:
        triangles = _checked_triangles(self.triangles)
        parts = (
            read_only(np.zeros(len(triangles), np.int32))
            if self.parts is None
            else _checked_parts(self.parts, len(self.part_names))
        )
        names = tuple(A_NAME.checked("vehicle", "part_names", n) for n in self.part_names)
        if parts.shape != (len(triangles),):
            found = f"{parts.shape} with {len(names)} names"
            raise InputError("vehicle", "parts", "one index into part_names a triangle", found)
        for name in self.glass:
            require_name("vehicle", "glass", name, names)
        object.__setattr__(self, "covers", checked_covers(self.covers, names))
        check_settings(self, "vehicle")
        for key, value in (("triangles", triangles), ("parts", parts), ("part_names", names)):
            object.__setattr__(self, key, value)
        object.__setattr__(self, "glass", tuple(self.glass))

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle without cached properties."""
        own = self.triangles, self.parts, self.part_names, self.glass, self.clearance, self.covers
        return type(self), (*own, self.drawn)

    @property
    def as_drawn(self) -> "Vehicle":
        """The vehicle as it is drawn: itself, unless it is in a state."""
        return self.drawn or self

    def _rows(self) -> list[dict[str, Any]]:
        counts = np.bincount(self.parts, minlength=len(self.part_names)).tolist()
        return [
            {"part": name, "triangles": count, "glass": name in self.glass}
            | {"cover [dB]": self.covers.get(name)}
            for name, count in zip(self.part_names, counts, strict=True)
        ]

    @classmethod
    def from_trimesh(cls, mesh: Any, **options: Any) -> "Vehicle":
        """Return the vehicle of a mesh of the library trimesh, or of a scene, a part a mesh.

        `InputError` when it is no mesh, or has no triangles; else as of the class.

        Parameters
        ----------
        mesh : trimesh.Trimesh or trimesh.Scene
            In the ground frame [m]: x forward, z up; ``mesh.apply_transform`` turns others. What
            has no triangles is left out.
        **options
            `glass`, `clearance` and `covers`, as of the class.
        """
        found = {"vehicle": (mesh, np.eye(4))}
        if hasattr(mesh, "graph"):
            nodes = {name: mesh.graph[name] for name in mesh.graph.nodes_geometry}
            found = {name: (mesh.geometry[of], at) for name, (at, of) in nodes.items()}
        parts = {
            name: own.copy().apply_transform(at).triangles
            for name, (own, at) in found.items()
            if len(getattr(own, "triangles", ()))
        }
        if not parts:
            expected = "a trimesh.Trimesh or trimesh.Scene with triangles"
            raise InputError("vehicle", "mesh", expected, type(mesh).__name__)
        numbers = np.repeat(np.arange(len(parts)), [len(t) for t in parts.values()])
        return cls(np.concatenate(list(parts.values())), numbers, tuple(parts), **options)

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner, each (3,) [m]."""
        corners = self.triangles.reshape(-1, 3)
        return read_only(corners.min(axis=0)), read_only(corners.max(axis=0))

    @cached_property
    def triangle_bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of each triangle, each (3, F) [m]."""
        corners = self.triangles.transpose(2, 1, 0)
        return read_only(corners.min(axis=1)), read_only(corners.max(axis=1))

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

    def seen_from(self, position: Sequence[float], through_glass: bool = False) -> "VisibleMesh":
        """Return the vehicle for rays from a position (3,) [m]; `through_glass` removes glass."""
        tree = self._tree_without_glass if through_glass else self._tree
        triangles = self.triangles[self._opaque] if through_glass else self.triangles
        origin = _with_clearance(np.asarray(position, dtype=float), triangles, tree, self.clearance)
        return VisibleMesh(VisibleTriangles(tree, origin), self._opaque if through_glass else None)

    def first_hit(
        self, position: Sequence[float], directions: ArrayLike, through_glass: bool = False
    ) -> Hits:
        """Return the first intersections of rays from a position with the vehicle.

        Parameters
        ----------
        position : (3,) float
            Origin of the rays, ground frame [m].
        directions : (B, 3) float
            Unit directions, ground frame.
        through_glass : bool
            Whether the rays pass through the parts in `glass`, as those of cameras do.

        Returns
        -------
        Hits
            `distance` (B,) [m], inf for a miss; `face` (B,) triangle index, -1 for a miss.
        """
        return self.seen_from(position, through_glass).first_hit(
            np.asarray(directions, dtype=float)
        )

    def first_hit_from(self, point: Floats, directions: Floats) -> Hits:
        """Return first hits from exactly this point (3,) [m]; the clearance is not applied."""
        return VisibleTriangles(self._tree, point).first_hit(directions)

    def faces_near(self, point: ArrayLike, distance: float) -> NDArray[np.int64]:
        """(N,) ascending indices of triangles that may be within `distance` [m] of a point (3,)."""
        return self._tree.near(np.asarray(point, dtype=float), distance)

    def top(self, space: PerceptionSpace) -> Floats:
        """(nx, ny) maximum height of the surface at each column's centre [m]; -inf for none."""
        return top_heights(self.triangles, space)


@dataclass(frozen=True, slots=True)
class VisibleMesh:
    """A vehicle for rays from one point; face indices are those of the whole vehicle."""

    seen: VisibleTriangles
    faces: NDArray[np.int64] | None

    def first_hit(self, directions: Floats) -> Hits:
        """Return the first hits along (B, 3) unit directions, ground frame."""
        hits = self.seen.first_hit(directions)
        if self.faces is None or not len(self.faces):
            return hits
        return Hits(hits.distance, np.where(hits.face < 0, -1, self.faces[hits.face]))


def _checked_triangles(values: ArrayLike) -> Floats:
    expected = "(F, 3, 3) numbers, F > 0"
    is_numeric = isinstance(values, np.ndarray) and values.dtype.kind in "iuf"
    if (array := values if is_numeric else numbers(values)) is None:
        raise InputError("vehicle", "triangles", expected, shown(values))
    triangles: Floats = read_only_copy(array, np.float64)
    if triangles.ndim != 3 or triangles.shape[1:] != (3, 3) or not len(triangles):
        raise InputError("vehicle", "triangles", expected, triangles.shape)
    invalid = ~np.isfinite(triangles).all(axis=(1, 2))
    if invalid.any():
        found = f"triangle {int(np.flatnonzero(invalid)[0])} with NaN or infinity"
        raise InputError("vehicle", "triangles", "finite coordinates", found)
    far = np.abs(triangles).max(axis=(1, 2)) > FARTHEST_M
    if far.any():
        found = f"triangle {int(np.flatnonzero(far)[0])} beyond"
        expected = f"coordinates within +-{FARTHEST_M:g} m"
        raise InputError("vehicle", "triangles", expected, found)
    return triangles


def _checked_parts(values: ArrayLike, names: int) -> NDArray[np.int32]:
    """Return (F,) indices below the number of names, or raise `InputError`."""
    try:
        parts = np.asarray(values)
    except ValueError:  # rows of different lengths
        parts = np.array(None)
    whole = parts.dtype.kind in "iu" and parts.size > 0
    if not whole or parts.min() < 0 or parts.max() >= names:
        found = f"{shown(values)} with {names} names"
        raise InputError("vehicle", "parts", "one index into part_names a triangle", found)
    return read_only_copy(parts, np.int32)


def _with_clearance(
    position: Floats, triangles: Floats, tree: TriangleTree, clearance: float
) -> Floats:
    """Return a position at least `clearance` from the surface; moved to the open side if nearer."""
    candidates = triangles[tree.near(position, clearance * 1.001 + 1e-9)]
    low = candidates.min(axis=1)
    high = candidates.max(axis=1)
    gap = np.maximum(np.maximum(low - position, position - high), 0.0)
    near = candidates[dot(gap, gap) < clearance**2]
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
    point = points[nearest]
    direction = lift / np.sqrt(dot(lift, lift))
    ahead, back = (
        VisibleTriangles(tree, point + side * lift).first_hit(side * direction[None]).distance[0]
        for side in (1.0, -1.0)
    )
    return point + (lift if ahead >= back else -lift)  # a ray runs farther outside


def closest_points(point: Floats, triangles: Floats) -> Floats:
    """Return the closest point (F, 3) on each triangle (F, 3, 3) to a point (3,) [m]. Regions as in
    Ericson, Real-Time Collision Detection (2005), section 5.1.5: the projection onto the plane if
    it lies inside the triangle, else the closest point on an edge."""
    a, b, c = (triangles[:, i] for i in range(3))
    nearest = []
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        size = dot(along, along)
        t = dot(point - start, along) / np.where(size == 0.0, 1.0, size)
        nearest.append(start + np.clip(t, 0.0, 1.0)[:, None] * along)
    best = np.stack(nearest)
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


def is_enclosed(vehicle: Vehicle, position: Floats, through_glass: bool = False) -> bool:
    """Whether rays from a point (3,) [m] hit the body in nearly all directions."""
    hits = vehicle.first_hit(position.tolist(), spiral(AROUND, BELOW_DEG), through_glass)
    return float(np.mean(np.isfinite(hits.distance))) >= ENCLOSED


def is_open(vehicle: Vehicle, position: Floats) -> bool:
    """Whether a wide shaft from a position (3,) [m] is empty, upwards or to the nearest side. A
    fast test on the bounds of triangles. An open position is not enclosed; others may be."""
    low, high = vehicle.bounds
    gaps = np.concatenate([position[:2] - low[:2], high[:2] - position[:2]])
    nearest = int(np.argmin(gaps))
    if gaps[nearest] < 0.0 or position[2] > high[2]:  # beside the vehicle, or above it
        return True
    sides = (2, 1.0), (nearest % 2, 1.0 if nearest > 1 else -1.0)
    return any(_shaft_is_empty(vehicle, position, axis, sign) for axis, sign in sides)


def _shaft_is_empty(vehicle: Vehicle, position: Floats, axis: int, sign: float) -> bool:
    """Whether no triangle is in the shaft from a position along an axis, in a direction `sign`."""
    low, high = vehicle.triangle_bounds
    start = float(position[axis]) + sign * SHAFT_FROM_M
    within = high[axis] > start if sign > 0.0 else low[axis] < start
    for across in {0, 1, 2} - {axis}:
        within &= low[across] <= position[across] + SHAFT_M
        within &= high[across] >= position[across] - SHAFT_M
    return not within.any()


def open_shares(vehicle: Vehicle, point: Floats, normal: Floats) -> tuple[float, float]:
    """Return which shares of rays from a point (3,) of a surface miss the body: on the side of its
    unit normal (3,), and on the other."""
    rays = spiral(SIDES, 90.0)
    towards = dot(rays, normal)
    shares = []
    for side in (1.0, -1.0):
        origin = point + side * LIFT_M * normal
        hits = vehicle.first_hit_from(origin, rays[side * towards > GRAZING])
        shares.append(float(np.mean(np.isinf(hits.distance))))
    return shares[0], shares[1]


@cache
def spiral(count: int, below_deg: float) -> Floats:
    """(count, 3) unit directions on a Fibonacci spiral, from `below_deg` under the horizon up."""
    low = -math.sin(math.radians(below_deg))
    rows = []
    for k in range(count):
        z = low + (1.0 - low) * (k + 0.5) / count
        flat = math.sqrt(1.0 - z * z)
        angle = k * math.pi * (3.0 - math.sqrt(5.0))
        rows.append((flat * math.cos(angle), flat * math.sin(angle), z))
    return read_only(np.array(rows))
