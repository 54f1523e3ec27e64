"""Colours of what is seen: paint under a sun and a sky, and the ground with its lines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .normals import unit
from .tableau import GROUND, NOTHING, SKY, Met

Floats = NDArray[np.float64]
Rgb = tuple[float, float, float]

SUN, UPPER, LOWER = np.array([1.16, 1.11, 1.04]), np.array([0.50, 0.54, 0.60]), np.array([0.30] * 3)
"""Linear light of the sun, of the sky above and of the ground below."""
MIRRORED = 0.07
"""Share that paint mirrors when looked at straight on (Schlick's formula)."""
GLOSS = 220.0
KNEE = 0.75
"""From here on light is pressed together, so that it comes near to white and no farther."""
OUTSIDE = (0.11, 0.115, 0.125)
"""Where a lens shows nothing; sRGB."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What is round the solids.

    Attributes
    ----------
    ground : callable
        Points (N, 3) of the ground and how wide a pixel is there (N,) [m] to linear colours (N, 3).
    sky : callable
        Directions (N, 3) to linear colours (N, 3).
    sun : (3,) float
        Where the sun is, a direction.
    haze : callable
        Points (N, 3) of the ground to how far (N,) they have faded into the sky, 0 to 1.
    """

    ground: Callable[[Floats, Floats], Floats]
    sky: Callable[[Floats], Floats]
    sun: Floats
    haze: Callable[[Floats], Floats]


def shaded(
    seen: Met, directions: Floats, setting: Surroundings, sun: Floats, sky: Floats, pixel_rad: float
) -> Floats:
    """(N, 3) sRGB of what rays see, in sunlight and skylight (N,) each."""
    color = np.zeros((len(seen.what), 3))
    color[seen.what == SKY] = setting.sky(directions[seen.what == SKY])
    at = np.flatnonzero(seen.what == GROUND)
    color[at] = _ground(seen, at, directions, setting, sun, sky, pixel_rad)
    at = np.flatnonzero(seen.is_solid)
    color[at] = _paint(seen, at, directions, setting, sun, sky)
    srgb = to_srgb(color)
    srgb[seen.what == NOTHING] = OUTSIDE
    return srgb


def to_srgb(linear: Floats) -> Floats:
    """SRGB of linear light; what is brighter than white comes near it softly."""
    room, over = 1.0 - KNEE, np.maximum(linear - KNEE, 0.0)
    soft = np.where(over > 0.0, KNEE + room * (1.0 - np.exp(-over / room)), linear)
    soft = np.clip(soft, 0.0, 1.0)
    return np.where(soft <= 0.0031308, 12.92 * soft, 1.055 * soft ** (1.0 / 2.4) - 0.055)


def from_srgb(color: Floats) -> Floats:
    """Linear light of sRGB."""
    c = np.asarray(color, float)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def _ground(
    seen: Met,
    at: NDArray,
    directions: Floats,
    setting: Surroundings,
    sun: Floats,
    sky: Floats,
    pixel_rad: float,
) -> Floats:
    """Ground: its colour as it is in full light, darker by what light is missing."""
    points = seen.points[at]
    slope = np.maximum(-directions[at, 2], 1e-3)
    own = setting.ground(points, seen.distance[at] * pixel_rad / slope)
    full = float(unit(setting.sun)[2])
    shade = 0.52 * np.clip(sun[at] / full, 0.0, 1.0) + 0.48 * sky[at]
    faded = setting.haze(points)[:, None]
    return own * shade[:, None] * (1.0 - faded) + setting.sky(directions[at]) * faded


def _paint(
    seen: Met, at: NDArray, directions: Floats, setting: Surroundings, sun: Floats, sky: Floats
) -> Floats:
    """Paint: what it scatters, and what it mirrors of the sky and the sun."""
    normals, rays = seen.normals[at], directions[at]
    own, shine = seen.color[at, :3], seen.color[at, 3]
    up = (0.5 + 0.5 * normals[:, 2])[:, None]
    around = (LOWER * (1.0 - up) + UPPER * up) * sky[at][:, None]
    scattered = own * (around + SUN * sun[at][:, None])
    along = np.clip(-(rays * normals).sum(axis=1), 0.0, 1.0)
    mirrored = MIRRORED + (1.0 - MIRRORED) * (1.0 - along) ** 5
    back = rays + 2.0 * along[:, None] * normals
    bright = _surroundings(back[:, 2]) * (0.35 + 0.65 * sky[at])
    glint = np.maximum((back * unit(setting.sun)).sum(axis=1), 0.0) ** GLOSS
    glint = np.where(sun[at] > 0.0, 1.6 * glint, 0.0)
    return scattered + ((mirrored * bright + glint * 0.5) * shine)[:, None] * UPPER / UPPER[1]


def _surroundings(up: Floats) -> Floats:
    """(N,) light that comes from directions that rise by `up`: a bright horizon, dark ground."""
    sky = 1.0 - 0.45 * np.clip(up, 0.0, 1.0)
    ground = 0.22 + 0.5 * np.exp(5.0 * np.minimum(up, 0.0))
    part = np.clip(up / 0.06 + 0.5, 0.0, 1.0)
    return ground * (1.0 - part) + sky * part
