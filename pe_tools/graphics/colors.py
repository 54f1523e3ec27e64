"""Colours of all graphics: palettes, colours of sensors, and colour scales.

The colours of beams, cameras and sensors differ for any kind of colour vision (Okabe and
Ito, "Color Universal Design", 2008). Scales rise evenly in lightness: cividis, which looks much the
same to all eyes (Nunez, Anderton and Renslow, PLoS ONE 13(7), 2018, table of its supplement), and
viridis (van der Walt and Smith, 2015; CC0), each at thirteen even places. Values are sRGB, most of
them with alpha.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rgb = tuple[float, float, float]
Rgba = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours for one kind of background.

    `free` and `stopped` are a LiDAR's beams, `camera` a frustum's lines, `camera_face` its sides;
    `other` are lines of kinds that have no colour of their own; `blind` is ground that nobody sees,
    `reach` the rig's reach; `words` are labels.
    """

    free: Rgba
    stopped: Rgba
    camera: Rgba
    camera_face: Rgba
    other: Rgba
    blind: Rgba = (0.90, 0.32, 0.18, 0.95)
    reach: Rgba = (0.97, 0.97, 0.97, 0.95)
    words: Rgba = (0.95, 0.95, 0.95, 1.0)


VIEWPORT = Palette(
    free=(0.45, 0.78, 0.96, 0.28),
    stopped=(0.98, 0.52, 0.10, 0.60),
    camera=(0.90, 0.62, 0.78, 0.80),
    camera_face=(0.80, 0.47, 0.65, 0.07),
    other=(0.20, 0.80, 0.62, 0.85),
)
"""For the viewport's dark grey."""

PAPER = Palette(
    free=(0.0, 0.45, 0.70, 0.60),
    stopped=(0.84, 0.37, 0.0, 1.0),
    camera=(0.60, 0.25, 0.45, 0.9),
    camera_face=(0.80, 0.47, 0.65, 0.14),
    other=(0.0, 0.50, 0.37, 0.9),
)
"""For a light page."""

SENSOR_COLORS: tuple[Rgb, ...] = (
    (0.63, 0.77, 0.99),
    (0.70, 0.42, 0.66),
    (0.06, 0.70, 0.37),
    (0.62, 0.38, 1.0),
    (0.94, 1.0, 0.0),
    (0.56, 1.0, 1.0),
    (0.71, 0.70, 0.68),
)
"""One a sensor, in the order of a rig, again from the first when they are more: for a dark ground.

Blue, purple, green, violet, yellow, ice, grey. Any two, and each and what is `stopped`, are far
apart in CIE Lab to all eyes, those without one kind of cone included (Machado, Oliveira and
Fernandes, IEEE TVCG 15(6), 2009): a test measures it.
"""

SENSOR_COLORS_ON_PAPER: tuple[Rgb, ...] = (
    (0.01, 0.17, 0.44),
    (0.44, 0.02, 0.19),
    (0.09, 0.63, 0.35),
    (0.46, 0.19, 0.85),
    (0.44, 0.34, 0.12),
    (0.12, 0.41, 0.59),
    (0.56, 0.55, 0.55),
)
"""The same hues for a light ground, as far apart."""

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


def linear(colors: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return sRGB colours (..., 4) as linear light; alpha stays (IEC 61966-2-1)."""
    rgb = colors[..., :3]
    low, high = rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4
    return np.concatenate([np.where(rgb <= 0.04045, low, high), colors[..., 3:]], axis=-1)


def with_alpha(color: tuple[float, ...], alpha: float) -> Rgba:
    """Return a colour with another alpha."""
    return (color[0], color[1], color[2], alpha)


def sensor_color(number: int) -> Rgb:
    """Return the colour of a sensor by its position in the rig, for a dark background."""
    return SENSOR_COLORS[number % len(SENSOR_COLORS)]


def sensor_color_on_paper(number: int) -> Rgb:
    """Return the colour of a sensor by its position in the rig, for a light background."""
    return SENSOR_COLORS_ON_PAPER[number % len(SENSOR_COLORS_ON_PAPER)]


FACE_SHARE = 0.6


def sensor_palette(number: int, palette: Palette = VIEWPORT) -> Palette:
    """Return a palette in which all lines of one sensor have that sensor's colour.

    Opacities stay those of the palette, but for sides of views: sensors' colours are light, and
    `FACE_SHARE` of them hides as much. `stopped`, `blind` and the rig's own colours are kept.
    """
    color = sensor_color(number)
    hues = {
        name: with_alpha(color, getattr(palette, name)[3]) for name in ("free", "camera", "other")
    }
    face = with_alpha(color, palette.camera_face[3] * FACE_SHARE)
    return replace(palette, **hues, camera_face=face)
