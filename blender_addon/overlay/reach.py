"""Reach: how far away a class is still found, as a closed line round the vehicle with metres."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, sight

if TYPE_CHECKING:
    from ..engine import pe

Floats = NDArray[np.float64]

AP = 0.5
"""From which average precision on an object is taken to be found."""
BEARINGS = 72
FIGURES = 8
"""At how many bearings metres are written."""
LEAST_FIGURE_M = 1.0
FAINT = 0.25


def reach_of_rig(
    found: sight.Reach, palette: graphics.Palette = graphics.VIEWPORT, name: str = ""
) -> graphics.LayerShape:
    """Return the rig's reach with metres at some bearings; `name` says which rig, of several."""
    color = palette.reach
    legend = graphics.ColorKey(_title(found), classes=((color, name or "rig"),))
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
    legend = graphics.ColorKey(_title(found), classes=tuple(classes))
    return graphics.LayerShape(lines=graphics.Primitives.joined(lines), legend=legend)


def _title(found: sight.Reach) -> str:
    """What is shown: lone objects are told apart from the voxels of a class."""
    what = f"lone {found.class_name}" if found.sector else found.class_name
    return f"{what[:1].upper()}{what[1:]} found, AP ≥ {AP:g}"


def reach_lines(found: sight.Reach, distance: Floats, color: graphics.Rgba) -> graphics.Primitives:
    """A closed line on the ground; faint where the space ends before the reach does."""
    line = sight.reach_line(found, distance)
    closed = np.append(np.arange(len(line.points)), 0)
    points = np.column_stack([line.points, np.zeros(len(line.points))])[closed]
    cut = line.at_least[closed]
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


def _figures(found: sight.Reach, color: graphics.Rgba) -> Iterable[graphics.Tag]:
    step = max(1, len(found.bearings) // FIGURES)
    cut = sight.ends_with_space(found, found.distance)
    for at in range(0, len(found.bearings), step):
        metres, angle = float(found.distance[at]), float(found.bearings[at])
        if metres >= LEAST_FIGURE_M:
            text = f"{'≥ ' if cut[at] else ''}{metres:.0f} m"
            place = (metres * float(np.cos(angle)), metres * float(np.sin(angle)), 0.0)
            yield graphics.Tag(text, place, graphics.with_alpha(color, 1.0))
