"""Numbers as they were typed: Blender keeps the nearest ones in single precision."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def as_typed(value: float) -> float:
    """Return the number that was typed."""
    return float(str(np.float32(value)))


def pair_as_typed(values: Sequence[float]) -> tuple[float, float]:
    """Return two numbers as they were typed."""
    low, high = map(as_typed, values)
    return low, high
