"""The ground maps as pictures that lie on the ground, with what their colours say."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..engine import graphics, pe
from .packing import css, packed

STEP_M = 1.0
MOST_PLACES = 40_000
"""Of a map: a space of hundreds of metres has larger ones."""
SHOWN = {
    graphics.ENTROPY: "Entropy",
    graphics.COVERAGE: "Coverage",
    graphics.SENSORS: "Seen by",
}


def maps_data(sight: pe.Sight, rig: pe.Rig) -> list[dict[str, Any]]:
    """Return the maps of a rig, averaged over height as a score does."""
    (x0, x1), (y0, y1) = sight.space.x, sight.space.y
    step = max(STEP_M, float(np.sqrt((x1 - x0) * (y1 - y0) / MOST_PLACES)))
    seen = sight.ground(rig, step=step)
    return [_map(graphics.ground_map(seen, name, 1.0), name, SHOWN[name]) for name in SHOWN]


def _map(shape: graphics.LayerShape, name: str, label: str) -> dict[str, Any]:
    sheet, legend = shape.sheet, shape.legend
    assert sheet is not None and legend is not None
    rows, columns = sheet.image.shape[:2]
    return {
        "name": name.lower(),
        "label": label,
        "size": [columns, rows],
        "low": list(sheet.low),
        "high": list(sheet.high),
        "colors": packed(np.rint(sheet.image * 255.0), "u1"),
        "legend": {
            "title": legend.title,
            "scale": [css(color) for color in legend.scale],
            "ticks": list(legend.ticks),
            "classes": [[css(color), words] for color, words in legend.classes],
        },
    }
