"""Icons of gains and losses, for panels and tables: labels of Blender have no colours."""

from __future__ import annotations

import bpy
import bpy.utils.previews
import numpy as np

from .readout_text import BETTER, WORSE

SIDE_PX, RADIUS_PX = 32, 9
SENSES = {BETTER: (0.42, 0.75, 1.0), WORSE: (1.0, 0.62, 0.25)}
"""Blue is better, orange worse: told apart by colour-blind eyes, too. Each has a shape, too."""

_icons: list[bpy.utils.previews.ImagePreviewCollection] = []


def sense_icon(sense: int) -> int:
    """Return the icon of a gain or a loss; 0, no icon, for neither."""
    return _icons[0][str(sense)].icon_id if sense in SENSES else 0


def pixels(color: tuple[float, float, float], is_disc: bool) -> np.ndarray:
    """Return a disc, or a triangle that points down, (SIDE_PX * SIDE_PX * 4,)."""
    up, right = np.mgrid[:SIDE_PX, :SIDE_PX] - (SIDE_PX - 1) / 2.0
    inside = np.hypot(up, right) <= RADIUS_PX
    if not is_disc:
        inside = (np.abs(right) <= (up + RADIUS_PX) / 1.7) & (up <= RADIUS_PX)
    image = np.zeros((SIDE_PX, SIDE_PX, 4), np.float32)
    image[inside] = (*color, 1.0)
    return image.reshape(-1)


def register() -> None:
    """Create the icons of a gain and of a loss."""
    icons = bpy.utils.previews.new()
    for sense, color in SENSES.items():
        made = icons.new(str(sense))
        made.icon_size = made.image_size = (SIDE_PX, SIDE_PX)
        image = pixels(color, sense == BETTER)
        made.icon_pixels_float = made.image_pixels_float = image  # type: ignore[assignment]
    _icons.append(icons)


def unregister() -> None:
    """Remove the icons."""
    while _icons:
        bpy.utils.previews.remove(_icons.pop())
