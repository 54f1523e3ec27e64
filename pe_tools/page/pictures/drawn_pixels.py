"""Text, discs and lines drawn into the pixels of a picture: for files without a browser's fonts."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from pe_core.base.arrays import Floats

PixelPlace = tuple[float, float]
Srgb = tuple[float, float, float]

LETTERS = Path(__file__).with_name("letters.npz")
BASELINE_PX = 25
"""Of a line of text, below the upper edge of its letters; as in `tools/letters.py`."""
UNKNOWN = "\u25a1"
"""Stands for a letter of another script than Latin, Greek and Cyrillic."""
DASH_PX = 7.0
INK: Srgb = (0.106, 0.122, 0.141)
WHITE: Srgb = (1.0, 1.0, 1.0)


class DrawnPixels:
    """An sRGB picture to draw into.

    Parameters
    ----------
    pixels : (H, W, 3) float
        0 to 1, the top row first; changed by each drawing. Places are (right, down) from the top
        left [px].
    """

    def __init__(self, pixels: Floats) -> None:
        self.pixels = pixels
        height, width = pixels.shape[:2]
        self._down, self._right = np.mgrid[0:height, 0:width] + 0.5

    def disc(self, center: PixelPlace, radius_px: float, color: Srgb) -> None:
        """Fill a circle with a dark edge."""
        away = np.hypot(self._right - center[0], self._down - center[1])
        self._blend(radius_px - away, INK)
        self._blend(radius_px - 1.5 - away, color)

    def line(
        self, start: PixelPlace, end: PixelPlace, width_px: float, *, dashed: bool = False
    ) -> None:
        """Draw a dark line."""
        first, along = np.array(start), np.array(end) - np.array(start)
        length = max(float(np.hypot(*along)), 1e-9)
        ahead = along / length
        right, down = self._right - first[0], self._down - first[1]
        position = np.clip(right * ahead[0] + down * ahead[1], 0.0, length)
        away = np.hypot(right - position * ahead[0], down - position * ahead[1])
        inside = width_px / 2.0 - away
        self._blend(np.where(position // DASH_PX % 2 == 1, -1.0, inside) if dashed else inside, INK)

    def text(self, text: str, left: float, baseline: float, color: Srgb = INK) -> None:
        """Write one line; it ends at the picture's edge."""
        rows = tile_of(text)
        height, width = self.pixels.shape[:2]
        top, first = round(baseline) - BASELINE_PX, round(left)
        low, high = max(top, 0), min(top + rows.shape[0], height)
        start, end = max(first, 0), min(first + rows.shape[1], width)
        if low >= high or start >= end:
            return
        shown = rows[low - top : high - top, start - first : end - first, None]
        area = self.pixels[low:high, start:end]
        area += shown * (np.array(color) - area)

    def _blend(self, inside_px: Floats, color: Srgb) -> None:
        """Blend a colour in by how far pixels are inside its edge [px]."""
        share = np.clip(inside_px + 0.5, 0.0, 1.0)[..., None]
        self.pixels += share * (np.array(color) - self.pixels)


def tile_of(text: str) -> Floats:
    """Return a line of text as (H, W) shares of ink, 0 to 1."""
    starts, strip = _letters()
    unknown = starts[UNKNOWN]
    columns = [np.arange(*starts.get(letter, unknown)) for letter in text]
    return strip[:, np.concatenate([np.arange(0), *columns])]


def text_width(text: str) -> int:
    """Return how wide a line of text is [px]."""
    return tile_of(text).shape[1]


@cache
def _letters() -> tuple[dict[str, tuple[int, int]], Floats]:
    """Return first and last column of each letter in the strip, and the strip."""
    with np.load(LETTERS) as file:
        codes, starts, strip = file["codes"].tolist(), file["starts"].tolist(), file["strip"]
    columns = pairwise(starts)
    return {chr(code): pair for code, pair in zip(codes, columns, strict=True)}, strip / 255.0
