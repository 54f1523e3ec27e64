"""Colours of all graphics: palettes, scales, and a tint for each sensor.

The colours of beams and cameras differ for any kind of colour vision (Okabe and
Ito, "Color Universal Design", 2008). Scales rise evenly in lightness: cividis, which looks much the
same to all eyes (Nunez, Anderton and Renslow, PLoS ONE 13(7), 2018, table of its supplement), and
viridis (van der Walt and Smith, 2015; CC0), each at thirteen even places. Values are sRGB, most of
them with alpha.

Sensors have a hue for each kind and a tint each, kept with the sensor. Tints are for the viewport's
dark grey; a light page draws them darker. Eleven of one kind, and most mixes of eleven, are told
apart by all eyes, those without one kind of cone included (Machado, Oliveira and Fernandes, IEEE
TVCG 15(6), 2009); none is near the colours of occluded beams and of blind ground. A search for the
largest smallest distance in CIE Lab chose them.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pe_core.base.arrays import Floats
from pe_core.scene import PLACE_NAMES, Sensor

Rgb = tuple[float, float, float]
Rgba = tuple[float, float, float, float]
CIVIDIS = (
    (0.0, 0.135, 0.305),
    (0.0, 0.191, 0.441),
    (0.165, 0.248, 0.429),
    (0.264, 0.308, 0.423),
    (0.342, 0.365, 0.429),
    (0.415, 0.423, 0.445),
    (0.489, 0.485, 0.471),
    (0.567, 0.547, 0.47),
    (0.648, 0.611, 0.455),
    (0.736, 0.681, 0.424),
    (0.824, 0.751, 0.377),
    (0.914, 0.826, 0.304),
    (0.996, 0.909, 0.218),
)
VIRIDIS = (
    (0.267, 0.005, 0.329),
    (0.283, 0.121, 0.441),
    (0.268, 0.224, 0.512),
    (0.23, 0.322, 0.546),
    (0.191, 0.407, 0.556),
    (0.158, 0.486, 0.558),
    (0.128, 0.567, 0.551),
    (0.126, 0.644, 0.525),
    (0.208, 0.719, 0.473),
    (0.369, 0.789, 0.383),
    (0.565, 0.842, 0.263),
    (0.783, 0.879, 0.125),
    (0.993, 0.906, 0.144),
)
COUNTS = ((0.12, 0.13, 0.20), (0.24, 0.36, 0.62), (0.28, 0.66, 0.66), (0.95, 0.89, 0.45))
"""Nobody, one, two, three or more: each clearly lighter than the one before."""
BETTER = (0.0, 0.36, 0.62)
SAME = (0.955, 0.955, 0.945)
WORSE = (0.70, 0.31, 0.0)
"""Blue, white and orange: differences, told apart by all eyes."""
DIFFERENCE = (WORSE, SAME, BETTER)  # From worse over alike to better, on a light page
DIFFERENCE_ON_DARK = ((0.96, 0.55, 0.16), (0.62, 0.62, 0.62), (0.28, 0.62, 0.98))
"""The same hues for the viewport's dark grey."""
Scale = tuple[tuple[float, float, float], ...]
TINTS = {
    "lidar": (
        "#5fb8f7",
        "#578a94",
        "#75f3fd",
        "#758ae9",
        "#72a7ab",
        "#acc0e0",
        "#92cffe",
        "#8d93b3",
        "#98a8c7",
        "#899cfe",
        "#567bee",
    ),
    "camera": (
        "#e58ac8",
        "#aa6afd",
        "#af65c6",
        "#eeb4c8",
        "#b1787a",
        "#9178aa",
        "#bf6590",
        "#f8caeb",
        "#a699e4",
        "#bf9396",
        "#cd8aa8",
    ),
    "radar": (
        "#33cc8f",
        "#caf4e1",
        "#87a85e",
        "#98e2b4",
        "#7efc7c",
        "#b9dd9d",
        "#97c3b4",
        "#b0fccd",
        "#55a140",
        "#9ed2ce",
        "#b5e6db",
    ),
}
"""Tints by kind, in the order in which sensors get them: blue, pink, green."""
OTHER_TINTS = (
    "#88a64a",
    "#e5edbc",
    "#beb792",
    "#808a68",
    "#f5eaa6",
    "#d3b34d",
    "#9c9e71",
    "#a5b878",
    "#d3d4ae",
    "#d3f58a",
    "#dccc94",
)  # Yellow: tints of ultrasonic sensors and of kinds without a hue of their own
FACE_SHARE = 0.6
XYZ_OF_RGB = np.array(
    [(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)]
)
WHITE = np.array([0.9505, 1.0, 1.089])  # sRGB's primaries and white, D65 (IEC 61966-2-1)
LIGHT = (54.5, 93.0)
DARK = (16.0, 59.0)
"""Range of the tints' lightness L* on a dark ground, and on a light one."""
LESS = 0.95
STEPS = 60
"""Chroma is reduced by this factor until the colour can be shown; at most so often."""


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours for one kind of background. `free` and `occluded` are a LiDAR's beams, `camera` a
    frustum's lines, `camera_face` its sides; `other` are lines of kinds that have no colour of
    their own; `blind` is ground that nobody sees, `reach` the rig's reach; `words` are labels."""

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
)  # For the viewport's dark grey


