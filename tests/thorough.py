"""How many cases a test tries: a few in `make test`, all of them in `make test-all`.

A case that is left out by default differs from those that are kept by its number alone (a seed, one
more combination of two parameters). What is a subject of its own and takes long, or needs a program
that nothing else needs, has the mark `thorough`. docs/testing.md says which, and why.
"""

import os
from collections.abc import Iterable

THOROUGH = os.environ.get("PE_THOROUGH") == "1"


def tries(by_default: int, thorough: int) -> int:
    """Return how many random cases are tried."""
    return thorough if THOROUGH else by_default


def pairs(first: Iterable, second: Iterable) -> list[tuple]:
    """Return combinations of two parameters: by default each value once, else twice or more.

    The default is a diagonal: as many combinations as the longer parameter has values. Thorough
    tests take two, the second a step beside the first.
    """
    rows = list(first)
    columns = list(second)
    if len(rows) < len(columns):
        return [(row, column) for column, row in pairs(columns, rows)]
    beside = range(min(2, len(columns)) if THOROUGH else 1)
    return [
        (row, columns[(k + step) % len(columns)]) for k, row in enumerate(rows) for step in beside
    ]
