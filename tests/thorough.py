"""How many cases a test tries: a few where a developer waits, all of them where CI runs.

A case that is left out by default differs from those that are kept by its number alone (a seed, one
more combination of two parameters); whatever is a subject of its own is always tried.
"""

import os
from collections.abc import Iterable

THOROUGH = os.environ.get("CI") == "true"


def tries(by_default: int, in_ci: int) -> int:
    """Return how many random cases are tried."""
    return in_ci if THOROUGH else by_default


def pairs(first: Iterable, second: Iterable) -> list[tuple]:
    """Return combinations of two parameters: all in CI, by default each value at least once.

    The default is a diagonal: as many combinations as the longer parameter has values.
    """
    rows, columns = list(first), list(second)
    if THOROUGH:
        return [(row, column) for row in rows for column in columns]
    count = max(len(rows), len(columns))
    return [(rows[k % len(rows)], columns[k % len(columns)]) for k in range(count)]
