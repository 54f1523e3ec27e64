"""Colours of outputs, sRGB: told apart with any kind of colour vision.

Okabe and Ito, "Color Universal Design", 2008, in the order in which sensors take them.
"""

from __future__ import annotations

Rgb = tuple[float, float, float]

SENSORS: tuple[Rgb, ...] = (
    (0.0, 0.45, 0.70),
    (0.90, 0.62, 0.0),
    (0.0, 0.62, 0.45),
    (0.80, 0.47, 0.65),
    (0.34, 0.71, 0.91),
    (0.84, 0.37, 0.0),
    (0.75, 0.70, 0.15),
)
BLIND: Rgb = (0.75, 0.12, 0.12)
HIDDEN: Rgb = (0.30, 0.30, 0.30)
BODY: Rgb = (0.72, 0.74, 0.76)
GLASS: Rgb = (0.35, 0.42, 0.48)


def sensor_color(number: int) -> Rgb:
    """Return the colour of a rig's sensor by its place in the rig."""
    return SENSORS[number % len(SENSORS)]


def hex_color(color: Rgb) -> str:
    """Return a colour as ``#rrggbb``."""
    return "#" + "".join(f"{round(255 * value):02x}" for value in color)


def linear(color: Rgb) -> list[float]:
    """Return a colour in linear light, as glTF has it (IEC 61966-2-1)."""
    return [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in color]
