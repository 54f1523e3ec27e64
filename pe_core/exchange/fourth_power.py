"""A fourth radial coefficient, which nuImages has for fisheyes: as a quotient of polynomials.

The devkit (nutonomy/nuscenes-devkit@4393318, nuimages/utils/lidar.py) multiplies a point's place by
``1 + k1 r^2 + k2 r^4 + k3 r^6 + k4 r^8``, r its distance from the axis in focal lengths, up to
r^2 = 10. OpenCV's model has no r^8, but a denominator.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..kinds.camera import BrownConrady
from .pictures import Picture

Floats = NDArray[np.float64]

LAST_SQUARE = 10.0
"""r^2 up to which the devkit applies it."""
PLACES = 2000
NOTICED_PX = 0.1


def with_fourth(
    picture: Picture, radial: tuple[float, float, float, float], tangential: tuple[float, float]
) -> tuple[Picture, str]:
    """Return a pinhole's picture bent so, and how far it is off where that can be noticed.

    Parameters
    ----------
    picture : Picture
        A pinhole; without a size it ends as far behind its principal point as before.
    radial : (4,) float
        k1 to k4.
    tangential : (2,) float
        p1, p2.
    """
    lens = picture.lens
    square = _squares(math.hypot(lens.cx / lens.fx, lens.cy / lens.fy), radial)
    wanted = _factor(square, radial)
    top, bottom = _quotient(square, wanted)
    found = (1.0 + _power_sum(square, top)) / (1.0 + _power_sum(square, bottom))
    off = float(np.abs((found - wanted) * np.sqrt(square)).max()) * max(lens.fx, lens.fy)
    values = *top[:2], *tangential, top[2], *bottom
    bent = BrownConrady(lens.fx, lens.fy, lens.cx, lens.cy, None, *map(float, values))
    told = f"its sixth coefficient is taken in to within {off:.1f} px"
    return Picture(bent, picture.size), told if off > NOTICED_PX else ""


def _squares(corner: float, radial: tuple[float, ...]) -> Floats:
    """Return r^2 from the axis to the corner of the picture, or as far as places move outward."""
    square = np.linspace(0.0, LAST_SQUARE, PLACES + 1)[1:]
    reached = np.sqrt(square) * _factor(square, radial)
    grows = np.diff(reached, prepend=0.0) > 0.0
    inside = grows & (reached <= corner)
    count = len(square) if inside.all() else max(int(np.argmin(inside)), 1)
    return np.linspace(0.0, float(square[min(count, len(square) - 1)]), PLACES + 1)[1:]


def _factor(square: Floats, radial: tuple[float, ...]) -> Floats:
    return 1.0 + _power_sum(square, radial)


def _power_sum(square: Floats, values: tuple[float, ...] | Floats) -> Floats:
    """Return the sum of values times square, its square, and so on."""
    return np.asarray(sum(value * square**n for n, value in enumerate(values, 1)))


def _quotient(square: Floats, wanted: Floats) -> tuple[Floats, Floats]:
    """Return three coefficients above and three below, by least squares on wanted * below."""
    last = float(square[-1])
    powers = np.stack([(square / last) ** n for n in (1, 2, 3)], axis=1)
    system = np.hstack([powers, -wanted[:, None] * powers])
    found = np.linalg.lstsq(system, wanted - 1.0, rcond=None)[0]
    scale = np.array([last, last**2, last**3])
    return found[:3] / scale, found[3:] / scale
