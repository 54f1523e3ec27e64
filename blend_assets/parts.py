"""Named pieces of a vehicle: triangles with materials, and simple bodies made of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from curves import Array
from mathutils.geometry import tessellate_polygon
from skin import quads, split_quads
from surface import Solid, surface_x


class Part(NamedTuple):
    """Triangles with one material name each."""

    points: Array
    triangles: Array
    materials: list[str]


def join(*parts: Part) -> Part:
    """Several parts as one."""
    start = np.cumsum([0] + [len(part.points) for part in parts])
    return Part(
        np.vstack([part.points for part in parts]),
        np.vstack([part.triangles + n for part, n in zip(parts, start, strict=False)]),
        [material for part in parts for material in part.materials],
    )


def flipped(part: Part) -> Part:
    """The mirror image in the plane y = 0."""
    return Part(part.points * [1, -1, 1], part.triangles[:, ::-1], part.materials)


def tube(rings: Array, material: str, caps: tuple[bool, bool] = (False, False)) -> Part:
    """A skin over closed rings (n, m, 3), if wanted with flat ends."""
    rows, columns = rings.shape[:2]
    closed = np.concatenate([rings, rings[:, :1]], axis=1).reshape(-1, 3)
    faces = split_quads(closed, quads(rows, columns + 1))
    faces = faces // (columns + 1) * columns + faces % (columns + 1) % columns
    first = np.array([[0, i, i + 1] for i in range(1, columns - 1)])
    last = first[:, ::-1] + (rows - 1) * columns
    faces = np.vstack(
        [faces, *(cap for cap, want in zip((first, last), caps, strict=True) if want)]
    )
    return Part(rings.reshape(-1, 3), faces, [material] * len(faces))


def plate(solid: Solid, start: float, z: float) -> Part:
    """A number plate, 0.52 x 0.11 m and 12 mm thick, that stands on the bumper.

    The bumper is looked for from x = `start`, inside, outwards.
    """
    forward = 1.0 if start > 0 else -1.0
    y, height = np.meshgrid([-0.26, 0.26], [z - 0.055, z + 0.055], indexing="ij")
    flat = np.column_stack([y.ravel(), height.ravel()])
    corners = [surface_x(solid, np.array([start, *point]), forward) for point in flat]
    middle = surface_x(solid, np.array([start, 0.0, z]), forward) * forward - 0.006
    order = [0, 1, 3, 2] if forward < 0 else [0, 2, 3, 1]
    reach = np.maximum(np.array(corners) * forward, middle) + 0.012
    face = np.column_stack([reach * forward, flat])[order]
    back = face - [0.05 * forward, 0, 0]
    return tube(np.array([back, face])[:, ::-1], "plate", (False, True))


def fill(loop: Array, outward: Array) -> Array:
    """Triangles over a closed chain of points, turned towards `outward`."""
    triangles = np.array(tessellate_polygon([[tuple(point) for point in loop]]))
    a, b, c = loop[triangles].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    wrong = normal @ outward < 0
    triangles[wrong] = triangles[wrong][:, ::-1]
    return triangles[np.linalg.norm(normal, axis=1) > 1e-9]


def chains(edges: Array) -> list[list[int]]:
    """Directed edges as paths; a closed one repeats its first point."""
    following = {int(a): int(b) for a, b in edges}
    starts = [a for a in following if a not in set(following.values())]
    paths = []
    while following:
        here = starts.pop() if starts else next(iter(following))
        path = [here]
        while here in following:
            here = following.pop(here)
            path.append(here)
        paths.append(path)
    return paths
