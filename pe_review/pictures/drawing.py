"""A picture put together: rays cast, lit, shaded, and cast again where edges run."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .light import skylight, sun_place, sunlight
from .shading import Surroundings, shaded
from .tableau import Met, Tableau
from .viewpoint import Viewshot

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

WITHIN = ((-0.375, -0.125), (-0.125, 0.375), (0.125, -0.375), (0.375, 0.125))
"""Where in a pixel rays are cast again: no two in one row or column."""
BENT = 0.92
"""Cosine of the angle between normals beside each other from which on there is an edge."""
STEP = 0.06
"""A distance that jumps by this share has an edge."""


def drawn(shot: Viewshot, stage: Tableau, setting: Surroundings) -> Floats:
    """(H, W, 3) sRGB, 0 to 1: the picture of a stage."""
    directions = shot.directions()
    seen = stage.seen(shot.eye, directions, from_sensor=shot.from_sensor)
    place = sun_place(stage, setting.sun)
    sun = sunlight(stage, seen, place)
    sky = skylight(stage, seen, (shot.width, shot.height))
    colors = shaded(seen, directions, setting, sun, sky, shot.pixel_rad)
    edges = np.flatnonzero(_edges(seen, sun, (shot.height, shot.width)))
    colors[edges] = _again(shot, stage, setting, edges, place, (sky, seen))
    return colors.reshape(shot.height, shot.width, 3)


def _again(
    shot: Viewshot,
    stage: Tableau,
    setting: Surroundings,
    edges: NDArray[np.int64],
    place: Floats,
    first: tuple[Floats, Met],
) -> Floats:
    """(E, 3) colours of pixels at edges: means over rays within them."""
    sky, seen = first
    row, column = np.divmod(edges, shot.width)
    total = np.zeros((len(edges), 3))
    for right, down in WITHIN:
        directions = shot.look(column + 0.5 + right, row + 0.5 + down)
        found = stage.seen(shot.eye, directions, from_sensor=shot.from_sensor)
        sun = sunlight(stage, found, place)
        open_ = _borrowed(found, sky, seen, edges, (shot.height, shot.width))
        total += shaded(found, directions, setting, sun, open_, shot.pixel_rad)
    return total / len(WITHIN)


def _borrowed(
    found: Met, sky: Floats, seen: Met, edges: NDArray[np.int64], shape: tuple[int, int]
) -> Floats:
    """Skylight of rays within pixels: that of the pixels round them on the same surface."""
    row, column = np.divmod(edges, shape[1])
    total, weight = 1e-6 * sky[edges], np.full(len(edges), 1e-6)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            i, j = np.clip(row + dy, 0, shape[0] - 1), np.clip(column + dx, 0, shape[1] - 1)
            pixel = i * shape[1] + j
            same = (seen.what[pixel] == found.what).astype(float)
            along = (seen.normals[pixel] * found.normals).sum(axis=1)
            same *= np.maximum(along, 0.0) ** 4
            total += same * sky[pixel]
            weight += same
    return total / weight


def _edges(seen: Met, sun: Floats, shape: tuple[int, int]) -> Flags:
    """(H * W,) pixels beside which something else begins."""
    found = np.zeros(shape, bool)
    grids = [each.reshape(shape) for each in (seen.what, seen.part, sun > 0.0)]
    far = np.minimum(seen.distance, 1e6).reshape(shape)
    normals = seen.normals.reshape(*shape, 3)
    solid = (seen.what > 0).reshape(shape)
    for axis in (0, 1):
        one, two = _beside(axis)
        differs = np.zeros(grids[0][one].shape, bool)
        for grid in grids:
            differs |= grid[one] != grid[two]
        bent = np.einsum("...k,...k->...", normals[one], normals[two]) < BENT
        jump = np.abs(far[one] - far[two]) > STEP * np.minimum(far[one], far[two])
        differs |= bent | (jump & solid[one] & solid[two])
        found[one] |= differs
        found[two] |= differs
    return found.ravel()


def _beside(axis: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    all_, first, last = slice(None), slice(None, -1), slice(1, None)
    return ((first, all_), (last, all_)) if axis == 0 else ((all_, first), (all_, last))
