"""Another variant's sensors, faintly, each with a line to where it stands now; no scene, no GPU."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..engine import graphics

if TYPE_CHECKING:
    from ..engine import pe

RING_M, VIEW_M = 0.18, 0.6
"""Radius of a ring, and length of a camera's view."""
FAINT, LINK = 0.5, 0.8
SAME_M = 1e-4
"""Sensors nearer to each other than this stand in one place: there is no line between them."""
PALE = (0.85, 0.85, 0.9)
GHOSTS = replace(
    graphics.VIEWPORT, reach=graphics.with_alpha(PALE, 0.55), words=graphics.with_alpha(PALE, 0.75)
)
"""Colours of another variant's reach."""
VARIANT = "Other variant"


def ghosts(
    others: Sequence[pe.Sensor],
    present: Sequence[pe.Sensor],
    name: str = "",
    title: str = VARIANT,
) -> graphics.LayerShape:
    """Return another variant's sensors, and lines to those of the same names that stand here.

    Parameters
    ----------
    others, present : sequence of Sensor
        The other variant's, and the scene's.
    name : str
        Of the other variant, for the legend.
    title : str
        What the legend calls them.
    """
    here = {sensor.name: sensor for sensor in present}
    lines = [_outline(sensor) for sensor in others]
    lines += [_link(sensor, here[sensor.name]) for sensor in others if sensor.name in here]
    color = graphics.with_alpha(PALE, LINK)
    labels = tuple(graphics.Tag(s.name, s.pose.position, color) for s in others if _apart(s, here))
    legend = graphics.ColorKey(title, classes=((color, name or "another one"),)) if others else None
    return graphics.LayerShape(
        through=graphics.Primitives.joined(lines), labels=labels, legend=legend
    )


def _outline(
    sensor: pe.Sensor, palette: graphics.Palette = graphics.VIEWPORT
) -> graphics.Primitives:
    """A camera's view, a ring for all else, in one pale colour."""
    drawing = graphics.drawing_of(sensor.kind)
    if drawing.beams:
        drawn = graphics.ring_lines(sensor, RING_M, palette)
    else:
        drawn = drawing.sketch(sensor, None, graphics.BeamChoice(1)).lines(VIEW_M, palette)
    return graphics.Primitives.of(drawn.points, graphics.with_alpha(PALE, FAINT))


def _link(other: pe.Sensor, here: pe.Sensor) -> graphics.Primitives:
    """A line from where a sensor stands there to where it stands here; none where that is one."""
    ends = np.array([other.pose.position, here.pose.position])
    if np.abs(ends[0] - ends[1]).max() < SAME_M:
        return graphics.Primitives.empty()
    return graphics.Primitives.of(ends, graphics.with_alpha(PALE, LINK))


def _apart(sensor: pe.Sensor, here: dict[str, pe.Sensor]) -> bool:
    """Whether a sensor stands elsewhere here, or is not here at all: it needs its own name."""
    if sensor.name not in here:
        return True
    own, present = np.array(sensor.pose.position), np.array(here[sensor.name].pose.position)
    return bool(np.abs(own - present).max() >= SAME_M)
