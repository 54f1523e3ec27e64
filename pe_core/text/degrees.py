"""Radians in Python, degrees in files: the two told so that a file gives back the same bits."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

DECIMALS = 9
"""Degrees are written with this many decimals where these say the angle exactly."""
MOST_DECIMALS = 17
NEAR_ULPS = 2
"""A file's degrees are no farther than this from those of the angle, in units of the last place."""
TO_RADIANS, TO_DEGREES = math.pi / 180.0, 180.0 / math.pi


def degrees_in_file(angle: float) -> float:
    """Return the shortest degrees that are read as this angle [rad], or as the nearest there is.

    About a tenth of all floats is the `math.radians` of no float; `as_in_file` gives those that
    are.
    """
    degrees = math.degrees(angle)
    for decimals in range(DECIMALS, MOST_DECIMALS + 1):
        rounded = round(degrees, decimals) + 0.0
        if math.radians(rounded) == angle:
            return rounded
    return min(_around(degrees), key=lambda near: abs(math.radians(near) - angle))


def as_in_file(angle: float) -> float:
    """Return an angle [rad] as a file holds it: itself, or at most one unit in the last place off.

    Angles that come from degrees are never changed.
    """
    if math.radians(round(math.degrees(angle), DECIMALS)) == angle:
        return angle + 0.0  # no negative zero, which would be written out
    return math.radians(degrees_in_file(angle))


def all_as_in_file(angles: Floats) -> Floats:
    """Return many angles [rad] as a file holds them."""
    exact = np.round(angles * TO_DEGREES, DECIMALS) * TO_RADIANS == angles
    held = angles + 0.0
    held[~exact] = [as_in_file(a) for a in angles[~exact].tolist()]
    return held


def _around(degrees: float) -> list[float]:
    """Return a float and its neighbours, itself first."""
    near, low, high = [degrees], degrees, degrees
    for _ in range(NEAR_ULPS):
        low, high = math.nextafter(low, -math.inf), math.nextafter(high, math.inf)
        near += [low, high]
    return near
