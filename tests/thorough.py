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
    """Return combinations of two parameters: by default each value once, in CI twice or more.

    The default is a diagonal: as many combinations as the longer parameter has values. In CI there
    are two, the second a step beside the first.
    """
    rows, columns = list(first), list(second)
    if len(rows) < len(columns):
        return [(row, column) for column, row in pairs(columns, rows)]
    beside = range(min(2, len(columns)) if THOROUGH else 1)
    return [
        (row, columns[(k + step) % len(columns)]) for k, row in enumerate(rows) for step in beside
    ]
