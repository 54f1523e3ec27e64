"""Minimum and maximum range, for every kind alike."""

from __future__ import annotations

from ..errors import InputError
from ..text.values import Number

NEAREST = 0.0
"""Minimum range of a sensor that has none [m]."""
MIN_RANGE = Number(0.0, cap=1e5, unit="m", noun="length")


def checked_ranges(name: str, least: float, most: float, rule: Number) -> tuple[float, float]:
    """Return minimum and maximum range [m], the maximum by its rule, the minimum below it.

    Raises
    ------
    InputError
        When one is impossible, or the minimum is not below the maximum.
    """
    farthest = rule.checked(name, "max_range", most)
    nearest = MIN_RANGE.checked(name, "min_range", least) + 0.0
    if not nearest < farthest:
        expected = f"a length below max_range, {farthest:g} m"
        raise InputError(name, "min_range", expected, f"{nearest:g}")
    return nearest, farthest
