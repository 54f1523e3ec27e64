"""Index arrays: ranges counted up side by side, and ranges cut into blocks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.arrays import Ints


def count_up(counts: Ints) -> Ints:
    """Return ``0 .. c0 - 1, 0 .. c1 - 1, ...`` in one array."""
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    return np.arange(total) - np.repeat(ends - counts, counts)


def stable_order(keys: Ints) -> Ints:
    """Return the stable order of keys in 0 .. 2^32 - 1; NumPy's radix sort wants 16-bit keys."""
    order = np.argsort(keys.astype(np.uint16), kind="stable")
    return order[np.argsort((keys >> 16).astype(np.uint16)[order], kind="stable")]


def blocks(total: int, size: int) -> Iterator[slice]:
    """Yield slices of at most `size` that cover ``range(total)``: blocks that fit the cache."""
    for start in range(0, total, size):
        yield slice(start, min(start + size, total))
