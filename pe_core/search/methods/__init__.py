"""Methods of search by name. What one is: `method`; to add one, write its module and its row."""

from __future__ import annotations

from ...text.values import choice
from . import random_search
from .method import Given, Method, Question

METHODS: dict[str, Method] = {
    "random": Method(
        "Random",
        "Algorithm 1 of the paper: random search in a shrinking neighbourhood",
        random_search.ask,
    ),
}
DEFAULT_METHOD = "random"


def checked_method(source: str, name: object) -> str:
    """Return the name of a method, or raise `InputError`."""
    return choice(source, "method", name, tuple(METHODS))


__all__ = ["DEFAULT_METHOD", "METHODS", "Given", "Method", "Question", "checked_method"]
