"""Marks in the plane of the picture: where each sensor is, its name, and where it started."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics
from .lettering import FAINT_INK, Lettering

if TYPE_CHECKING:
    from ..engine import pe

Floats = NDArray[np.float64]

GHOST: graphics.Rgba = (0.30, 0.32, 0.35, 1.0)
WHITE: graphics.Rgba = (1.0, 1.0, 1.0, 1.0)
NAME, NAME_RISE, NAME_STEP, NAME_PADDING = 18, 46, 28, 8
LETTER_WIDTH = 0.47
"""Mean width of a letter, in its size."""
RING_ROOM = 10
RING_NAME = 15
RING_AZIMUTHS_DEG = (-35.0, 105.0, -60.0, 130.0, -90.0, 160.0, -115.0, 170.0, -150.0)
"""Where a ring's distance may be written: the first of these inside the picture."""


def mark_sensors(pen: Lettering, rig: pe.Rig, moves: list[tuple[Floats, Floats]]) -> None:
    """Put a dot on each sensor and its name above it, clear of other names and of the rings."""
    scale = pen.view.frame.scale
    places = pen.view.pixels(np.array([sensor.pose.position for sensor in rig]))
    taken = [_room_of_ring(pen, start) for start, _ in moves]
    for (x, y), sensor in sorted(zip(places.tolist(), rig, strict=True), key=lambda pair: pair[0]):
        color = graphics.drawing_of(sensor.kind).color(graphics.PAPER)
        pen.disc((x, y), 7.5 * scale, WHITE, layer=3)
        pen.disc((x, y), 5.5 * scale, (*color[:3], 1.0), layer=4)
        half = scale * (NAME * LETTER_WIDTH * len(sensor.name) / 2 + NAME_PADDING)
        base = y - scale * NAME_RISE
        while any(abs(x - a) < half + b and abs(base - c) < scale * NAME_STEP for a, b, c in taken):
            base -= scale * 4
        taken.append((x, half, base))
        pen.line((x, base), (x, y), scale * 1.4, FAINT_INK, layer=1)
        pen.rectangle(x - half, base - scale * 19, x + half, base + scale * 8, WHITE, layer=2)
        pen.write(sensor.name, (x, base), scale * NAME, align="CENTER")


def _room_of_ring(pen: Lettering, start: Floats) -> tuple[float, float, float]:
    """Middle, half width and base line [px] of the room that the ring at a start takes."""
    x, y = pen.view.pixels(start[None])[0].tolist()
    return x, RING_ROOM * pen.view.frame.scale, y + RING_ROOM / 2 * pen.view.frame.scale


def mark_moves(pen: Lettering, moves: list[tuple[Floats, Floats]]) -> None:
    """Put a ring where each sensor started (3,) [m], with a line to where it stands now (3,)."""
    scale = pen.view.frame.scale
    for start, end in moves:
        first, last = pen.view.pixels(np.array([start, end])).tolist()
        pen.line(first, last, scale * 4.0, WHITE, layer=1)
        pen.line(first, last, scale * 2.0, GHOST, layer=2)
        pen.ring(first, scale * 6.5, GHOST, layer=3)


def mark_rings(pen: Lettering, radii_m: tuple[float, ...], color: graphics.Rgba) -> None:
    """Write a ring's distance where it can be read."""
    frame, scale = pen.view.frame, pen.view.frame.scale
    for radius in radii_m:
        for azimuth in np.radians(RING_AZIMUTHS_DEG):
            point = radius * np.array([[np.cos(azimuth), np.sin(azimuth), 0.0]])
            x, y = pen.view.pixels(point)[0].tolist()
            if frame.left < x < frame.right and frame.top < y < frame.bottom - 20 * scale:
                pen.write(f"{radius:g} m", (x, y + 18 * scale), scale * RING_NAME, color, "CENTER")
                break
