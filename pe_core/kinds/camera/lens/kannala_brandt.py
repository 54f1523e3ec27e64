"""Kannala and Brandt's fisheye, as OpenCV's `fisheye` and ROS's "equidistant" write it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .lens import Lens

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class KannalaBrandt(Lens):
    """``radius = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)``."""

    model: ClassVar[str] = "kannala-brandt"
    coefficients: ClassVar[tuple[str, ...]] = ("k1", "k2", "k3", "k4")

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    k4: float = 0.0

    def radius(self, theta: Floats) -> Floats:
        """Odd polynomial of the angle."""
        s = theta * theta
        return np.asarray(
            theta * (1.0 + s * (self.k1 + s * (self.k2 + s * (self.k3 + s * self.k4))))
        )

    def slope(self, theta: Floats) -> Floats:
        """Its derivative."""
        s = theta * theta
        k = 3.0 * self.k1, 5.0 * self.k2, 7.0 * self.k3, 9.0 * self.k4
        return np.asarray(1.0 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3]))))
