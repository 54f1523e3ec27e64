"""What is drawn in which colour.

Blue, vermillion, purple and green are told apart with any kind of colour vision (Okabe and Ito,
"Color Universal Design", 2008). Values are sRGB with alpha.
"""

from __future__ import annotations

from dataclasses import dataclass

Rgba = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours for one kind of background.

    `free` and `stopped` are a LiDAR's beams, `camera` a frustum's lines, `camera_face` its sides;
    `other` are lines of kinds that have no colour of their own.
    """

    free: Rgba
    stopped: Rgba
    camera: Rgba
    camera_face: Rgba
    other: Rgba


VIEWPORT = Palette(
    free=(0.34, 0.71, 0.91, 0.28),
    stopped=(0.95, 0.42, 0.05, 0.40),
    camera=(0.87, 0.58, 0.74, 0.85),
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
