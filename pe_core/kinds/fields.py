"""Numbers of a sensor's table."""

from __future__ import annotations

from ..errors import InputError


def number(name: str, key: str, value: object) -> float:
    """Return a number of the table of the sensor `name`, or raise `InputError`."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(name, key, "a number", repr(value))
    return float(value)
