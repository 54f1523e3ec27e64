"""Conversion between radians in memory and degrees in files, exact to the last bit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

DECIMALS = 9
"""Decimals of degrees in a file, where these give the angle exactly."""
MAX_DECIMALS = 17
NEAR_ULPS = 2
"""Search range round the converted degrees, in units of the last place."""
TO_RADIANS, TO_DEGREES = math.pi / 180.0, 180.0 / math.pi


def degrees_in_file(angle: float) -> float:
    """Return the shortest degrees that `math.radians` turns into this angle [rad].

    About a tenth of all floats is not the `math.radians` of any float: then the degrees that come
    nearest. `as_in_file` rounds an angle to one that a file can hold.
    """
    degrees = math.degrees(angle)
    for decimals in range(DECIMALS, MAX_DECIMALS + 1):
        rounded = round(degrees, decimals) + 0.0
        if math.radians(rounded) == angle:
            return rounded
    neighbours, low, high = [degrees], degrees, degrees
    for _ in range(NEAR_ULPS):
        low, high = math.nextafter(low, -math.inf), math.nextafter(high, math.inf)
        neighbours += [low, high]
    return min(neighbours, key=lambda near: abs(math.radians(near) - angle))


def as_in_file(angle: float) -> float:
    """Return an angle [rad] as it comes back from a file, at most one unit in the last place off.

    An angle that was converted from degrees is returned unchanged.
    """
    if math.radians(round(math.degrees(angle), DECIMALS)) == angle:
        return angle + 0.0  # no negative zero, which would be written out
    return math.radians(degrees_in_file(angle))


def all_as_in_file(angles: Floats) -> Floats:
    """Return an array of angles [rad] as they come back from a file; see `as_in_file`."""
    exact = np.round(angles * TO_DEGREES, DECIMALS) * TO_RADIANS == angles
    rounded = angles + 0.0
    rounded[~exact] = [as_in_file(a) for a in angles[~exact].tolist()]
    return rounded
