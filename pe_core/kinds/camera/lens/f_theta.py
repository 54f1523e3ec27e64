"""F-theta: a fisheye told by a polynomial from the angle to pixels, as makers give it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .lens import Lens

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FTheta(Lens):
    """``radius = k1 theta + k2 theta^2 + ... + k6 theta^6`` [px].

    `fx` and `fy` scale it, as a rule by 1.
    """

    model: ClassVar[str] = "f-theta"
    coefficients: ClassVar[tuple[str, ...]] = ("k1", "k2", "k3", "k4", "k5", "k6")

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    k4: float = 0.0
    k5: float = 0.0
    k6: float = 0.0

    def radius(self, theta: Floats) -> Floats:
        """Polynomial of the angle, 0 at 0."""
        return np.asarray(np.polyval([*self._falling, 0.0], theta))

    def slope(self, theta: Floats) -> Floats:
        """Its derivative."""
        falling = [n * k for n, k in zip(range(6, 0, -1), self._falling, strict=True)]
        return np.asarray(np.polyval(falling, theta))

    @property
    def _falling(self) -> list[float]:
        return [getattr(self, key) for key in reversed(self.coefficients)]
