"""Sizes that no vehicle has, and the factor that would make a mesh one.

From a table-top robot (TurtleBot3: 0.19 m) over a walking one (ANYmal: 0.9 m) and a bi-articulated
bus (30 m) to a road train (53.5 m); the widest, a mining truck, is 10 m wide and 15 m long.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import LONGEST_FOUND, InputError
from .body_shape import BodyShape, corner_bounds

SMALLEST_M, LARGEST_M, WIDEST_M = 0.1, 60.0, 25.0
"""The longest side of a vehicle is from the first to the second, the next one up to the last."""
CAR_M = 4.5
"""Length of a usual car: what a size is compared with."""
TOLD_UNITS = 2
"""Of the units in which a mesh would be a vehicle, how many are told."""
USUAL_M = (0.4, 30.0)
USUAL_SECOND_M = 10.0
"""What the longest and the second longest side of most vehicles are within."""
SMALLER_UNITS = {"inches": 0.0254, "centimetres": 0.01, "millimetres": 0.001, "feet": 0.3048}
LARGER_UNITS = {"units of 100 m": 100.0, "kilometres": 1000.0}


class Meshed(Protocol):
    """What has triangles of named parts: a vehicle, or a mesh."""

    @property
    def triangles(self) -> NDArray[np.float64]: ...
    @property
    def parts(self) -> NDArray[np.int32]: ...
    @property
    def part_names(self) -> Sequence[str]: ...


def require_vehicle_size(source: str, body: Meshed) -> None:
    """Refuse a body that is larger or smaller than any vehicle; a floor under it does not count.

    Raises
    ------
    InputError
        One line with its size, and the factor that would make it a vehicle.
    """
    low, high = corner_bounds(body.triangles)
    if _is_possible((high - low).tolist()):
        return
    size = BodyShape(body.triangles, body.parts, body.part_names).size
    if not _is_possible(size):
        longest = f"a vehicle, {SMALLEST_M:g} to {LARGEST_M:g} m long"
        wide = f" and up to {WIDEST_M:g} m wide" if max(size) <= LARGEST_M else ""
        told = (f"{size_words(size)}; {_hint(size, units)}" for units in range(TOLD_UNITS, 0, -1))
        found = next((each for each in told if len(each) <= LONGEST_FOUND), "")
        raise InputError(source, "size", f"{longest}{wide}", found or size_words(size))


def fitting_units(longest: float, second: float) -> list[tuple[str, float]]:
    """Return units in which a body of these sides would be as large as vehicles usually are.

    With the metres of each; first that in which it is nearest to a car.
    """
    units = SMALLER_UNITS if longest > USUAL_M[0] else LARGER_UNITS
    fitting = [(n, f) for n, f in units.items() if is_usual(f * longest, f * second)]
    return sorted(fitting, key=lambda unit: abs(math.log(unit[1] * longest / CAR_M)))


def is_usual(longest: float, second: float) -> bool:
    """Whether these are the two longest sides [m] of a vehicle of usual size."""
    return USUAL_M[0] <= longest <= USUAL_M[1] and second <= USUAL_SECOND_M


def car_factor(longest: float) -> float:
    """Return what would make a body as long as a car, in two digits."""
    return float(f"{CAR_M / longest:.2g}")


def size_words(size: tuple[float, ...]) -> str:
    """Return "4.70 x 1.85 x 1.45 m"; small and large ones with fewer digits."""
    longest = max(size)
    digits = 2 if 0.995 <= longest < 99.5 else 0 if longest >= 99.5 else 3
    return f"{' x '.join(f'{side:.{digits}f}' for side in size)} m"


def _is_possible(size: tuple[float, ...]) -> bool:
    _, second, longest = sorted(size)
    return SMALLEST_M <= longest <= LARGEST_M and second <= WIDEST_M


def _hint(size: tuple[float, ...], most: int) -> str:
    _, second, longest = sorted(size)
    if longest == 0.0:
        return "all of it is one point"
    units = fitting_units(longest, second)[:most]
    if not units:
        return f"scale = {car_factor(longest):g} makes it as long as a car"
    told = (f"{factor:g} if {name} ({factor * longest:.2f} m)" for name, factor in units)
    return f"scale = {', '.join(told)}"
