"""Bodies with upright walls: an outline in plan at several heights, cut into named panels.

Buses, cabs and boxes of trucks are made so: the outline is a rectangle with round corners whose
sides and ends may lean; lines along and across it, and the heights, are where panels meet. All
lengths in metres, x forward, y left, z up.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from curves import Array
from parts import Part, fill, join

CORNER_STEPS = 4
"""Faces around an upright corner."""
Panel = tuple[str, str]
"""Name of the part, and its material."""


class Level(NamedTuple):
    """The outline at a height: rear and front end, half the width, radius of the corners."""

    z: float
    rear: float
    front: float
    half: float
    radius: float


class Place(NamedTuple):
    """A face of the wall: which wall it is in, and its centre."""

    wall: str  # "front", "left", "rear", "right" or "corner"
    x: float
    y: float
    z: float


def outline(level: Level, along: Array, across: Array) -> tuple[Array, list[str]]:
    """Points (N, 2) of an outline from the front's right end on, and the wall after each point.

    `along` are the x of lines on the sides, `across` the y of lines on the ends, both ascending.
    """
    _, rear, front, half, radius = level
    corner = np.linspace(0.0, np.pi / 2, CORNER_STEPS + 1)
    sides = {
        "front": (across, lambda y: (np.full_like(y, front), y)),
        "left": (along[::-1], lambda x: (x, np.full_like(x, half))),
        "rear": (across[::-1], lambda y: (np.full_like(y, rear), y)),
        "right": (along, lambda x: (x, np.full_like(x, -half))),
    }
    middles = [(front, half), (rear, half), (rear, -half), (front, -half)]
    points = []
    walls = []
    for turn, (wall, (lines, place)) in enumerate(sides.items()):
        straight = np.column_stack(place(np.asarray(lines, float)))
        x, y = middles[turn]
        middle = np.array([x - np.sign(x - (rear + front) / 2) * radius, y - np.sign(y) * radius])
        angle = corner + turn * np.pi / 2
        arc = middle + radius * np.column_stack([np.cos(angle), np.sin(angle)])
        points += [straight, arc]
        walls += [wall] * len(straight) + ["corner"] * CORNER_STEPS + [_next(sides, wall)]
    return np.vstack(points), walls


def _next(sides: dict, wall: str) -> str:
    names = list(sides)
    return names[(names.index(wall) + 1) % len(names)]


def body(
    levels: list[Level],
    along: list[float],
    across: list[float],
    panel: Callable[[Place], Panel],
    roof: Panel,
    floor: Panel,
) -> dict[str, Part]:
    """Return the parts of a closed body: walls by panel, its roof, its floor."""
    rings = []
    walls = []
    for level in levels:
        flat, walls = outline(level, np.array(along), np.array(across))
        rings.append(np.column_stack([flat, np.full(len(flat), level.z)]))
    points = np.vstack(rings)
    count = len(rings[0])
    found: dict[Panel, list[tuple[int, int, int]]] = {}
    for low in range(len(levels) - 1):
        for j in range(count):
            a = low * count + j
            b = low * count + (j + 1) % count
            wall = walls[j]
            centre = points[[a, b, a + count, b + count]].mean(axis=0)
            kind = panel(Place(wall, *centre))
            found.setdefault(kind, []).extend([(a, b, b + count), (a, b + count, a + count)])
    parts: dict[str, list[Part]] = {}
    for (name, material), faces in found.items():
        part = Part(points, np.array(faces), [material] * len(faces))
        parts.setdefault(name, []).append(part)
    for (name, material), ring, up in ((roof, rings[-1], 1.0), (floor, rings[0], -1.0)):
        faces = fill(ring, np.array([0.0, 0.0, up]))
        parts.setdefault(name, []).append(Part(ring, faces, [material] * len(faces)))
    return {name: join(*some) for name, some in parts.items()}


def box(low: tuple[float, ...], high: tuple[float, ...], material: str) -> Part:
    """A plain box between two corners."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    points = np.array(low) + corners * (np.array(high) - np.array(low))
    faces = np.array(
        [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
         (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    )  # fmt: skip
    return Part(points, faces, [material] * len(faces))


def within(value: float, bounds: tuple[float, float]) -> bool:
    """Whether a number is between two."""
    return bounds[0] < value < bounds[1]
