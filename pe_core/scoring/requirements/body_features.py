"""Axles and mirrors of a body whose parts have no telling names, found by shape.

Many foreign meshes are one part, or have parts named ``Mesh.003``. All that touches the ground are
tyres; a mirror is a small piece high up that sticks out at both sides.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...base.arrays import Flags, Floats, Ints, read_only
from ...scene.vehicle import Vehicle

CONTACT_M = 0.03
"""Height above the lowest point at which tyres are cut: a tyre of 0.3 m radius is 0.27 m long."""
GAP_M = 0.3
"""Contact patches that are nearer than this along the vehicle are on one axle."""
PATCH_M = 1.0
"""A longer contact patch is no tyre: a body that lies on the ground, or a plane under it."""
SIDE_SHARE = 0.15
"""Tyres are farther than this share of the width from the middle, on both sides."""
MIRROR_M = 1.2
"""Largest side of a mirror with its arm; those of a coach are 1 m long."""
MIRROR_LOW_M = 0.5
"""A mirror is higher above the lowest point than this."""
STICKS_OUT_M = 0.02
TWIN_M = 0.1
"""Largest difference of a mirror and the mirror image of the one on the other side."""
MIN_WIDTH = 0.7
"""Without its mirrors a body has at least this share of its width; else none are found."""
WELD_M = 1e-4
"""Corners on one grid of this size are one: triangles that share it hang together."""
MAX_FACES = 300_000
"""Larger bodies are not searched for mirrors: it would take seconds."""


def axles_of(vehicle: Vehicle) -> tuple[float, float] | None:
    """Return x of the rearmost and the foremost axle [m], by where tyres touch the ground.

    None where what touches the ground are not tyres on both sides of two axles or more.
    """
    triangles = vehicle.triangles
    height = float(triangles[..., 2].min()) + CONTACT_M
    points = parts_below(triangles[triangles[..., 2].min(axis=1) <= height], height)
    low, high = np.nanmin(points, axis=1), np.nanmax(points, axis=1)
    right, left = vehicle.bounds[0][1], vehicle.bounds[1][1]
    off = SIDE_SHARE * (left - right)
    is_left = low[:, 1] - (left + right) / 2.0 > off
    if not (is_left | (high[:, 1] - (left + right) / 2.0 < -off)).all():
        return None
    order = np.argsort(low[:, 0])
    low, high, is_left = low[order, 0], np.maximum.accumulate(high[order, 0]), is_left[order]
    ends = np.flatnonzero(low[1:] - high[:-1] > GAP_M) + 1
    axles = []
    for part in np.split(np.arange(len(low)), ends):
        rear, front = float(low[part[0]]), float(high[part[-1]])
        if front - rear > PATCH_M or is_left[part].all() or not is_left[part].any():
            return None
        axles.append((rear + front) / 2.0)
    return (axles[0], axles[-1]) if len(axles) > 1 else None


@lru_cache(maxsize=4)
def mirror_faces(vehicle: Vehicle) -> Flags:
    """Return which triangles (F,) are mirrors by their shape; none where it is not clear.

    Pieces that hang together are mirrors if they are small and high up, stick out beyond all larger
    pieces, and have a twin on the other side.
    """
    triangles = vehicle.triangles
    none = read_only(np.zeros(len(triangles), bool))
    if len(triangles) > MAX_FACES:
        return none
    piece, count = _pieces(triangles)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, piece, triangles.min(axis=1))
    np.maximum.at(high, piece, triangles.max(axis=1))
    ground = float(low[:, 2].min())
    small = ((high - low).max(axis=1) <= MIRROR_M) & (low[:, 2] > ground + MIRROR_LOW_M)
    if small.all() or not small.any():
        return none
    right, left = float(low[~small, 1].min()), float(high[~small, 1].max())
    if left - right < MIN_WIDTH * float(high[:, 1].max() - low[:, 1].min()):
        return none
    out = small & ((high[:, 1] > left + STICKS_OUT_M) | (low[:, 1] < right - STICKS_OUT_M))
    image_low, image_high = low.copy(), high.copy()
    image_low[:, 1], image_high[:, 1] = left + right - high[:, 1], left + right - low[:, 1]
    found = np.flatnonzero(out)
    away = np.maximum(
        np.abs(low[found, None] - image_low[None, found]).max(axis=2),
        np.abs(high[found, None] - image_high[None, found]).max(axis=2),
    )
    mirrors = np.zeros(count, bool)
    mirrors[found] = (away <= TWIN_M).any(axis=1)
    return read_only(mirrors[piece])


def parts_below(triangles: Floats, height: float) -> Floats:
    """Return points (F, 6, 3) of triangles below a height: corners and cuts of edges, else NaN."""
    a, b = triangles, triangles[:, [1, 2, 0]]
    rise = b[..., 2] - a[..., 2]
    is_cut = (a[..., 2] <= height) != (b[..., 2] <= height)
    share = (height - a[..., 2]) / np.where(is_cut, rise, 1.0)
    cuts = np.where(is_cut[..., None], a + share[..., None] * (b - a), np.nan)
    return np.concatenate([np.where(a[..., 2:] <= height, a, np.nan), cuts], axis=1)


def _pieces(triangles: Floats) -> tuple[Ints, int]:
    """Return the piece (F,) that each triangle is of, and the number of pieces.

    The smallest number of a corner spreads over the piece; paths are halved between two rounds.
    """
    grid = np.round((triangles - triangles.min(axis=(0, 1))) / WELD_M).astype(np.int64)
    keys = (grid[..., 0] << 42) + (grid[..., 1] << 21) + grid[..., 2]
    _, corner = np.unique(keys, return_inverse=True)
    corner = corner.reshape(-1, 3)
    label = np.arange(int(corner.max()) + 1)
    while True:
        smallest = label[corner].min(axis=1)
        spread = label.copy()
        for k in range(3):
            np.minimum.at(spread, corner[:, k], smallest)
            np.minimum.at(spread, label[corner[:, k]], smallest)
        spread = spread[spread]
        if np.array_equal(spread, label):
            break
        label = spread
    _, piece = np.unique(label[corner[:, 0]], return_inverse=True)
    return piece, int(piece.max()) + 1
