"""Sensors' colours as icons: a swatch in a list has the colour of the lines in the view."""

from __future__ import annotations

import bpy.utils.previews
import numpy as np

from ..operators import SENSOR_COLORS

SIDE_PX, MARGIN_PX = 32, 5

_icons: list[bpy.utils.previews.ImagePreviewCollection] = []


def swatch(number: int) -> int:
    """Return the icon of a sensor by its place in the list of all sensors."""
    return _icons[0][str(number % len(SENSOR_COLORS))].icon_id


def pixels(color: tuple[float, float, float]) -> np.ndarray:
    """(SIDE_PX * SIDE_PX * 4,) a filled square with a clear margin."""
    image = np.zeros((SIDE_PX, SIDE_PX, 4), np.float32)
    inner = slice(MARGIN_PX, SIDE_PX - MARGIN_PX)
    image[inner, inner] = (*color, 1.0)
    return image.reshape(-1)


def register() -> None:
    """Make an icon of each colour."""
    icons = bpy.utils.previews.new()
    for number, color in enumerate(SENSOR_COLORS):
        made = icons.new(str(number))
        made.icon_size = made.image_size = (SIDE_PX, SIDE_PX)
        made.icon_pixels_float = made.image_pixels_float = pixels(color)
    _icons.append(icons)


def unregister() -> None:
    """Leave no icon behind."""
    while _icons:
        bpy.utils.previews.remove(_icons.pop())
