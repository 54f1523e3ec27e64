"""CMA-ES over all unknowns at once."""

from __future__ import annotations

from .evolution import Evolution
from .method import Asking, Given
from .phase import Phase

FINEST = 0.003
"""The search ends when it is narrower than this: 3 mm and 0.1 deg."""
EACH = 200
"""Placements for each unknown where no budget is given."""


def ask(given: Given) -> Asking:
    """Ask generation by generation, until the search is narrow or the budget is spent."""
    count = len(given.coding.unknowns)
    evolution = Evolution(given, range(count), given.start, [given.seed])
    total, done, number = given.evaluations or EACH * count, 0, 0
    while done < total and evolution.spread > FINEST:
        tried = yield from evolution.asks(given.start, Phase(number, total))
        done, number = done + len(tried) or total, number + 1
