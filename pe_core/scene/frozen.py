"""Arrays that nobody can change: what was checked stays as it was checked."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray


def frozen_copy(values: ArrayLike, dtype: DTypeLike) -> NDArray[Any]:
    """Return a read-only array of one's own; one that is already read-only and whole is kept."""
    array = np.asarray(values, dtype=dtype)
    if array.flags.writeable or not array.flags.owndata or not array.flags.c_contiguous:
        array = np.array(array, order="C")
    return frozen(array)


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Make an array of one's own read-only, and return it."""
    array.flags.writeable = False
    return array
