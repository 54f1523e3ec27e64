"""Heat map of occluded beams: hits per area, as tiles on the vehicle's surface."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, cast

import numpy as np

from ..engine import Floats, Ints, graphics

TILE_M = 0.05
DEPTH_M = 0.20
"""Side of a tile, and how thick the layer of space is in which hits are taken together."""
ASIDE = 0.37
"""Offset of the layers, in thicknesses: flat surfaces tend to lie at round heights."""
LIFT_M = 0.004
"""Distance of tiles from the surface, towards the sensor: they would flicker in it."""
OVERLAP = 1.15
"""Tiles are a little larger than their cells: a slanted surface shows no gaps."""
ALPHA = 0.92
MIN_DENSITY = 1.0
MAX_DENSITY = 100.0
"""Ends of the scale, which is logarithmic [beams a dm2]."""
LEGEND = graphics.ColorKey(
    "Occluded beams per dm²",
    scale=tuple(
        (float(red), float(green), float(blue), 1.0)
        for red, green, blue in graphics.on_scale(np.linspace(0.0, 1.0, 13), graphics.VIRIDIS)
    ),
    ticks=("100", "10", "1 beam"),
)


def hit_density(casts: Sequence[graphics.Cast], triangles: Floats) -> graphics.LayerShape:
    """Return tiles on triangles (F, 3, 3) with hits; colours by the hits of all sensors."""
    hits = [each.occluded for each in casts]
    if not any(occluded.any() for occluded in hits):
        return graphics.LayerShape()
    pairs = list(zip(casts, hits, strict=True))
    points = np.concatenate([each.points[occluded] for each, occluded in pairs])
    looks = np.concatenate([each.directions[occluded] for each, occluded in pairs])
    faces = np.concatenate([each.face[occluded] for each, occluded in pairs])
    # A cast represents several beams; all are of kinds that have beams.
    beams = [cast(Any, c.sensor.model).beam_count / max(len(c.ends), 1) for c in casts]
    weight = np.repeat(beams, [occluded.sum() for occluded in hits])
    normals = _normals(triangles[faces])
    away = (normals * looks).sum(axis=1, keepdims=True) > 0.0
    normals = np.where(away, -normals, normals)
    tiles = _Tiles.of(points, normals, weight)
    # Bright is good, as on the ground map: tiles with many hits are dark.
    shares = 1.0 - np.log(np.maximum(tiles.density, MIN_DENSITY) / MIN_DENSITY) / np.log(
        MAX_DENSITY / MIN_DENSITY
    )
    colors = np.concatenate(
        [graphics.on_scale(shares, graphics.VIRIDIS), np.full((len(shares), 1), ALPHA, np.float32)],
        axis=1,
    )
    return graphics.LayerShape(
        faces=graphics.Primitives.of(tiles.corners(), np.repeat(colors, 6, axis=0)), legend=LEGEND
    )


class _Tiles:
    """Pieces of the surface with hits: mean position and normal, and hits per dm2."""

    def __init__(self, points: Floats, normals: Floats, density: Floats) -> None:
        self.points = points
        self.normals = normals
        self.density = density

    @classmethod
    def of(cls, points: Floats, normals: Floats, weight: Floats) -> "_Tiles":
        """Sort hits (N, 3) into squares perpendicular to the axis nearest to the surface's normal.
        `weight` (N,) is the number of beams that each hit represents."""
        axis = np.abs(normals).argmax(axis=1)
        side = np.where(np.arange(3) == axis[:, None], DEPTH_M, TILE_M)
        place = np.column_stack([2 * axis, np.floor(points / side + ASIDE)]).astype(np.int64)
        cells, cell = _Cells.among(place)
        count = np.bincount(cell)
        middle = np.stack([np.bincount(cell, points[:, i]) for i in range(3)], axis=1)
        normal = np.stack([np.bincount(cell, normals[:, i]) for i in range(3)], axis=1)
        unit = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
        # If the surface crosses a square at an angle, its area there is larger than the square's.
        area_dm2 = (TILE_M * 10.0) ** 2 / np.maximum(np.abs(unit).max(axis=1), 0.5)
        beams = np.bincount(cell, weight).astype(float)
        density = cells.with_neighbours(beams) / cells.with_neighbours(area_dm2)
        return cls(middle / count[:, None], unit, density)

    def corners(self) -> Floats:
        """(T, 6, 3) two triangles for each tile, perpendicular to its normal."""
        upright = np.abs(self.normals[:, 2:]) > 0.9
        helper = np.where(upright, [[1.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]])
        across = np.cross(helper, self.normals)
        across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
        along = np.cross(self.normals, across)
        slant = 1.0 / np.maximum(np.abs(self.normals).max(axis=1, keepdims=True), 0.7)
        half = TILE_M * OVERLAP * slant / 2.0
        middle = self.points + self.normals * LIFT_M
        signs = ((-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1))
        return np.stack([middle + half * (a * across + b * along) for a, b in signs], axis=1)


@dataclass(frozen=True, slots=True)
class _Cells:
    """Cells with hits, by ascending `number` (T,); `steps` (4,) to the next cell of an axis."""

    number: Ints
    steps: Ints

    @classmethod
    def among(cls, corners: Ints) -> "tuple[_Cells, Ints]":
        """Return the cells that occur in (N, 4), and the cell (N,) of each row."""
        low = corners.min(axis=0) - 1
        sides = corners.max(axis=0) - low + 2
        steps = np.append(np.cumprod(sides[:0:-1])[::-1], 1)
        number, place = np.unique((corners - low) @ steps, return_inverse=True)
        return cls(number, steps), place.reshape(-1)

    def with_neighbours(self, values: Floats) -> Floats:
        """(T,) sums of values (T,) over each cell and its neighbours with the same axis."""
        total = np.zeros(len(values))
        for step in product((-1, 0, 1), repeat=3):
            wanted = self.number + np.dot(self.steps[1:], step)
            at = np.minimum(np.searchsorted(self.number, wanted), len(self.number) - 1)
            total += np.where(self.number[at] == wanted, values[at], 0.0)
        return total


def _normals(triangles: Floats) -> Floats:
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
