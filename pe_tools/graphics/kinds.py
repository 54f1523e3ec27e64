"""How each kind of sensor is drawn: one table, for the viewport and for the page.

A kind without a row is drawn as a ring around the sensor, with a tick in its forward direction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.scene import Sensor

from .beams import BeamChoice, ChannelMode, cast, free_lines, shown_beams
from .colors import Palette
from .frustums import footprint, frustum_faces, frustum_lines, ring_lines
from .primitives import Primitives
from .sensor_images import field_faces, field_footprint, field_lines

FEW_BEAMS = BeamChoice(96, ChannelMode.FEW)
"""Of a LiDAR that is drawn alone."""
Draw = Callable[[Sensor, float, Palette], Primitives]
"""Takes a sensor, the length of its view [m], and colours."""


@dataclass(frozen=True, slots=True)
class Drawing:
    """How sensors of one kind are drawn. `lines` are two points each, `faces` translucent
    triangles. `beams` states whether sensors of the kind share the budget of beams. `footprint`
    returns the outline of the ground in the field of view, up to some metres."""

    lines: Draw
    faces: Draw = lambda *_: Primitives.empty()
    beams: bool = False
    footprint: Callable[[Sensor, float], Floats] | None = None


def _few_beams(sensor: Sensor, length_m: float, palette: Palette) -> Primitives:
    beams = shown_beams(cast(sensor, None), FEW_BEAMS)
    return free_lines(sensor, beams, length_m, np.tile(palette.free, (len(beams.ends), 1)))


FIELD = Drawing(field_lines, field_faces, footprint=field_footprint)
DRAWINGS = {
    "lidar": Drawing(_few_beams, beams=True),
    "camera": Drawing(frustum_lines, frustum_faces, footprint=footprint),
    "radar": FIELD,
    "ultrasonic": FIELD,
}
OTHER = Drawing(ring_lines)
"""Drawing of a kind without a row."""


def drawing_of(kind: str) -> Drawing:
    """Return how sensors of a kind are drawn."""
    return DRAWINGS.get(kind, OTHER)


def beam_budget(sensors: list[Sensor], most: int) -> int:
    """Return the number of beams that each sensor with beams may show, at least one."""
    sharing = sum(drawing_of(sensor.kind).beams for sensor in sensors)
    return max(1, most // max(1, sharing))
