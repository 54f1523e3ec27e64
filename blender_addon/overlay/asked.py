"""The place that was asked about: its voxel, and lines from the sensors; no scene, no GPU."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..engine import graphics

if TYPE_CHECKING:
    from ..engine import advice, pe

SIDE_M = 0.1
POST_M = 0.6
"""A voxel alone would be lost in the view: a post stands on it."""
SEES, HIDDEN = (
    graphics.with_alpha(graphics.VIEWPORT.free, 0.9),
    graphics.with_alpha(graphics.VIEWPORT.stopped, 0.9),
)
MARK = (1.0, 1.0, 1.0, 0.95)


def asked_place(place: advice.AskedPlace, sensors: Sequence[pe.Sensor]) -> graphics.LayerShape:
    """Return a mark at a place, a line from who sees it, and one from whom the vehicle hides it."""
    center = np.array(place.center)
    told = {each.name: each for each in place.sensors}
    lines = [_mark(center)]
    for sensor in sensors:
        own = told.get(sensor.name)
        if own is not None and own.reason in COLORS:
            ends = np.array([sensor.pose.position, place.center])
            lines.append(graphics.Primitives.of(ends, COLORS[own.reason]))
    seeing = sum(each.m > 0.0 for each in place.sensors)
    text = "in the vehicle" if place.in_vehicle else f"seen by {seeing}, AP {place.ap:.2f}"
    top = (float(center[0]), float(center[1]), float(center[2]) + POST_M)
    return graphics.LayerShape(
        through=graphics.Primitives.joined(lines),
        labels=(graphics.Tag(text, top, MARK, strong=True),),
    )


def _mark(center: np.ndarray) -> graphics.Primitives:
    """Edges of the voxel, and a post on it."""
    corners = center + SIDE_M * (np.array([*np.ndindex(2, 2, 2)]) - 0.5)
    edges = [(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b) in (1, 2, 4)]
    post = np.array([center, center + np.array([0.0, 0.0, POST_M])])
    return graphics.Primitives.of(np.vstack([*(corners[list(edge)] for edge in edges), post]), MARK)


COLORS = {"sees": SEES, "hidden": HIDDEN}
"""By the reason that `advice.ask_place` gives."""
