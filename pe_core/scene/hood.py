"""Which end of a car has its hood, told from its shape alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .body_shape import BodyShape

Floats = NDArray[np.float64]

BINS, QUARTER = 40, 10
"""Slices along a body, and those of one end."""
LOWER = 0.15
"""A hood is lower than the other end by more than this share of the body's height."""
TRIANGLES, PLACES = 20_000, 1_000_000
"""As many triangles are looked at, and at so many places of them together."""
FEWEST, MOST = 8, 128
"""Places along an edge."""


def hood_end(shape: BodyShape, axis: int, up: int) -> float | None:
    """Tell the end of a car along an axis where its hood is: 1.0 or -1.0; None where it is unclear.

    The outline of a car from the side is lower over its hood than at its rear. What is taller than
    wide is no car: a lorry's load may be lower than its cab.
    """
    other = 3 - axis - up
    size = shape.size
    if not size[up] < size[other] <= size[axis] or not size[up] > 0.0:
        return None
    outline = _outline(shape, axis, up)
    ends = [end[end > 0.0] for end in (outline[:QUARTER], outline[-QUARTER:])]
    if not all(len(end) for end in ends):
        return None
    apart = float(ends[0].mean() - ends[1].mean())
    if abs(apart) <= LOWER:
        return None
    return 1.0 if apart > 0.0 else -1.0


def _outline(shape: BodyShape, axis: int, up: int) -> Floats:
    """Return how high a body is in slices along an axis (BINS,), in shares of its height.

    0 where a slice is empty.
    """
    ours = shape.triangles if shape.is_ours is None else shape.triangles[shape.is_ours]
    ours = ours[:: -(-len(ours) // TRIANGLES)]
    low, high = shape.bounds
    weights = _weights(min(max(int((2.0 * PLACES / len(ours)) ** 0.5), FEWEST), MOST))
    along, height = (((ours[..., k] - low[k]) / (high[k] - low[k])) @ weights.T for k in (axis, up))
    slices = np.clip((along * BINS).astype(np.int64), 0, BINS - 1)
    outline = np.zeros(BINS)
    np.maximum.at(outline, slices.reshape(-1), height.reshape(-1))
    return outline


def _weights(edge: int) -> Floats:
    """Shares of a triangle's corners at places spread over it, so many along an edge; (N, 3)."""
    steps = [(i, j, edge - i - j) for i in range(edge + 1) for j in range(edge + 1 - i)]
    return np.array(steps, dtype=float) / edge
