"""The labelled picture of a rig as a PNG file: numbers, figures and the key are in its pixels."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import pe_core as pe
from pe_core.base.arrays import Floats

from ... import graphics, jobs
from ..report_context import MAX_TRIANGLES
from . import vehicle_picture as pictures

SCALE = 5.0 / 3.0
"""Of the picture on the page: 1600 by 900 pixels, and the key below."""
LINE_PX, MARGIN_PX, GAP_PX, SWATCH_PX = 40, 36, 40, 9.0
"""Height of a line, distance to the edge and between entries, and radius of a colour's dot."""
PixelPlace = tuple[float, float]

LETTERS = Path(__file__).with_name("letters.npz")
BASELINE_PX = 25
"""Of a line of text, below the upper edge of its letters; as in `tools/letters.py`."""
UNKNOWN = "\u25a1"
"""Stands for a letter of another script than Latin, Greek and Cyrillic."""
DASH_PX = 7.0
INK: graphics.Rgb = (0.106, 0.122, 0.141)
WHITE: graphics.Rgb = (1.0, 1.0, 1.0)


def picture_file(study: pe.Study, outcome: jobs.Outcome | None = None) -> bytes:
    """Return the picture of a study's rig on its vehicle as PNG, with numbers and their key; above
    it the figures of an outcome."""
    vehicle = study.vehicle
    if vehicle is not None:
        vehicle, _ = graphics.simplified(vehicle, MAX_TRIANGLES)
    size = round(SCALE * pictures.SIZE[0]), round(SCALE * pictures.SIZE[1])
    view = pictures.default_view(vehicle, study.rig, pictures.SIZE)
    picture = pictures.rendered(vehicle, study.rig, size, view)
    key = _key(study.rig, size[0])
    below = np.ones((LINE_PX * (1 + key[-1].line) + MARGIN_PX, size[0], 3))
    drawn = DrawnPixels(np.concatenate([picture, below]))
    for label in pictures.labels(vehicle, study.rig, view):
        _draw_label(drawn, label)
    for entry in key:
        baseline = size[1] + (entry.line + 1) * LINE_PX
        drawn.disc((entry.left + SWATCH_PX, baseline - SWATCH_PX), SWATCH_PX, entry.color)
        drawn.text(entry.text, entry.left + 3 * SWATCH_PX, baseline)
    if outcome is not None:
        for line, text in enumerate(_figures(outcome)):
            drawn.text(text, MARGIN_PX, MARGIN_PX + BASELINE_PX + line * LINE_PX)
    return graphics.png_bytes(graphics.as_bytes(drawn.pixels))


def picture_output(request: Any) -> tuple[dict[str, bytes], list[str]]:
    """Return the picture of an `OutputRequest`, which has no figures, as files by name."""
    return {"picture.png": picture_file(request.study)}, []


def _draw_label(drawn: DrawnPixels, label: pictures.NumberLabel) -> None:
    end, disc = (tuple((SCALE * place).tolist()) for place in (label.end, label.disc))
    drawn.line(disc, end, SCALE * 1.5, dashed=label.is_hidden)
    if label.is_hidden:
        drawn.disc(end, SCALE * 4.0, label.color)
    drawn.disc(disc, SCALE * pictures.RADIUS, label.color)
    text = str(label.number)
    drawn.text(text, disc[0] - text_width(text) / 2.0, disc[1] + BASELINE_PX / 3.0, WHITE)


class KeyEntry(NamedTuple):
    """A line of the key: text, colour, left edge [px], and the number of its line."""

    text: str
    color: graphics.Rgb
    left: int
    line: int


def _key(rig: pe.Rig, width: int) -> list[KeyEntry]:
    """Return the entries of the key, as many to a line as there is room for."""
    colors = graphics.sensor_colors_on_paper(rig)
    entries, left, line = [], MARGIN_PX, 0
    for number, sensor in enumerate(rig, 1):
        text = f"{number} {sensor.name} ({sensor.model.name})"
        room = round(3 * SWATCH_PX) + text_width(text)
        if left > MARGIN_PX and left + room > width - MARGIN_PX:
            left, line = MARGIN_PX, line + 1
        entries.append(KeyEntry(text, colors[sensor.name], left, line))
        left += room + GAP_PX
    return entries


def _figures(outcome: jobs.Outcome) -> list[str]:
    """Return entropy and coverage, of a search before and after; first what it searched for."""
    before, after = outcome.before, outcome.after
    entropy, coverage = f"{after.entropy:.3f}", f"{after.coverage:.1%}"
    if outcome.kind == "optimize":
        entropy = f"{before.entropy:.3f} \N{RIGHTWARDS ARROW} {entropy}"
        coverage = f"{before.coverage:.1%} \N{RIGHTWARDS ARROW} {coverage}"
    lines = [f"Perception entropy {entropy} nats (lower is better)", f"Coverage {coverage}"]
    if outcome.in_traffic is not None:
        ap = " \N{RIGHTWARDS ARROW} ".join(f"{each.ap:.3f}" for each in outcome.in_traffic)
        lines.insert(0, f"Expected AP in traffic {ap} (higher is better)")
    return lines


class DrawnPixels:
    """An sRGB picture (H, W, 3), 0 to 1, to draw into: the top row first. Places are (right, down)
    from the top left [px].
    """

    def __init__(self, pixels: Floats) -> None:
        self.pixels = pixels
        height, width = pixels.shape[:2]
        self._down, self._right = np.mgrid[0:height, 0:width] + 0.5

    def disc(self, center: PixelPlace, radius_px: float, color: graphics.Rgb) -> None:
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

    def text(self, text: str, left: float, baseline: float, color: graphics.Rgb = INK) -> None:
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

    def _blend(self, inside_px: Floats, color: graphics.Rgb) -> None:
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
