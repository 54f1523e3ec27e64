"""Decimal numbers as a user typed them, from properties that store single precision."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def as_typed(value: float) -> float:
    """Return the shortest decimal number that a property of single precision stands for."""
    return float(str(np.float32(value)))


def pair_as_typed(values: Sequence[float]) -> tuple[float, float]:
    """Return the shortest decimal numbers of a pair of values."""
    low, high = map(as_typed, values)
    return low, high
