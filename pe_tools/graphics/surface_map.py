"""A body coloured by values that are known at places of its surface."""

import numpy as np

from pe_core.base.arrays import Flags, Floats, Singles
from pe_core.geometry.surfaces import area_of, divided

from .colors import VIRIDIS, Scale, on_scale
from .primitives import Primitives

FINE_M = 0.09
MAX_TRIANGLES = 40_000
"""Longest edge of the triangles that are coloured [m], unless they would be more than so many."""
AT_ONCE = 4096
FORBIDDEN = (0.46, 0.46, 0.46)
ALPHA = 0.94
SHADE = 0.30
"""Opacity, and how much darker a face is that is turned away from the light."""
LIGHT = np.array([0.35, 0.25, 0.90])
REACH = 0.55  # Width of the bell by which a place counts, in distances between places
ASIDE = 0.05  # Share by which a place counts that is on the other side of a panel


def colored_surface(
    triangles: Floats,
    points: Floats,
    normals: Floats,
    values: Floats,
    bounds: tuple[float, float],
    scale: Scale = VIRIDIS,
) -> Primitives:
    """Return triangles (F, 3, 3) in the colours of values at places, finely divided. Places are
    `points` (N, 3) [m] with unit `normals` (N, 3) and `values` (N,), NaN where none is allowed:
    grey. `bounds` are the values of the low and the high end of the scale. Colours run into each
    other over the distance between places."""
    longest = max(FINE_M, 2.0 * float(np.sqrt(area_of(triangles) / MAX_TRIANGLES)))
    fine = divided(triangles, longest)
    corners, place = np.unique(np.round(fine.reshape(-1, 3), 4), axis=0, return_inverse=True)
    place = place.reshape(-1)
    across = np.cross(fine[:, 1] - fine[:, 0], fine[:, 2] - fine[:, 0])
    sums = [np.bincount(place, np.repeat(across[:, k], 3), len(corners)) for k in range(3)]
    sizes = np.sqrt(sum(each**2 for each in sums))
    normal = np.stack(sums, axis=1) / np.maximum(sizes, 1e-12)[:, None]
    spacing = float(np.sqrt(np.linalg.norm(across, axis=1).sum() / 2.0 / len(points)))
    known = [np.asarray(each, np.float32) for each in (points, normals, values)]
    shares = np.empty(len(corners))
    grey = np.empty(len(corners), bool)
    for start in range(0, len(corners), AT_ONCE):
        part = slice(start, start + AT_ONCE)
        mean, grey[part] = _spread(
            np.asarray(corners[part], np.float32),
            np.asarray(normal[part], np.float32),
            known[0],
            known[1],
            values=known[2],
            spacing=spacing,
        )
        shares[part] = (mean - bounds[0]) / (bounds[1] - bounds[0])
    colors = np.empty((len(corners), 4), np.float32)
    colors[:, :3] = np.where(grey[:, None], FORBIDDEN, on_scale(shares, scale))
    lit = np.abs((normal * LIGHT).sum(axis=1, keepdims=True))
    colors[:, :3] *= 1.0 - SHADE * (1.0 - np.minimum(lit, 1.0))
    colors[:, 3] = ALPHA
    return Primitives.of(fine, colors[place])


def _spread(
    at: Singles, normal: Singles, points: Singles, normals: Singles, values: Singles, spacing: float
) -> tuple[Singles, Flags]:
    """Return mean values (V,) at corners, and whether most of what is near is forbidden (V,)."""
    square = (at**2).sum(axis=1)[:, None] + (points**2).sum(axis=1) - 2.0 * (at @ points.T)
    square -= square.min(axis=1, keepdims=True)  # the nearest counts 1, however far it is
    weight = np.exp(square * np.float32(-0.5 / (REACH * spacing) ** 2))
    weight *= np.maximum(normal @ normals.T, np.float32(ASIDE))
    known = np.isfinite(values)
    allowed = weight @ known.astype(np.float32)
    mean = weight @ np.where(known, values, np.float32(0.0)) / np.maximum(allowed, 1e-12)
    return mean, allowed < 0.5 * weight.sum(axis=1)
