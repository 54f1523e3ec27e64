"""DriveWorks' lenses: a pinhole, or an f-theta's polynomial, either way round.

``angle-to-pixeldistance`` is ours; ``pixeldistance-to-angle`` (also ``bw-poly``) is turned round,
by a polynomial of the sixth power through it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import shown
from ..kinds.camera import FTheta
from ..text.tables import Table
from ..text.values import FINITE, Number
from .figures import COEFFICIENT, FOCAL, PIXELS, PLACE, figure, figures, whole_figure
from .files import plain_number, spaced
from .pictures import Picture, pinhole_picture

Floats = NDArray[np.float64]

PINHOLE, F_THETA = "pinhole", "ftheta"
FOCAL_KEYS, MIDDLE, SIZE = ("fx", "fy"), ("cx", "cy"), ("width", "height")
POLYNOMIALS = ("polynomial", "bw-poly")
FORWARD, BACKWARD = "angle-to-pixeldistance", "pixeldistance-to-angle"
MOST = 6
"""Coefficients of a polynomial there, from the constant on."""
PLACES = 2000
"""Radii at which a polynomial is turned round."""
NOTICED_PX = 0.1
TURNED = "its polynomial from pixels to angles is turned round to within {:.1f} px"
GENTLEST = 1e-9
"""Radians a pixel, or pixels a radian: less is no lens."""
GENTLE = 1.0
"""Without a word on its direction: a polynomial that begins less steeply gives angles."""


def write_properties(picture: Picture) -> dict[str, str]:
    """Return a picture's properties, which are texts there."""
    width, height = picture.size or (0, 0)
    cx, cy = picture.center
    common = {"width": str(width), "height": str(height)}
    common |= {"cx": plain_number(cx), "cy": plain_number(cy)}
    lens = picture.lens
    if not isinstance(lens, FTheta):
        focal = {"fx": plain_number(picture.fx), "fy": plain_number(picture.fy)}
        return {"Model": PINHOLE, **common, **focal}
    rising = [0.0, *(lens.fx * getattr(lens, key) for key in lens.coefficients)]
    line = {"linear-c": "1.0", "linear-d": "0.0", "linear-e": "0.0"}
    words = {"polynomial": spaced(rising[:MOST]), "polynomial-type": FORWARD}
    return {"Model": F_THETA, **common, **words, **line}


def read_properties(properties: Table) -> tuple[Picture | None, str]:
    """Return a camera's picture, and what has to be known of it, if anything.

    Another model's, or half a one, is left to be chosen.
    """
    if not all(key in properties for key in (*MIDDLE, *SIZE)):
        return None, ""
    cx, cy = (_number(properties, key, PLACE) for key in MIDDLE)
    width, height = size = _pixels(properties, SIZE[0]), _pixels(properties, SIZE[1])
    key = next((each for each in POLYNOMIALS if each in properties), None)
    if key is not None:
        rising = _rising(properties, key)
        reach = math.hypot(max(cx, width - cx), max(cy, height - cy))
        _check_square(properties)
        told, found = "", rising
        if not _is_forward(properties, key, rising):
            found, off = _turned_round(rising, reach)
            told = TURNED.format(off) if off > NOTICED_PX else ""
        return Picture(FTheta(1.0, 1.0, cx, cy, None, *found[1:]), size), told
    if not all(key in properties for key in FOCAL_KEYS):
        return None, ""
    fx, fy = (_number(properties, each, FOCAL) for each in FOCAL_KEYS)
    return pinhole_picture(fx, fy, cx, cy, size), ""


def _is_forward(properties: Table, key: str, rising: list[float]) -> bool:
    way = properties.text("polynomial-type", "", choices=("", FORWARD, BACKWARD))
    if way:
        return way == FORWARD
    return key == POLYNOMIALS[0] and rising[1] >= GENTLE


def _rising(properties: Table, key: str) -> list[float]:
    """Return coefficients from the constant on; the constant is 0."""
    value = properties.raw(key)
    expected = f"2 to {MOST + 1} numbers, the first of them 0 and the second above 0"
    if not isinstance(value, str) or not 2 <= len(value.split()) <= MOST + 1:
        raise properties.error(key, expected, shown(value))
    found = figures(properties.source, properties.field(key), value, None, COEFFICIENT)
    if found[0] != 0.0 or found[1] < GENTLEST:
        raise properties.error(key, expected, shown(value))
    return found


def _check_square(properties: Table) -> None:
    """Complain about pixels that are sheared or stretched: the lens has one polynomial for both."""
    for key, plain in (("linear-c", 1.0), ("linear-d", 0.0), ("linear-e", 0.0)):
        if key in properties and abs(_number(properties, key) - plain) > 0.01:
            found = _number(properties, key)
            raise properties.error(key, f"{plain:g}, within 0.01", f"{found:g}")


def _turned_round(rising: list[float], reach: float) -> tuple[list[float], float]:
    """Return the polynomial from angles to radii of one from radii to angles, and its error [px].

    Radii from 0 to `reach` [px].
    """
    radius = np.linspace(0.0, reach, PLACES + 1)[1:]
    theta = np.polyval(rising[::-1], radius)
    grows = np.diff(theta, prepend=0.0) > 0.0
    upto = len(radius) if grows.all() else int(np.argmin(grows))
    theta, radius = theta[:upto], radius[:upto]
    scale = theta[-1] if upto else 1.0
    powers = np.stack([(theta / scale) ** n for n in range(1, MOST + 1)], axis=1)
    found = np.linalg.lstsq(powers, radius, rcond=None)[0]
    off = float(np.abs(powers @ found - radius).max()) if upto else 0.0
    return [0.0, *(float(v) / scale**n for n, v in enumerate(found, start=1))], off


def _number(properties: Table, key: str, rule: Number = FINITE) -> float:
    return figure(properties.source, properties.field(key), properties.raw(key), rule)


def _pixels(properties: Table, key: str) -> int:
    return whole_figure(properties.source, properties.field(key), properties.raw(key), PIXELS)
