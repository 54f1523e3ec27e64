"""One unknown of a search: its range, and what it is measured in."""

from __future__ import annotations

from dataclasses import dataclass

from .axes import POSITION_AXES

METRE, RADIAN, SHARE = "m", "rad", "share"


@dataclass(frozen=True, slots=True)
class Unknown:
    """A number that a search may change.

    Parameters
    ----------
    low, high : float
        Its range; both ends belong to it.
    unit : {"m", "rad", "share"}
        A share, from 0 to 1, stands for one of a list, which is taken as a ring.
    """

    low: float
    high: float
    unit: str

    def brought(self, value: float) -> float:
        """Return a value brought into the range."""
        if self.unit == SHARE:
            return value % 1.0
        return min(max(value, self.low), self.high)


def unknown_of(axis: str, bounds: tuple[float, float]) -> Unknown:
    """Return the unknown of a coordinate."""
    return Unknown(*bounds, METRE if axis in POSITION_AXES else RADIAN)
