"""How each kind of sensor is drawn: one table, for the viewport and for the review picture.

A kind without a row is drawn as a ring around the sensor, with a tick in its forward direction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.scene import Sensor, Vehicle

from . import fields, frustums, rays
from .beams import BeamChoice, Beams, cast, shown_beams
from .colors import VIEWPORT, Palette, Rgba
from .primitives import Primitives
from .sensor_images import camera_of

VIEW_SHARE = 0.62
"""Part of a beam that must be inside the picture: the end of a beam is faint."""


class Sketch(Protocol):
    """One sensor, prepared to be drawn at any length."""

    @property
    def stopped(self) -> bool:
        """Whether the vehicle occludes a beam that is shown."""

    def lines(self, length_m: float, palette: Palette) -> Primitives:
        """Lines, two points each."""

    def faces(self, length_m: float, palette: Palette) -> Primitives:
        """Translucent triangles."""

    def points(self, length_m: float) -> Floats:
        """(N, 3) points that have to be inside a picture [m]."""


@dataclass(frozen=True, slots=True)
class BeamSketch:
    """A LiDAR with the beams that are shown."""

    sensor: Sensor
    beams: Beams

    @property
    def stopped(self) -> bool:
        """Whether the vehicle occludes one of these beams."""
        return bool(self.beams.stopped.any())

    def lines(self, length_m: float, palette: Palette) -> Primitives:
        """Free beams, then occluded beams."""
        colors = np.where(self.beams.stopped[:, None], palette.stopped, palette.free)
        free = rays.free_lines(self.sensor, self.beams, length_m, colors)
        return Primitives.joined([free, rays.stopped_lines(self.sensor, self.beams, colors)])

    def faces(self, _length_m: float, _palette: Palette) -> Primitives:
        """None."""
        return Primitives.empty()

    def points(self, length_m: float) -> Floats:
        """Points that show most of each beam."""
        beams, start = self.beams, np.array(self.sensor.pose.position)
        ends = np.minimum(beams.ends, length_m)
        ends = np.minimum(ends, rays.ground_distance(self.sensor, beams.directions))
        return start + VIEW_SHARE * beams.directions * ends[:, None]


@dataclass(frozen=True, slots=True)
class FrustumSketch:
    """A camera's view."""

    sensor: Sensor
    stopped = False

    def lines(self, length_m: float, palette: Palette) -> Primitives:
        """Edges of the view."""
        return frustums.frustum_lines(self.sensor, length_m, palette)

    def faces(self, length_m: float, palette: Palette) -> Primitives:
        """Sides of the view."""
        return frustums.frustum_faces(self.sensor, length_m, palette)

    def points(self, length_m: float) -> Floats:
        """The corners of the view."""
        if camera_of(self.sensor).lens is not None:
            return frustums.outline(self.sensor, length_m)
        return frustums.frustum_points(self.sensor, length_m)


@dataclass(frozen=True, slots=True)
class RingSketch:
    """A sensor of an unknown kind: only its position and forward direction are drawn."""

    sensor: Sensor
    stopped = False

    def lines(self, length_m: float, palette: Palette) -> Primitives:
        """A ring in the sensor's x-y plane, and a tick in its forward direction."""
        return frustums.ring_lines(self.sensor, length_m, palette)

    def faces(self, _length_m: float, _palette: Palette) -> Primitives:
        """None."""
        return Primitives.empty()

    def points(self, length_m: float) -> Floats:
        """Points of the ring and the tick."""
        return self.lines(length_m, VIEWPORT).points.astype(float)


@dataclass(frozen=True, slots=True)
class Look:
    """Style of a kind in the review picture: lengths [m], and widths of lines [px].

    `legend` is the name of the lines, None for the kind's own name. Lines begin `clear_m` from
    the sensor, so that the sensor stays visible.
    """

    legend: str | None
    length_m: float
    line_px: float
    clear_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Drawing:
    """How sensors of one kind are drawn.

    `sketch` takes a sensor, the vehicle or None, and the choice of beams. `beams` states whether
    sensors of the kind share the budget of beams. `color` is their colour in a palette.
    `footprint` returns the outline of the ground in the field of view, up to some metres.
    """

    sketch: Callable[[Sensor, Vehicle | None, BeamChoice], Sketch]
    color: Callable[[Palette], Rgba]
    look: Look
    beams: bool = False
    footprint: Callable[[Sensor, float], Floats] | None = None


def _lidar(sensor: Sensor, vehicle: Vehicle | None, choice: BeamChoice) -> BeamSketch:
    return BeamSketch(sensor, shown_beams(cast(sensor, vehicle), choice))


def _camera(sensor: Sensor, *_: object) -> FrustumSketch:
    return FrustumSketch(sensor)


def _field(sensor: Sensor, *_: object) -> fields.FieldSketch:
    return fields.FieldSketch(sensor)


def _other(sensor: Sensor, *_: object) -> RingSketch:
    return RingSketch(sensor)


DRAWINGS = {
    "lidar": Drawing(
        _lidar,
        lambda palette: palette.free,
        Look("LiDAR beam", 5.5, 1.8, clear_m=0.22),
        beams=True,
    ),
    "camera": Drawing(
        _camera,
        lambda palette: palette.camera,
        Look("camera view", 2.0, 1.8),
        footprint=frustums.footprint,
    ),
    "radar": Drawing(
        _field,
        lambda palette: palette.other,
        Look("radar field", 5.0, 1.8),
        footprint=fields.field_footprint,
    ),
    "ultrasonic": Drawing(
        _field,
        lambda palette: palette.other,
        Look("ultrasonic cone", 2.5, 1.8),
        footprint=fields.field_footprint,
    ),
}
OTHER = Drawing(_other, lambda palette: palette.other, Look(None, 2.0, 1.8))
"""Drawing of a kind without a row."""


def drawing_of(kind: str) -> Drawing:
    """Return how sensors of a kind are drawn."""
    return DRAWINGS.get(kind, OTHER)


def beam_budget(sensors: list[Sensor], most: int) -> int:
    """Return the number of beams that each sensor with beams may show, at least one."""
    sharing = sum(drawing_of(sensor.kind).beams for sensor in sensors)
    return max(1, most // max(1, sharing))
