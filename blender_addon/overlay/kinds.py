"""How each kind of sensor is drawn: one table, for the viewport and for the review picture.

A kind that has no row is drawn as a ring around the sensor with a tick ahead: it is seen, and where
it looks. No scene, no GPU.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from . import geometry
from .beams import Beams, shown_beams
from .colors import VIEWPORT, Palette, Rgba
from .geometry import OverlayGeometry, Primitives

if TYPE_CHECKING:
    from ..engine import pe

Floats = NDArray[np.float64]

FRUSTUM_SHARE = 0.25
"""How long frustums, and the radius of rings, are beside the beams."""
VIEW_SHARE = 0.62
"""How much of a beam has to be in the picture: its end is faint."""


class Sketch(Protocol):
    """One sensor, ready to be drawn at any length."""

    @property
    def stopped(self) -> bool:
        """Whether the vehicle stops a beam that is shown."""

    def lines(self, length_m: float, palette: Palette) -> Primitives:
        """Lines, two points each."""

    def faces(self, length_m: float, palette: Palette) -> Primitives:
        """Translucent triangles."""

    def points(self, length_m: float) -> Floats:
        """(N, 3) points that a picture has to hold [m]."""


@dataclass(frozen=True, slots=True)
class BeamSketch:
    """A LiDAR, and those of its beams that are shown."""

    sensor: pe.Sensor
    beams: Beams

    @property
    def stopped(self) -> bool:
        """Whether the vehicle stops one of them."""
        return bool(self.beams.stopped.any())

    def lines(self, length_m: float, palette: Palette) -> Primitives:
        """Free beams, then those that the vehicle stops."""
        return geometry.beam_lines(self.sensor, self.beams, length_m, palette)

    def faces(self, _length_m: float, _palette: Palette) -> Primitives:
        """None."""
        return Primitives.empty()

    def points(self, length_m: float) -> Floats:
        """Most of each beam."""
        ends = self.lines(length_m, VIEWPORT).points[1::2]
        start = np.array(self.sensor.pose.position)
        return start + VIEW_SHARE * (ends - start)


@dataclass(frozen=True, slots=True)
class FrustumSketch:
    """A camera's view."""

    sensor: pe.Sensor
    stopped = False

    def lines(self, length_m: float, palette: Palette) -> Primitives:
        """Edges of the view."""
        return geometry.frustum_lines(self.sensor, length_m, palette)

    def faces(self, length_m: float, palette: Palette) -> Primitives:
        """Sides of the view."""
        return geometry.frustum_faces(self.sensor, length_m, palette)

    def points(self, length_m: float) -> Floats:
        """Its corners."""
        return geometry.frustum_points(self.sensor, length_m)


@dataclass(frozen=True, slots=True)
class RingSketch:
    """A sensor of which no more is known than where it is and where it looks."""

    sensor: pe.Sensor
    stopped = False

    def lines(self, length_m: float, palette: Palette) -> Primitives:
        """A ring in the sensor's own level plane, and a tick ahead."""
        return geometry.ring_lines(self.sensor, length_m, palette)

    def faces(self, _length_m: float, _palette: Palette) -> Primitives:
        """None."""
        return Primitives.empty()

    def points(self, length_m: float) -> Floats:
        """All of it."""
        return self.lines(length_m, VIEWPORT).points.astype(float)


@dataclass(frozen=True, slots=True)
class Look:
    """What the review picture makes of a kind: lengths [m], and widths of lines [px].

    `legend` is what its lines are called, None for the kind's own name; they begin `clear_m` from
    the sensor, so that it is not lost among them.
    """

    legend: str | None
    length_m: float
    line_px: float
    clear_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Drawing:
    """How sensors of one kind are drawn.

    `sketch` takes a sensor, the vehicle or None, the most beams, and of how many channels they may
    be (None for all). `share` is how long its lines are beside beams, `beams` whether sensors of
    the kind share the budget of beams, `color` their colour in a palette.
    """

    sketch: Callable[[pe.Sensor, pe.Vehicle | None, int, int | None], Sketch]
    color: Callable[[Palette], Rgba]
    look: Look
    share: float = FRUSTUM_SHARE
    beams: bool = False


def _lidar(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, budget: int, channels: int | None
) -> BeamSketch:
    return BeamSketch(sensor, shown_beams(sensor, vehicle, budget, channels))


def _camera(sensor: pe.Sensor, *_: object) -> FrustumSketch:
    return FrustumSketch(sensor)


def _other(sensor: pe.Sensor, *_: object) -> RingSketch:
    return RingSketch(sensor)


DRAWINGS = {
    "lidar": Drawing(
        _lidar,
        lambda palette: palette.free,
        Look("LiDAR beam", 5.5, 1.3, clear_m=0.22),
        share=1.0,
        beams=True,
    ),
    "camera": Drawing(_camera, lambda palette: palette.camera, Look("camera view", 2.0, 1.8)),
}
OTHER = Drawing(_other, lambda palette: palette.other, Look(None, 2.0, 1.8))
"""Of a kind that has no row."""


def drawing_of(kind: str) -> Drawing:
    """Return how sensors of a kind are drawn."""
    return DRAWINGS.get(kind, OTHER)


def beam_budget(sensors: list[pe.Sensor], most: int) -> int:
    """Return how many beams each sensor that has some may show, at least one."""
    sharing = sum(drawing_of(sensor.kind).beams for sensor in sensors)
    return max(1, most // max(1, sharing))


def sensor_geometry(
    sensor: pe.Sensor,
    vehicle: pe.Vehicle | None,
    budget: int,
    length_m: float,
    palette: Palette = VIEWPORT,
) -> OverlayGeometry:
    """Everything drawn in the viewport for one sensor: at most `budget` beams, or a frustum."""
    drawing = drawing_of(sensor.kind)
    sketch, length_m = drawing.sketch(sensor, vehicle, budget, None), length_m * drawing.share
    return OverlayGeometry(sketch.lines(length_m, palette), sketch.faces(length_m, palette))
