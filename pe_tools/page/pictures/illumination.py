"""Light on surfaces: a sun that casts shadows, and a sky that corners see less of.

Rays cast from one point show what a lamp there illuminates; everything else is in its shadow. The
sky is a dome of lamps, divided into sets. The pixels of every second row and column form a coarse
grid; each of them evaluates one set of lamps, its neighbours the other sets, and neighbours on the
same surface share their results.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats, Ints

from .painted_mesh import unit
from .ray_scene import GROUND, RayHits, RayScene

Size = tuple[int, int]

LAMPS_PER_PIXEL, LAMP_SETS = 6, 4
"""Lamps in a set, and number of sets in the dome."""
LAMP_DISTANCE = 8.0
"""Distance of the lamps, in half the extent of all solids."""
OPEN_GROUND = 3.0
"""Ground farther than this from every solid sees the whole sky, in heights of the solid."""
SAME_COSINE = 0.85
"""Cosine of the largest angle between two normals of one surface."""
NEIGHBOURS = (-2, -1, 0, 1)
"""Offsets of pixels that share skylight, in both directions: each set of lamps equally often."""
SURFACE_OFFSET_M = 0.02
"""Distance from a surface at which its light is evaluated."""


def sun_position(scene: RayScene, direction: Floats) -> Floats:
    """(3,) position [m] of a lamp that stands for the sun in a direction (3,)."""
    center, half = _extent(scene)
    return center + unit(direction) * max(60.0, 4.0 * LAMP_DISTANCE * half)


def sunlight(scene: RayScene, hits: RayHits, sun: Floats) -> Floats:
    """(N,) share of full sunlight on surfaces: 0 in the shade or on the far side."""
    light = np.zeros(len(hits.surface))
    pixels = np.flatnonzero(hits.is_surface)
    points, normals = hits.points[pixels], hits.normals[pixels]
    slope = (unit(sun - points) * normals).sum(axis=1)
    facing = slope > 0.0
    pixels, slope = pixels[facing], slope[facing]
    lit = np.ones(len(pixels), bool)
    near = np.flatnonzero(_may_be_shaded(scene, hits, pixels, reach=12.0))
    lit[near] = scene.lit(sun, points[facing][near] + SURFACE_OFFSET_M * normals[facing][near])
    light[pixels] = slope * lit
    return light


def skylight(scene: RayScene, hits: RayHits, size: Size) -> Floats:
    """(H * W,) unobstructed share of the sky that surfaces face, 0 to 1."""
    width, height = size
    rows, columns = np.arange(0, height, 2), np.arange(0, width, 2)
    coarse = np.add.outer(rows * width, columns)
    light = _smoothed(_dome_light(scene, hits, coarse), _PixelSurfaces.of(hits, coarse))
    full = np.empty((height, width))
    for y, x in ((0, 0), (0, 1), (1, 0), (1, 1)):
        pixels = np.add.outer(np.arange(y, height, 2) * width, np.arange(x, width, 2))
        full[y::2, x::2] = _interpolated(light, hits, pixels, coarse, (y, x))
    return full.ravel()


def dome(count: int) -> Floats:
    """(N, 3) directions spread evenly over the upper half sphere."""
    k = np.arange(count) + 0.5
    up, lamp_set = k / count, k * math.pi * (3.0 - math.sqrt(5.0))
    flat = np.sqrt(1.0 - up * up)
    return np.stack([flat * np.cos(lamp_set), flat * np.sin(lamp_set), up], axis=1)


def _dome_light(scene: RayScene, hits: RayHits, coarse: Ints) -> Floats:
    """(h, w) unobstructed share of the sky at pixels `coarse` (h, w), each by one set of lamps."""
    center, half = _extent(scene)
    directions = dome(LAMPS_PER_PIXEL * LAMP_SETS)
    flat = coarse.ravel()
    rows, columns = (np.arange(n) % 2 for n in coarse.shape)
    lamp_set = np.add.outer(2 * rows, columns).ravel()
    near = _may_be_shaded(scene, hits, flat, reach=OPEN_GROUND) & hits.is_surface[flat]
    received, total = np.zeros(len(flat)), np.zeros(len(flat))
    for number, direction in enumerate(directions):
        at = np.flatnonzero(near & (lamp_set == number % LAMP_SETS))
        pixel = flat[at]
        slope = np.maximum((hits.normals[pixel] * direction).sum(axis=1), 0.0)
        facing = np.flatnonzero(slope > 0.0)
        points = hits.points[pixel[facing]] + SURFACE_OFFSET_M * hits.normals[pixel[facing]]
        lit = scene.lit(center + direction * LAMP_DISTANCE * half, points)
        received[at[facing]] += slope[facing] * lit
        total[at] += slope
    open_ = np.where(total > 0.0, received / np.where(total > 0.0, total, 1.0), 1.0)
    return np.where(near, open_, 1.0).reshape(coarse.shape)


@dataclass(frozen=True, slots=True)
class _PixelSurfaces:
    """Surfaces of pixels (h, w), with `normals` and `points` (h, w, 3); `slack` is a distance [m].
    Points nearer than `slack` to the plane of another pixel may belong to the same surface."""

    surface: Ints
    normals: NDArray[np.float32]
    points: NDArray[np.float32]
    slack: NDArray[np.float32]

    @classmethod
    def of(cls, hits: RayHits, pixels: Ints) -> _PixelSurfaces:
        slack = 0.03 + 0.01 * np.minimum(hits.distance[pixels], 1e6)
        normals, points = (v[pixels].astype(np.float32) for v in (hits.normals, hits.points))
        return cls(hits.surface[pixels], normals, points, slack.astype(np.float32))

    def __getitem__(self, pixels: Any) -> _PixelSurfaces:
        return _PixelSurfaces(
            self.surface[pixels], self.normals[pixels], self.points[pixels], self.slack[pixels]
        )

    def same_surface(self, other: _PixelSurfaces) -> NDArray[np.bool_]:
        """(h, w) whether pixels are on the same surface as those of another grid."""
        along = np.einsum("...k,...k->...", self.normals, other.normals)
        off = np.einsum("...k,...k->...", self.points - other.points, self.normals)
        return (self.surface == other.surface) & (along > SAME_COSINE) & (np.abs(off) <= self.slack)


def _smoothed(light: Floats, surfaces: _PixelSurfaces) -> Floats:
    """(h, w) mean over each pixel and its neighbours on the same surface."""
    total, weight = np.zeros_like(light), np.zeros_like(light)
    for dy, dx in product(NEIGHBOURS, NEIGHBOURS):
        rows, columns = _shifted(light.shape[0], dy), _shifted(light.shape[1], dx)
        to, of = zip(rows, columns, strict=True)
        same = surfaces[to].same_surface(surfaces[of])
        total[to] += same * light[of]
        weight[to] += same
    return total / np.maximum(weight, 1.0)


def _shifted(count: int, step: int) -> tuple[slice, slice]:
    """Return the slices of pixels with a neighbour `step` pixels on, and of these neighbours."""
    if step < 0:
        return slice(-step, None), slice(0, count + step)
    return slice(0, count - step), slice(step, None)


def _interpolated(light: Floats, hits: RayHits, pixels: Ints, coarse: Ints, step: Size) -> Floats:
    """Return the light of pixels `step` = (0 or 1, 0 or 1) away from those of the coarse grid. It
    is the mean of the coarse pixels around that are on the same surface."""
    there = _PixelSurfaces.of(hits, pixels)
    rows, columns = (np.arange(n) for n in there.surface.shape)
    total, weight = np.zeros(there.surface.shape), np.zeros(there.surface.shape)
    for dy in range(step[0] + 1):
        for dx in range(step[1] + 1):
            i = np.minimum(rows + dy, coarse.shape[0] - 1)
            j = np.minimum(columns + dx, coarse.shape[1] - 1)
            near = np.ix_(i, j)
            share = there.same_surface(_PixelSurfaces.of(hits, coarse[near])) + 1e-6
            total += share * light[near]
            weight += share
    return total / weight


def _may_be_shaded(scene: RayScene, hits: RayHits, pixels: Ints, reach: float) -> NDArray[np.bool_]:
    """Return which pixels show a solid, or ground nearer to one than `reach` times its height."""
    near = hits.surface[pixels] > GROUND
    x, y = hits.points[pixels, 0], hits.points[pixels, 1]
    for solid in scene.solids:
        low, high = solid.mesh.bounds
        far = reach * float(high[2])
        inside = (x > low[0] - far) & (x < high[0] + far) & (y > low[1] - far) & (y < high[1] + far)
        near |= inside & (hits.surface[pixels] == GROUND)
    return near


def _extent(scene: RayScene) -> tuple[Floats, float]:
    """Return the centre of all solids, and half their largest extent [m]."""
    if not scene.solids:
        return np.array([0.0, 0.0, 1.0]), 3.0
    low = np.min([solid.mesh.bounds[0] for solid in scene.solids], axis=0)
    high = np.max([solid.mesh.bounds[1] for solid in scene.solids], axis=0)
    return (low + high) / 2.0, max(float((high - low).max()) / 2.0, 1.0)
