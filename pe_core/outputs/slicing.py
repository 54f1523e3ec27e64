"""Closed surfaces cut by a level plane: outlines of the inside."""

from __future__ import annotations

import numpy as np

from ..sight.outline import chained
from .solid import Floats, Ints, Solid


def level_outlines(solid: Solid, height: float) -> tuple[Floats, ...]:
    """Return closed lines (N, 2) round what a solid fills at a height [m], that on their left.

    The last point is the first again. A corner at that very height counts as above.
    """
    above = solid.points[solid.faces][..., 2] >= height
    cut = above.any(axis=1) & ~above.all(axis=1)
    faces, above = solid.faces[cut], above[cut]
    # Counter-clockwise from outside: an outline comes in where an edge leads down through the
    # plane, and goes on to the triangle beside where one leads up.
    down, up = _leading(faces, above), _leading(faces, ~above)
    points = _passing(solid.points, down, height)
    numbers, back = (edge.min(axis=1) * len(solid.points) + edge.max(axis=1) for edge in (down, up))
    row = {number: k for k, number in enumerate(numbers.tolist())}
    return tuple(points[[row[number] for number in ring]] for ring in chained(numbers, back))


def _leading(faces: Ints, first: Ints) -> Ints:
    """Return the edge (T, 2) of each triangle that leads away from what is `first`."""
    corner = np.argmax(first & ~np.roll(first, -1, axis=1), axis=1)
    row = np.arange(len(faces))
    return np.stack([faces[row, corner], faces[row, (corner + 1) % 3]], axis=1)


def _passing(points: Floats, edges: Ints, height: float) -> Floats:
    """Return where edges pass a height: (E, 2)."""
    start, end = points[edges[:, 0]], points[edges[:, 1]]
    share = (height - start[:, 2]) / (end[:, 2] - start[:, 2])
    return start[:, :2] + share[:, None] * (end - start)[:, :2]
