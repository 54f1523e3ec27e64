"""Colours of outputs, sRGB; sensors have theirs from `graphics`, as on the page and in Blender."""

from __future__ import annotations

Rgb = tuple[float, float, float]

BLIND: Rgb = (0.75, 0.12, 0.12)
HIDDEN: Rgb = (0.30, 0.30, 0.30)
BODY: Rgb = (0.72, 0.74, 0.76)
GLASS: Rgb = (0.35, 0.42, 0.48)


def hex_color(color: Rgb) -> str:
    """Return a colour as ``#rrggbb``."""
    return "#" + "".join(f"{round(255 * value):02x}" for value in color)


def linear(color: Rgb) -> list[float]:
    """Return a colour in linear light, as glTF has it (IEC 61966-2-1)."""
    return [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in color]
