"""Colours of all graphics: palettes and colour scales.

The colours of beams and cameras differ for any kind of colour vision (Okabe and
Ito, "Color Universal Design", 2008). Scales rise evenly in lightness: cividis, which looks much the
same to all eyes (Nunez, Anderton and Renslow, PLoS ONE 13(7), 2018, table of its supplement), and
viridis (van der Walt and Smith, 2015; CC0), each at thirteen even places. Values are sRGB, most of
them with alpha.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rgb = tuple[float, float, float]
Rgba = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours for one kind of background.

    `free` and `occluded` are a LiDAR's beams, `camera` a frustum's lines, `camera_face` its sides;
    `other` are lines of kinds that have no colour of their own; `blind` is ground that nobody sees,
    `reach` the rig's reach; `words` are labels.
    """

    free: Rgba
    occluded: Rgba
    camera: Rgba
    camera_face: Rgba
    other: Rgba
    blind: Rgba = (0.90, 0.32, 0.18, 0.95)
    reach: Rgba = (0.97, 0.97, 0.97, 0.95)
    words: Rgba = (0.95, 0.95, 0.95, 1.0)


VIEWPORT = Palette(
    free=(0.45, 0.78, 0.96, 0.28),
    occluded=(0.98, 0.52, 0.10, 0.60),
    camera=(0.90, 0.62, 0.78, 0.80),
    camera_face=(0.80, 0.47, 0.65, 0.07),
    other=(0.20, 0.80, 0.62, 0.85),
)
"""For the viewport's dark grey."""

PAPER = Palette(
    free=(0.0, 0.45, 0.70, 0.60),
    occluded=(0.84, 0.37, 0.0, 1.0),
    camera=(0.60, 0.25, 0.45, 0.9),
    camera_face=(0.80, 0.47, 0.65, 0.14),
    other=(0.0, 0.50, 0.37, 0.9),
)
"""For a light page."""

CIVIDIS = (
    *((0.0, 0.135, 0.305), (0.0, 0.191, 0.441), (0.165, 0.248, 0.429), (0.264, 0.308, 0.423)),
    *((0.342, 0.365, 0.429), (0.415, 0.423, 0.445), (0.489, 0.485, 0.471), (0.567, 0.547, 0.47)),
    *((0.648, 0.611, 0.455), (0.736, 0.681, 0.424), (0.824, 0.751, 0.377), (0.914, 0.826, 0.304)),
    (0.996, 0.909, 0.218),
)
VIRIDIS = (
    *((0.267, 0.005, 0.329), (0.283, 0.121, 0.441), (0.268, 0.224, 0.512), (0.23, 0.322, 0.546)),
    *((0.191, 0.407, 0.556), (0.158, 0.486, 0.558), (0.128, 0.567, 0.551), (0.126, 0.644, 0.525)),
    *((0.208, 0.719, 0.473), (0.369, 0.789, 0.383), (0.565, 0.842, 0.263), (0.783, 0.879, 0.125)),
    (0.993, 0.906, 0.144),
)
COUNTS = ((0.12, 0.13, 0.20), (0.24, 0.36, 0.62), (0.28, 0.66, 0.66), (0.95, 0.89, 0.45))
"""Nobody, one, two, three or more: each clearly lighter than the one before."""

BETTER, SAME, WORSE = (0.0, 0.36, 0.62), (0.955, 0.955, 0.945), (0.70, 0.31, 0.0)
"""Blue, white and orange: differences, told apart by all eyes."""
DIFFERENCE = (WORSE, SAME, BETTER)
"""From worse over alike to better, on a light page."""
DIFFERENCE_ON_DARK = ((0.96, 0.55, 0.16), (0.62, 0.62, 0.62), (0.28, 0.62, 0.98))
"""The same hues for the viewport's dark grey."""

Scale = tuple[tuple[float, float, float], ...]


def on_scale(shares: ArrayLike, scale: Scale) -> NDArray[np.float32]:
    """Return colours (..., 3) for shares (...) of a scale: 0 is its low end, 1 its high end."""
    table = np.array(scale, np.float32)
    place = np.clip(np.asarray(shares, float), 0.0, 1.0) * (len(table) - 1)
    below = np.minimum(place.astype(np.int64), len(table) - 2)
    part = (place - below)[..., None].astype(np.float32)
    return table[below] * (1.0 - part) + table[below + 1] * part


def linear_of_srgb(rgb: NDArray[Any]) -> NDArray[Any]:
    """Return linear light of sRGB values, 0 to 1 (IEC 61966-2-1)."""
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def srgb_of_linear(light: NDArray[Any]) -> NDArray[Any]:
    """Return sRGB values of linear light, 0 to 1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1.0 / 2.4) - 0.055)


def linear(colors: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return sRGB colours (..., 4) as linear light; alpha stays."""
    return np.concatenate([linear_of_srgb(colors[..., :3]), colors[..., 3:]], axis=-1)


def with_alpha(color: tuple[float, ...], alpha: float) -> Rgba:
    """Return a colour with another alpha."""
    return (color[0], color[1], color[2], alpha)