PAPER = Palette(
    free=(0.0, 0.45, 0.70, 0.60),
    occluded=(0.84, 0.37, 0.0, 1.0),
    camera=(0.60, 0.25, 0.45, 0.9),
    camera_face=(0.80, 0.47, 0.65, 0.14),
    other=(0.0, 0.50, 0.37, 0.9),
)  # For a light page


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


def tints_of(kind: str) -> tuple[str, ...]:
    """Return the tints of a kind of sensor, the first ones farthest apart."""
    return TINTS.get(kind, OTHER_TINTS)


def free_tint(kind: str, taken: Iterable[str]) -> str:
    """Return the tint for a new sensor of a kind: the first that is taken least often."""
    counts = list(taken)
    return min(tints_of(kind), key=counts.count)


def place_tints(sensors: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return tints of sensors (name, kind) that are named by their places.

    A place has the same tint of a kind in every rig, unless another sensor of the rig has it.
    """
    tints: dict[str, str] = {}
    for name, kind in sensors:
        number = next((k for k, place in enumerate(PLACE_NAMES) if name.endswith(f" {place}")), 0)
        tint = tints_of(kind)[number % len(tints_of(kind))]
        tints[name] = free_tint(kind, tints.values()) if tint in tints.values() else tint
    return tints


def is_foreign_tint(kind: str, color: str) -> bool:
    """Whether a colour is a tint of another kind."""
    every = {tint for tints in (*TINTS.values(), OTHER_TINTS) for tint in tints}
    return color in every and color not in tints_of(kind)


def rgb_of(color: str) -> Rgb:
    """Return the sRGB values of a colour such as "#5fb8f7", 0 to 1."""
    red, green, blue = (int(color[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    return red, green, blue


def color_text(color: Sequence[float]) -> str:
    """Return sRGB values, 0 to 1, as the text of a colour; an alpha is left out."""
    return "#" + "".join(f"{round(255.0 * min(max(v, 0.0), 1.0)):02x}" for v in color[:3])


def sensor_colors(sensors: Iterable[Sensor]) -> dict[str, Rgb]:
    """Return the colour of each sensor of a rig by name, for a dark background. Sensors without a
    colour of their own get the tints of their kind that no other sensor has."""
    rig = list(sensors)
    colors = {sensor.name: sensor.color for sensor in rig if sensor.color is not None}
    for sensor in rig:
        if sensor.color is None:
            colors[sensor.name] = free_tint(sensor.kind, colors.values())
    return {sensor.name: rgb_of(colors[sensor.name]) for sensor in rig}


def sensor_colors_on_paper(sensors: Iterable[Sensor]) -> dict[str, Rgb]:
    """Return the colour of each sensor of a rig by name, for a light background."""
    return {name: on_paper(color) for name, color in sensor_colors(sensors).items()}


def sensor_palette(color: Rgb, palette: Palette = VIEWPORT) -> Palette:
    """Return a palette in which all lines of one sensor have that sensor's colour. Opacities stay
    those of the palette, but for sides of views: sensors' colours are light, and `FACE_SHARE` of
    them hides as much. `occluded`, `blind` and the rig's own colours are kept."""
    hues = {
        name: with_alpha(color, getattr(palette, name)[3]) for name in ("free", "camera", "other")
    }
    face = with_alpha(color, palette.camera_face[3] * FACE_SHARE)
    return replace(palette, **hues, camera_face=face)


def on_paper(color: Rgb) -> Rgb:
    """Return the darker shade of a colour for a light background: the same hue, CIE Lab."""
    lightness, *chroma = lab_of(color).tolist()
    share = (min(max(lightness, LIGHT[0]), LIGHT[1]) - LIGHT[0]) / (LIGHT[1] - LIGHT[0])
    lightness = DARK[0] + share * (DARK[1] - DARK[0])
    for step in range(STEPS):
        linear = _linear_of_lab([lightness, *(LESS**step * each for each in chroma)])
        if ((linear >= -1e-4) & (linear <= 1.0 + 1e-4)).all():
            break
    red, green, blue = srgb_of_linear(np.clip(linear, 0.0, 1.0)).tolist()
    return red, green, blue


def lab_of(color: ArrayLike) -> Floats:
    """Return the CIE Lab values (3,) of an sRGB colour (3,)."""
    xyz = XYZ_OF_RGB @ linear_of_srgb(np.asarray(color, float)) / WHITE
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16.0 / 116.0)
    return np.array([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])


def _linear_of_lab(lab: ArrayLike) -> Floats:
    """Return linear sRGB (3,) of CIE Lab (3,); beyond 0 to 1 where it cannot be shown."""
    lightness, a, b = np.asarray(lab, float)
    y = (lightness + 16.0) / 116.0
    f = np.array([y + a / 500.0, y, y - b / 200.0])
    xyz = np.where(f**3 > 0.008856, f**3, (f - 16.0 / 116.0) / 7.787) * WHITE
    return np.asarray(np.linalg.solve(XYZ_OF_RGB, xyz))
