"""Parts that are not skin: wheels, mirrors, number plates, wheel housings and the floor."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import sedan_profile as profile
from mathutils.geometry import tessellate_polygon
from sedan_profile import Array
from sedan_skin import quads, split_quads

SEGMENTS = 36  # around a wheel
SPOKES = 10
# Radius and offset from the wheel's centre plane (outwards positive), from the inside out.
TYRE = [(0.205, -0.095), (0.240, -0.106), (0.290, -0.1125), (0.318, -0.100), (0.330, -0.070),
        (0.330, 0.070), (0.318, 0.100), (0.290, 0.1125), (0.246, 0.108)]  # fmt: skip
RIM = [(0.246, 0.108), (0.238, 0.110), (0.228, 0.102), (0.220, 0.060)]
DISC = [(0.220, 0.060), (0.212, 0.030), (0.060, 0.022)]
# Spoke: radius, offset of the face, half width.
SPOKE = [(0.045, 0.092, 0.020), (0.130, 0.095, 0.016), (0.229, 0.100, 0.020)]
HUB = [(0.066, 0.030), (0.064, 0.088), (0.050, 0.098), (0.022, 0.100)]


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


def lathe(outline: list[tuple[float, float]], material: str, ends: tuple[bool, bool]) -> Part:
    """Turn (radius, offset) pairs about the wheel's axis, y."""
    angle = np.linspace(0, 2 * np.pi, SEGMENTS, endpoint=False) - np.pi / 2
    rings = [np.column_stack([r * np.cos(angle), np.full(SEGMENTS, y), r * np.sin(angle)])
             for r, y in outline]  # fmt: skip
    return tube(np.array(rings), material, ends)


def spoke(turn: float) -> Part:
    """One spoke: a face and two flanks."""
    rows = []
    for _, offset, half in SPOKE:
        rows.append([(-half * 1.25, offset - 0.045), (-half, offset), (half, offset),
                     (half * 1.25, offset - 0.045)])  # fmt: skip
    flat = np.array(rows)
    radius = np.array([row[0] for row in SPOKE])[:, None]
    cos, sin = np.cos(turn), np.sin(turn)
    x = radius * cos - flat[..., 0] * sin
    z = radius * sin + flat[..., 0] * cos
    points = np.stack([x, flat[..., 1], z], axis=-1).reshape(-1, 3)
    faces = split_quads(points, quads(3, 4))[:, ::-1]
    return Part(points, faces, ["rim"] * len(faces))


def wheel() -> Part:
    """A left wheel about its own centre: the outer face looks along +y."""
    pair = 0.20  # half the angle between the two spokes of a pair
    turns = [np.pi / 2 + 2 * np.pi * k / (SPOKES // 2) + side * pair
             for k in range(SPOKES // 2) for side in (-1, 1)]  # fmt: skip
    return join(
        lathe(TYRE, "tyre", (True, False)),
        lathe(RIM, "rim", (False, False)),
        lathe(DISC, "trim", (False, True)),
        lathe(HUB, "rim", (False, True)),
        *[spoke(turn) for turn in turns],
    )


def mirror() -> Part:
    """The left door mirror: a rounded housing with a flat glass, on a short foot."""
    # y, centre x, centre z, half depth, half height
    stations = [(0.842, 0.672, 1.000, 0.026, 0.028), (0.862, 0.670, 1.006, 0.062, 0.056),
                (0.900, 0.664, 1.010, 0.076, 0.068), (0.955, 0.654, 1.012, 0.074, 0.068),
                (0.995, 0.644, 1.013, 0.060, 0.058),
                (1.015, 0.636, 1.013, 0.030, 0.034)]  # fmt: skip
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    cos, sin = np.cos(angle), np.sin(angle)
    cos, sin = np.sign(cos) * np.abs(cos) ** 0.8, np.sign(sin) * np.abs(sin) ** 0.8
    rings = [np.column_stack([x + np.maximum(cos * dx, -0.045), np.full(16, y), z + sin * dz])
             for y, x, z, dx, dz in stations]  # fmt: skip
    head = tube(np.array(rings), "paint", (True, True))
    corner = head.points[head.triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    glass = normal[:, 0] < -0.97 * np.linalg.norm(normal, axis=1)
    head = head._replace(materials=["glass" if flag else "paint" for flag in glass])
    return join(head, mirror_foot())


def mirror_foot() -> Part:
    """A tapered arm from the door to the housing."""
    angle = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    rings = [np.column_stack([x + dx * np.cos(angle), np.full(8, y), z + dz * np.sin(angle)])
             for y, x, z, dx, dz in ((0.765, 0.690, 0.962, 0.050, 0.020),
                                     (0.880, 0.672, 0.985, 0.034, 0.016))]  # fmt: skip
    return tube(np.array(rings), "trim", (True, True))


def plate(z: float, forward: float) -> Part:
    """A number plate, 0.52 x 0.11 m and 12 mm thick, that stands on the bumper."""
    y, height = np.meshgrid([-0.26, 0.26], [z - 0.055, z + 0.055], indexing="ij")
    flat = np.column_stack([y.ravel(), height.ravel()])
    corners = [surface_x(np.array([forward * 1.6, *point]), forward) for point in flat]
    middle = surface_x(np.array([forward * 1.6, 0.0, z]), forward) * forward - 0.006
    order = [0, 1, 3, 2] if forward < 0 else [0, 2, 3, 1]
    reach = np.maximum(np.array(corners) * forward, middle) + 0.012
    face = np.column_stack([reach * forward, flat])[order]
    back = face - [0.05 * forward, 0, 0]
    return tube(np.array([back, face])[:, ::-1], "plate", (False, True))


def surface_x(point: Array, forward: float) -> float:
    """Where the line along x through this point meets the skin."""
    low, high = point[0], point[0] + forward
    for _ in range(30):
        middle = (low + high) / 2
        out = profile.solid(np.array([[middle, point[1], point[2]]]))[0] > 0
        low, high = (low, middle) if out else (middle, high)
    return low


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
