"""The labelled picture of a rig as a PNG file: numbers, figures and the key are in its pixels."""

from __future__ import annotations

from typing import Any

import numpy as np

import pe_core as pe

from ... import graphics
from ..report_context import MAX_TRIANGLES
from . import vehicle_picture as pictures
from .drawn_pixels import BASELINE_PX, WHITE, DrawnPixels, text_width

SCALE = 5.0 / 3.0
"""Of the picture on the page: 1600 by 900 pixels, and the key below."""
LINE_PX, MARGIN_PX, GAP_PX, SWATCH_PX = 40, 36, 40, 9.0
"""Height of a line, distance to the edge and between entries, and radius of a colour's dot."""


def picture_file(study: pe.Study, outcome: pe.Outcome | None = None) -> bytes:
    """Return the picture of a study's rig on its vehicle as PNG, with numbers and their key.

    Parameters
    ----------
    study : Study
    outcome : Outcome, optional
        Its figures are written above the picture.
    """
    vehicle = study.vehicle
    if vehicle is not None:
        vehicle, _ = graphics.simplified(vehicle, MAX_TRIANGLES)
    size = round(SCALE * pictures.SIZE[0]), round(SCALE * pictures.SIZE[1])
    view = pictures.default_view(vehicle, study.rig, pictures.SIZE)
    picture = pictures.rendered(vehicle, study.rig, size, view)
    places = _places_of_key(study.rig, size[0])
    below = np.ones((LINE_PX * (1 + places[-1][1]) + MARGIN_PX, size[0], 3))
    drawn = DrawnPixels(np.concatenate([picture, below]))
    for label in pictures.labels(vehicle, study.rig, view):
        _draw_label(drawn, label)
    _write_key(drawn, study.rig, places, size[1])
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


def _entry(number: int, sensor: pe.Sensor) -> str:
    return f"{number} {sensor.name} ({sensor.model.name})"


def _places_of_key(rig: pe.Rig, width: int) -> list[tuple[int, int]]:
    """Return the left edge [px] and the line of each entry of the key."""
    places, left, line = [], MARGIN_PX, 0
    for number, sensor in enumerate(rig, 1):
        room = round(3 * SWATCH_PX) + text_width(_entry(number, sensor))
        if left > MARGIN_PX and left + room > width - MARGIN_PX:
            left, line = MARGIN_PX, line + 1
        places.append((left, line))
        left += room + GAP_PX
    return places


def _write_key(drawn: DrawnPixels, rig: pe.Rig, places: list[tuple[int, int]], top: int) -> None:
    colors = graphics.sensor_colors_on_paper(rig)
    for number, (sensor, (left, line)) in enumerate(zip(rig, places, strict=True), 1):
        baseline = top + (line + 1) * LINE_PX
        drawn.disc((left + SWATCH_PX, baseline - SWATCH_PX), SWATCH_PX, colors[sensor.name])
        drawn.text(_entry(number, sensor), left + 3 * SWATCH_PX, baseline)


def _figures(outcome: pe.Outcome) -> list[str]:
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
