"""Triangles on the skin of a solid, and the cuts that put panel lines into them."""

from __future__ import annotations

import numpy as np
from curves import Array
from panel_lines import GAP, Where, widened
from surface import Solid, onto_skin, onto_solid


class Skin:
    """Triangles with points that may no longer move because a panel line runs through them."""

    def __init__(self, points: Array, triangles: Array, solid: Solid) -> None:
        self.points = points
        self.triangles = triangles
        self.solid = solid
        self.locked = np.zeros(len(points), dtype=bool)

    def centres(self) -> Array:
        return self.points[self.triangles].mean(axis=1)

    def keep(self, mask: Array) -> None:
        self.triangles = self.triangles[mask]


def spread(points: Array, start: float, stop: float, cells: int) -> Array:
    """`cells + 1` points evenly between two (fractional) indices of a dense polyline."""
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    ends = np.interp([start, stop], np.arange(len(points)), length)
    at = np.linspace(*ends, cells + 1)
    return np.column_stack([np.interp(at, length, points[:, k]) for k in range(3)])


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


def from_grids(solid: Solid, *grids: tuple[Array, bool]) -> Skin:
    """Grids of points (rows, columns, 3) as one skin; those with True are turned inside out."""
    points = []
    triangles = []
    used = 0
    for grid, flip in grids:
        flat = grid.reshape(-1, 3)
        faces = split_quads(flat, quads(*grid.shape[:2]))
        triangles.append((faces[:, ::-1] if flip else faces) + used)
        points.append(flat)
        used += len(flat)
    return Skin(*weld(np.vstack(points), np.vstack(triangles)), solid)


def edges_of(triangles: Array) -> Array:
    """Unique edges, smaller index first."""
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def crossings(skin: Skin, line: Solid, value: Array, edges: Array) -> tuple[Array, Array, Array]:
    """Edges where the line function changes sign, the fraction along them, and the points."""
    edges = edges[value[edges[:, 0]] * value[edges[:, 1]] < 0]
    start = skin.points[edges[:, 0]]
    stop = skin.points[edges[:, 1]]
    sign = np.sign(value[edges[:, 0]])
    low = np.zeros(len(edges))
    high = np.ones(len(edges))
    for _ in range(24):
        middle = (low + high) / 2
        same = line(start + (stop - start) * middle[:, None]) * sign > 0
        low = np.where(same, middle, low)
        high = np.where(same, high, middle)
    return edges, low, start + (stop - start) * low[:, None]


def snap(skin: Skin, line: Solid, value: Array, edges: Array) -> None:
    """Pull free points near the line onto it (in place): no slivers later."""
    edges, at, target = crossings(skin, line, value, edges)
    best = np.full(len(skin.points), 0.30)
    length = np.linalg.norm(skin.points[edges[:, 0]] - skin.points[edges[:, 1]], axis=1)
    for (a, b), t, size, point in zip(edges, at, length, target, strict=True):
        near, far, t = (a, b, t) if t < 0.5 else (b, a, 1 - t)
        centre = abs(skin.points[near, 1]) < 1e-6
        free = not skin.locked[near] and (not centre or abs(skin.points[far, 1]) < 1e-6)
        if free and t < best[near]:
            best[near] = t
            value[near] = 0
            skin.points[near] = point
        elif not free and t * size < 0.0015:
            value[near] = 0
    moved = best < 0.30
    skin.points[moved] = onto_skin(skin.points[moved], skin.solid, line)
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
    ab, bc, ca = new[turn:] + new[:turn]
    if count == 1:
        return [(a, ab, c), (ab, b, c)]
    if count == 3:
        return [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return [(ab, b, bc), (a, ab, c), (ab, bc, c)]


def cut(skin: Skin, line: Solid, where: Where | None = None) -> None:
    """Put a chain of edges along `line(points) == 0` (in place), only on faces where asked."""
    value = line(skin.points)
    value[np.abs(value) < 1e-7] = 0
    chosen = skin.triangles if where is None else skin.triangles[where(skin.centres()) > 0]
    edges = edges_of(chosen)
    snap(skin, line, value, edges)
    edges, _, target = crossings(skin, line, value, edges)
    insert(skin, edges, onto_skin(target, skin.solid, line), locked=True)


def cut_gaps(skin: Skin, shut_lines: list[tuple[Solid, Where]]) -> None:
    """Both sides of each shut line into the skin (in place), where it runs."""
    for edge, where in shut_lines:
        cut(skin, widened(edge, GAP), where)
        cut(skin, widened(edge, -GAP), where)


def refine(skin: Skin, where: Where, size: float) -> None:
    """Halve the longest edges of triangles that reach there and are larger (in place)."""
    shares = ((0.8, 0.1, 0.1), (0.4, 0.4, 0.2))
    weights = np.array([np.roll(share, k) for share in shares for k in range(3)])
    for _ in range(8):  # each round halves them
        corners = skin.points[skin.triangles]
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        inner = np.einsum("wk,tkc->wtc", weights, corners)
        reach = np.any([where(points) > 0 for points in inner], axis=0)
        found = np.flatnonzero(reach & (sides.max(axis=1) > size))
        if not len(found):
            return
        start = sides[found].argmax(axis=1)
        ends = np.column_stack([start, (start + 1) % 3])
        edges = np.take_along_axis(skin.triangles[found], ends, axis=1)
        edges = np.unique(np.sort(edges, axis=1), axis=0)
        middle = skin.points[edges].mean(axis=1)
        insert(skin, edges, onto_solid(middle, skin.solid), locked=False)


def insert(skin: Skin, edges: Array, points: Array, locked: bool) -> None:
    """Put a new point on each of some edges (in place)."""
    first = len(skin.points)
    middle = {(int(a), int(b)): first + i for i, (a, b) in enumerate(edges)}
    skin.points = np.vstack([skin.points, points])
    skin.locked = np.concatenate([skin.locked, np.full(len(points), locked)])
    pieces = [piece for triangle in skin.triangles for piece in split(triangle, middle)]
    skin.triangles = np.array(pieces)


def boundary(triangles: Array) -> Array:
    """Directed edges with a triangle on one side only."""
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    have = {tuple(pair) for pair in pairs.tolist()}
    return np.array([pair for pair in pairs.tolist() if (pair[1], pair[0]) not in have])
