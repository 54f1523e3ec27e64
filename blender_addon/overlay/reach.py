"""Reach: how far away a class is still found, as a closed line round the vehicle with metres."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics

if TYPE_CHECKING:
    from ..engine import pe, sight

Floats = NDArray[np.float64]

AP = 0.5
"""From which average precision on an object is taken to be found."""
BEARINGS = 72
FIGURES = 8
"""At how many bearings metres are written."""
LEAST_FIGURE_M = 1.0
AT_LEAST_M = 0.5
"""A reach nearer to the edge of the space than this ends there: it is at least that far."""
FAINT = 0.25


def reach_of_rig(
    found: sight.Reach, palette: graphics.Palette = graphics.VIEWPORT, name: str = ""
) -> graphics.LayerShape:
    """Return the rig's reach with metres at some bearings; `name` says which rig, of several."""
    color = palette.reach
    title = f"{found.class_name.capitalize()} found, AP ≥ {AP:g}"
    legend = graphics.ColorKey(title, classes=((color, name or "rig"),))
    return graphics.LayerShape(
        lines=reach_lines(found, found.distance, color),
        labels=tuple(_figures(found, palette.words)),
        legend=legend,
    )


def reach_of_sensors(found: sight.Reach, numbers: dict[str, int]) -> graphics.LayerShape:
    """Return the reach of sensors one by one, in their colours; `numbers` are their places."""
    lines, classes = [], []
    for name, number in numbers.items():
        color = (*graphics.sensor_color(number), 0.75)
        lines.append(reach_lines(found, found.per_sensor[name], color))
        classes.append((color, name))
    legend = graphics.ColorKey(
        f"{found.class_name.capitalize()} found, AP ≥ {AP:g}", classes=tuple(classes)
    )
    return graphics.LayerShape(lines=graphics.Primitives.joined(lines), legend=legend)


def reach_lines(found: sight.Reach, distance: Floats, color: graphics.Rgba) -> graphics.Primitives:
    """A closed line on the ground; faint where the space ends before the reach does."""
    cut = _at_least(found, distance)
    distance = np.where(cut, distance, rounded(distance))
    points = np.zeros((len(distance) + 1, 3))
    closed = np.append(np.arange(len(distance)), 0)
    points[:, 0] = (distance * np.cos(found.bearings))[closed]
    points[:, 1] = (distance * np.sin(found.bearings))[closed]
    cut = cut[closed]
    colors = np.tile(np.float32(color), (len(closed) - 1, 2, 1))
    colors[cut[:-1] & cut[1:], :, 3] *= FAINT
    return graphics.Primitives.of(graphics.polyline(points), colors)


def rig_reach(
    look: sight.Sight,
    rig: pe.Rig,
    class_name: str,
    palette: graphics.Palette = graphics.VIEWPORT,
    name: str = "",
) -> graphics.LayerShape:
    """Work out and return any rig's reach for a class: another variant's beside the scene's."""
    return reach_of_rig(look.reach(rig, class_name, ap=AP, bearings=BEARINGS), palette, name)


def rounded(distance: Floats) -> Floats:
    """Distances all round, each weighed with its neighbours 1 2 1: what beams leave is ragged."""
    return (np.roll(distance, 1) + 2.0 * distance + np.roll(distance, -1)) / 4.0


def _at_least(found: sight.Reach, distance: Floats) -> NDArray[np.bool_]:
    return distance >= found.limit - AT_LEAST_M


def _figures(found: sight.Reach, color: graphics.Rgba) -> Iterable[graphics.Tag]:
    step = max(1, len(found.bearings) // FIGURES)
    cut = _at_least(found, found.distance)
    distance = np.where(cut, found.distance, rounded(found.distance))
    for at in range(0, len(found.bearings), step):
        metres, angle = float(distance[at]), float(found.bearings[at])
        if metres >= LEAST_FIGURE_M:
            text = f"{'≥ ' if cut[at] else ''}{metres:.0f} m"
            place = (metres * float(np.cos(angle)), metres * float(np.sin(angle)), 0.0)
            yield graphics.Tag(text, place, graphics.with_alpha(color, 1.0))
