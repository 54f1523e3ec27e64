"""The pinhole: straight lines stay straight."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .lens import Lens

Floats = NDArray[np.float64]

ALMOST_A_PLANE = math.radians(89.9)
"""What is farther from the axis falls beyond any picture."""


@dataclass(frozen=True)
class Pinhole(Lens):
    """A camera without distortion, eq. 3: ``radius = tan(theta)``."""

    model: ClassVar[str] = "pinhole"
    widest: ClassVar[float] = ALMOST_A_PLANE

    @property
    def is_straight(self) -> bool:
        """A pinhole is."""
        return self.fov is None

    def radius(self, theta: Floats) -> Floats:
        """Tangent of the angle."""
        return np.asarray(np.tan(theta))

    def slope(self, theta: Floats) -> Floats:
        """One over the squared cosine."""
        return np.asarray(np.cos(theta) ** -2)
