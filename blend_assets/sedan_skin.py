"""The left half of the sedan's skin as triangles: sample the solid, then cut panels out of it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import sedan_profile as profile
from sedan_profile import Array, Curve

SIDE_CELLS, TOP_CELLS = 17, 9  # quads from the sill to the roof rail, and on to the centre line
STATIONS = np.concatenate(
    [
        np.linspace(-2.235, -1.80, 7)[:-1],
        np.linspace(-1.80, 1.90, 47),
        np.linspace(1.90, 2.26, 7)[1:],
    ]
)
# Plan curvature of the sampling sheets: straight amidships, bowed like the bumpers at the ends.
SHEET_BOW = Curve((-2.30, -0.29), (-1.70, -0.14), (-1.00, 0.00), (0.60, 0.02), (1.50, 0.12),
                  (2.30, 0.36))  # fmt: skip
# Angle above the horizon, in degrees, of the edge between the side and the top of a section.
EDGE_ANGLE = Curve((-2.30, 31.0), (-1.90, 34.0), (-1.40, 48.0), (-0.80, 53.5), (-0.10, 53.5),
                   (0.35, 49.0), (0.80, 33.0), (1.10, 25.0), (1.60, 20.5), (2.30, 9.0))  # fmt: skip


class Skin:
    """Triangles with points that may no longer move because a panel line runs through them."""

    def __init__(self, points: Array, triangles: Array) -> None:
        self.points, self.triangles = points, triangles
        self.locked = np.zeros(len(points), dtype=bool)

    def centres(self) -> Array:
        return self.points[self.triangles].mean(axis=1)

    def keep(self, mask: Array) -> None:
        self.triangles = self.triangles[mask]


def root(inside: Array, outside: Array) -> Array:
    """The point on the skin between pairs of points inside and outside of the car."""
    low, high = np.zeros(len(inside)), np.ones(len(inside))
    for _ in range(30):
        middle = (low + high) / 2
        out = profile.solid(inside + (outside - inside) * middle[:, None]) > 0
        high, low = np.where(out, middle, high), np.where(out, low, middle)
    return inside + (outside - inside) * low[:, None]


def onto_sheet(station: float, flat: Array) -> Array:
    """(y, z) pairs to points on the bowed sheet of one station."""
    x = station - SHEET_BOW(station) * flat[:, 0] ** 2
    return np.column_stack([x, flat])


def section(station: float, count: int = 400) -> tuple[Array, Array]:
    """Dense points of one cross section from below the sill to the centre, and their angles."""
    angle = np.radians(np.linspace(-60, 90, count))
    ray = np.column_stack([np.cos(angle), np.sin(angle)])
    low, high = np.full(count, 0.02), np.full(count, 1.5)
    for _ in range(30):
        middle = (low + high) / 2
        flat = ray * middle[:, None] + [0, profile.SPINE_Z]
        out = profile.solid(onto_sheet(station, flat)) > 0
        high, low = np.where(out, middle, high), np.where(out, low, middle)
    flat = ray * low[:, None] + [0, profile.SPINE_Z]
    return onto_sheet(station, flat), np.degrees(angle)


def spread(points: Array, start: float, stop: float, cells: int) -> Array:
    """`cells + 1` points evenly between two (fractional) indices of a dense polyline."""
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    ends = np.interp([start, stop], np.arange(len(points)), length)
    at = np.linspace(*ends, cells + 1)
    return np.column_stack([np.interp(at, length, points[:, k]) for k in range(3)])


def ring(station: float) -> Array:
    """One cross section as SIDE_CELLS + TOP_CELLS + 1 points from the sill to the centre."""
    dense, angle = section(station)
    index = np.arange(len(dense))
    floor = np.interp(0, dense[:, 2] - profile.FLOOR(dense[:, 0]), index)
    edge = np.interp(EDGE_ANGLE(station), angle, index)
    side = spread(dense, floor, edge, SIDE_CELLS)
    top = spread(dense, edge, len(dense) - 1, TOP_CELLS)
    points = np.vstack([side, top[1:]])
    points[-1, 1] = 0
    return points


def end_cap(outline: Array, station: float, forward: float) -> Array:
    """Bumper face: fill the last ring with a grid (TOP_CELLS + 1, SIDE_CELLS + 1) of points."""
    side, top = outline[: SIDE_CELLS + 1], outline[SIDE_CELLS:][::-1]
    u = np.linspace(0, 1, TOP_CELLS + 1)[:, None, None]
    v = np.linspace(0, 1, SIDE_CELLS + 1)[None, :, None]
    flat = u * side[None, :, 1:] + (1 - u) * (v * top[0, 1:] + (1 - v) * side[0, 1:] * [0, 1])
    flat[:, -1], flat[0, :, 0] = top[:, 1:], 0
    for _ in range(300):  # relax, so that no cell folds in the rounded corner
        ends = (flat[:-2, 1:-1], flat[2:, 1:-1], flat[1:-1, :-2], flat[1:-1, 2:])
        flat[1:-1, 1:-1] = sum(ends) / 4
    start = onto_sheet(station, flat.reshape(-1, 2))
    grid = root(start, start + np.array([forward, 0, 0])).reshape(TOP_CELLS + 1, SIDE_CELLS + 1, 3)
    grid[-1, :], grid[:, -1] = side, top
    return grid


def quads(rows: int, columns: int) -> Array:
    """Corner indices of a grid of points stored row by row."""
    index = np.arange(rows * columns).reshape(rows, columns)
    corners = (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    return np.stack(corners, axis=-1).reshape(-1, 4)


def split_quads(points: Array, faces: Array) -> Array:
    """Each quad as two triangles, across the diagonal that leaves the larger smallest triangle."""
    a, b, c, d = faces.T

    def smaller(*pair: tuple[Array, Array, Array]) -> Array:
        area = [np.cross(points[j] - points[i], points[k] - points[i]) for i, j, k in pair]
        return np.min([np.linalg.norm(vector, axis=1) for vector in area], axis=0)

    long = smaller((a, b, d), (b, c, d)) > smaller((a, b, c), (a, c, d))
    first = np.where(long[:, None], np.column_stack([a, b, d]), np.column_stack([a, b, c]))
    second = np.where(long[:, None], np.column_stack([b, c, d]), np.column_stack([a, c, d]))
    return np.vstack([first, second])


def weld(points: Array, triangles: Array) -> tuple[Array, Array]:
    """Join points nearer than 0.01 mm, drop triangles that collapse and points not used."""
    _, first, inverse = np.unique(
        np.round(points, 5) + 0.0, axis=0, return_index=True, return_inverse=True
    )
    triangles = inverse.reshape(-1)[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    used, compact = np.unique(triangles, return_inverse=True)
    return points[first][used], compact.reshape(-1, 3)


def sample() -> Skin:
    """The uncut left half, open at the floor and at the centre plane."""
    rings = np.array([ring(station) for station in STATIONS])
    rear = end_cap(rings[0], STATIONS[0], -0.6)
    front = end_cap(rings[-1], STATIONS[-1], 0.6)
    points, triangles, used = [], [], 0
    for grid, flip in ((rings, True), (rear, True), (front, False)):
        flat = grid.reshape(-1, 3)
        faces = split_quads(flat, quads(*grid.shape[:2]))
        triangles.append((faces[:, ::-1] if flip else faces) + used)
        points.append(flat)
        used += len(flat)
    return Skin(*weld(np.vstack(points), np.vstack(triangles)))


def edges_of(triangles: Array) -> Array:
    """Unique edges, smaller index first."""
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0)


Line = Callable[[Array], Array]


def crossings(skin: Skin, line: Line, value: Array, edges: Array) -> tuple[Array, Array, Array]:
    """Edges where the line function changes sign, the fraction along them, and the points."""
    edges = edges[value[edges[:, 0]] * value[edges[:, 1]] < 0]
    start, stop = skin.points[edges[:, 0]], skin.points[edges[:, 1]]
    sign = np.sign(value[edges[:, 0]])
    low, high = np.zeros(len(edges)), np.ones(len(edges))
    for _ in range(24):
        middle = (low + high) / 2
        same = line(start + (stop - start) * middle[:, None]) * sign > 0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return edges, low, start + (stop - start) * low[:, None]


def snap(skin: Skin, line: Line, value: Array, edges: Array) -> None:
    """Pull free points near the line onto it (in place): no slivers later."""
    edges, at, target = crossings(skin, line, value, edges)
    best = np.full(len(skin.points), 0.30)
    length = np.linalg.norm(skin.points[edges[:, 0]] - skin.points[edges[:, 1]], axis=1)
    for (a, b), t, size, point in zip(edges, at, length, target, strict=True):
        near, far, t = (a, b, t) if t < 0.5 else (b, a, 1 - t)
        centre = abs(skin.points[near, 1]) < 1e-6
        free = not skin.locked[near] and (not centre or abs(skin.points[far, 1]) < 1e-6)
        if free and t < best[near]:
            best[near], value[near] = t, 0
            skin.points[near] = point
        elif not free and t * size < 0.0015:
            value[near] = 0
    moved = best < 0.30
    skin.points[moved] = profile.onto_skin(skin.points[moved], line)
    skin.locked |= value == 0


def split(triangle: Array, middle: dict[tuple[int, int], int]) -> list[tuple[int, int, int]]:
    """One triangle with new points on some of its edges as smaller triangles."""
    corners = [int(i) for i in triangle]
    sides = zip(corners, corners[1:] + corners[:1], strict=True)
    new = [middle.get((min(side), max(side))) for side in sides]
    count = sum(m is not None for m in new)
    if count == 0:
        return [tuple(corners)]
    both_new = [new[i] is not None and (count == 1 or new[i - 2] is not None) for i in range(3)]
    turn = both_new.index(True)
    a, b, c = corners[turn:] + corners[:turn]
    ab, bc, _ = new[turn:] + new[:turn]
    if count == 1:
        return [(a, ab, c), (ab, b, c)]
    return [(ab, b, bc), (a, ab, c), (ab, bc, c)]


def cut(skin: Skin, line: Line, where: Callable[[Array], Array] | None = None) -> None:
    """Put a chain of edges along `line(points) == 0` (in place), only on faces where asked."""
    value = line(skin.points)
    value[np.abs(value) < 1e-7] = 0
    chosen = skin.triangles if where is None else skin.triangles[where(skin.centres())]
    edges = edges_of(chosen)
    snap(skin, line, value, edges)
    edges, _, target = crossings(skin, line, value, edges)
    first = len(skin.points)
    middle = {(int(a), int(b)): first + i for i, (a, b) in enumerate(edges)}
    skin.points = np.vstack([skin.points, profile.onto_skin(target, line)])
    skin.locked = np.concatenate([skin.locked, np.ones(len(target), dtype=bool)])
    pieces = [piece for triangle in skin.triangles for piece in split(triangle, middle)]
    skin.triangles = np.array(pieces)


def boundary(triangles: Array) -> Array:
    """Directed edges with a triangle on one side only."""
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    have = {tuple(pair) for pair in pairs.tolist()}
    return np.array([pair for pair in pairs.tolist() if (pair[1], pair[0]) not in have])
