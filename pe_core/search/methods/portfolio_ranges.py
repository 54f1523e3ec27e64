"""Vectors of design variables as points of the unit cube, for models of all sensors at once."""

from __future__ import annotations

import numpy as np

from ...base.arrays import Floats
from ..design_variable import SHARE
from ..parametrization import Vector
from .method import Given


class UnitRanges:
    """The variables that have a range, each scaled by it; slots and fixed variables stay.

    Parameters
    ----------
    given : Given

    Attributes
    ----------
    free : list of int
        The numbers of these variables.
    """

    def __init__(self, given: Given) -> None:
        variables = given.parametrization.variables
        each = list(enumerate(variables))
        self.free = [k for k, v in each if v.low < v.high and v.unit != SHARE]
        self._low = np.array([variables[k].low for k in self.free])
        self._range = np.array([variables[k].high for k in self.free]) - self._low

    def point(self, vector: Vector) -> Floats:
        """Return the point (N,) of a vector."""
        return np.asarray((np.array([vector[k] for k in self.free]) - self._low) / self._range)

    def vector(self, base: Vector, point: Floats) -> list[float]:
        """Return the vector at a point (N,), the other variables as in the base."""
        vector = list(base)
        for k, value in zip(self.free, self._low + point * self._range, strict=True):
            vector[k] = float(value)
        return vector
