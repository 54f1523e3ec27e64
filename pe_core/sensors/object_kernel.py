"""Object kernels: measure the sensors of one kind on a fixed set of objects.

`ObjectKernel` is the interface for scoring; `DefinedObjects` implements it by the definition of m.
`PlacedBoxes` holds the objects' boxes relative to a sensor.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats, Ints
from ..scene.objects import Objects
from ..scene.rig import Sensor
from ..scene.vehicle import Vehicle
from .body_parts import BodyParts
from .kernels import CachingKernel

ObjectDefinition = Callable[[Sensor, Objects, Vehicle | None, bool], Floats]


@dataclass(frozen=True, slots=True)
class ObjectView:
    """Objects, the vehicle, and whether the objects of a scene occlude each other."""

    objects: Objects
    vehicle: Vehicle | None = None
    traffic: bool = False


class ObjectKernel(CachingKernel, ABC):
    """Measures sensors of one kind on a fixed set of objects."""

    @abstractmethod
    def measure(self, sensor: Sensor) -> Floats:
        """Return m (N,) of a sensor, equal to the definition of its kind."""

    def measure_parts(self, sensor: Sensor, parts: BodyParts) -> Floats:
        """Return m (N,) of the cells of bodies, equal to `Kind.measure_parts`; else `measure`."""
        return self.measure(sensor)

    def unoccluded(self, sensor: Sensor) -> Floats | None:
        """Return m (N,) where nothing occludes an object; None: as expensive as `measure`.

        No m of `measure` is higher.
        """
        return None


class DefinedObjects(ObjectKernel):
    """Measures objects by the definition of m."""

    def __init__(self, measure: ObjectDefinition, view: ObjectView) -> None:
        self._measure, self._view = measure, view

    def measure(self, sensor: Sensor) -> Floats:
        """Return m (N,) by the definition."""
        view = self._view
        return np.asarray(
            self._measure(sensor, view.objects, view.vehicle, view.traffic), dtype=float
        )


NUDGE_M = np.array([1.97, 3.02, 4.98]) * 1e-8
"""A sensor is moved by this, ground frame [m]: a beam that would run exactly along a face of a box
(the horizontal one, at the height of its roof) then runs beside it or through it, whatever the
rounding. The ratios are those of `lidar.tie_rules`: of no beam at round angles, so that a beam
through an edge of a box is decided as well."""
NO_SPEED = 1e-30
"""Replaces a direction component of exactly 0, to divide by it."""


@dataclass(frozen=True, slots=True)
class PlacedBoxes:
    """Boxes relative to a sensor, along the axes of each box: length, width, up.

    Attributes
    ----------
    offsets : (N, 3) float
        Centres, from the sensor [m].
    halves : (N, 3) float
        Half sizes [m].
    headings : (N, 2) float
        Cosine and sine of the yaws.
    """

    offsets: Floats
    halves: Floats
    headings: Floats

    @classmethod
    def of(cls, objects: Objects, position: Sequence[float]) -> PlacedBoxes:
        """Return the boxes of objects relative to a position, moved by `NUDGE_M`."""
        x, y, z = (objects.centers - (np.asarray(position) + NUDGE_M)).T
        c, s = objects.headings.T
        offsets = np.stack([c * x + s * y, c * y - s * x, z], axis=1)
        return cls(offsets, objects.sizes / 2.0, objects.headings)

    def take(self, index: Ints) -> PlacedBoxes:
        """Return some of the boxes."""
        return PlacedBoxes(self.offsets[index], self.halves[index], self.headings[index])

    def ground_offsets(self) -> tuple[Floats, Floats]:
        """Return x and y (N,) of the centres, from the sensor, ground axes [m]."""
        (x, y, _), (c, s) = self.offsets.T, self.headings.T
        return c * x - s * y, s * x + c * y

    def along(self, which: Ints, directions: Floats) -> tuple[Floats, Floats, Floats]:
        """Return ground-frame directions (P, 3) along the axes of box `which` (P,) each."""
        c, s = self.headings[which].T
        x, y, z = directions.T
        return c * x + s * y, c * y - s * x, z

    def crossing(self, which: Ints, directions: Floats) -> tuple[Floats, Floats]:
        """Return distances (P,) at which rays from the sensor enter and leave one box each.

        `enter` is at least 0; if the ray misses, enter >= leave.
        """
        enter, leave = np.zeros(len(which)), np.full(len(which), np.inf)
        for k, speed in enumerate(self.along(which, directions)):
            speed = np.where(np.abs(speed) < NO_SPEED, NO_SPEED, speed)
            offset, half = self.offsets[which, k], self.halves[which, k]
            t0, t1 = (offset - half) / speed, (offset + half) / speed
            np.maximum(enter, np.minimum(t0, t1), out=enter)
            np.minimum(leave, np.maximum(t0, t1), out=leave)
        return enter, leave
