"""The left half of the bus's skin as triangles, before panels are cut out of it.

Upright sections from the floor to the roof follow the outline in plan: across the nose, around
the corner, along the side, around the corner, across the tail. They end on the roof, on a
rectangle that a flat grid fills.
"""

from __future__ import annotations

import bus_profile as profile
import numpy as np
from curves import Array
from skin import Skin, from_grids, spread
from surface import root

# corner of that rectangle, about the axis of the body's corner
INNER_X = 2.74
INNER_Y = 0.72
# quads along, across, and around one corner
LONG_CELLS = 24
CROSS_CELLS = 4
FAN_CELLS = 7
# quads from the floor to the roof's edge, and over it
WALL_CELLS = 11
EDGE_CELLS = 6
EDGE_START_Z = 2.12
SPINE_Z = 1.40  # height from which sections are looked for
FAR = 4.0


def section(centre: Array, outwards: Array, count: int = 500) -> Array:
    """One upright section (cells + 1, 3) from the floor to the roof above `centre` (x, y)."""
    angle = np.radians(np.linspace(-85, 90, count))[:, None]
    inside = np.tile([*centre, SPINE_Z], (count, 1))
    ray = np.hstack([np.cos(angle) * outwards, np.sin(angle)])
    ray[-1] = 0, 0, 1
    dense = root(profile.solid, inside, inside + FAR * ray)
    index = np.arange(count)
    floor, edge = np.interp([profile.FLOOR_Z, EDGE_START_Z], dense[:, 2], index)
    wall = spread(dense, floor, edge, WALL_CELLS)
    top = spread(dense, edge, count - 1, EDGE_CELLS)
    return np.vstack([wall, top[1:]])


def outline() -> list[tuple[Array, Array]]:
    """(centre, outward direction) in plan of all sections, from the nose to the tail."""
    across = np.linspace(0, INNER_Y, CROSS_CELLS + 1)
    along = np.linspace(INNER_X, -INNER_X, LONG_CELLS + 1)
    turn = np.linspace(0, np.pi / 2, FAN_CELLS + 1)
    nose = [((INNER_X, y), (1, 0)) for y in across[:-1]]
    front = [((INNER_X, INNER_Y), (np.cos(a), np.sin(a))) for a in turn[:-1]]
    side = [((x, INNER_Y), (0, 1)) for x in along]
    rear = [((-INNER_X, INNER_Y), (-np.sin(a), np.cos(a))) for a in turn[1:]]
    tail = [((-INNER_X, y), (-1, 0)) for y in across[::-1][1:]]
    return [
        (np.array(centre, float), np.array(outwards, float))
        for centre, outwards in nose + front + side + rear + tail
    ]


def roof_grid() -> Array:
    """The middle of the roof: (along, across, 3)."""
    x = np.linspace(INNER_X, -INNER_X, LONG_CELLS + 1)
    y = np.linspace(0, INNER_Y, CROSS_CELLS + 1)
    flat = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    inside = np.column_stack([flat, np.full(len(flat), SPINE_Z)])
    top = root(profile.solid, inside, inside + np.array([0, 0, FAR]))
    return top.reshape(len(x), len(y), 3)


def sample() -> Skin:
    """The uncut left half, open at the floor and at the centre plane."""
    walls = np.array([section(*station) for station in outline()])
    walls[[0, -1], :, 1] = 0
    return from_grids(profile.solid, (walls, False), (roof_grid(), True))
