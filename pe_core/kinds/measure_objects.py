"""The measurement m of objects as it is defined, and sensors measured on objects by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ..scene.objects import Objects
from ..scene.sensors import Rig, Sensor
from ..scene.vehicle import Vehicle
from .object_kernel import ObjectKernel, ObjectView
from .table import kind_of

Floats = NDArray[np.float64]


def measure_objects(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None = None, traffic: bool = False
) -> Floats:
    """Return the measurement of each object by one sensor.

    LiDAR: the number of beams that end on the object: of all that it meets the beam enters this
    object first, at a distance within the LiDAR's range. Camera: the area of the box's image in
    pixels, clipped to the picture, times the share of it that nothing hides (docs/metric.md).

    Parameters
    ----------
    sensor : Sensor
    objects : Objects
    vehicle : Vehicle, optional
        Hides what lies behind it.
    traffic : bool
        Whether the objects of a scene hide each other; else each stands alone.

    Returns
    -------
    (N,) float
        Beams or pixels.

    Raises
    ------
    InputError
        When the sensor is of a kind that measures no objects.
    """
    return kind_of(sensor).measure_objects(sensor, objects, vehicle, traffic)


class ObjectsByName:
    """Measures rigs on one fixed set of objects; a sensor that has not moved is not measured again.

    What was measured last is kept by the sensor's name, for the sensors of the last rig.

    Parameters
    ----------
    objects : Objects
    vehicle : Vehicle, optional
    traffic : bool
        Whether the objects of a scene hide each other.
    """

    def __init__(
        self, objects: Objects, vehicle: Vehicle | None = None, traffic: bool = False
    ) -> None:
        self._view = ObjectView(objects, vehicle, traffic)
        self._kernels: dict[str, ObjectKernel] = {}  # by kind
        self._measured: dict[str, tuple[Sensor, Floats]] = {}

    def measure(self, rig: Rig) -> Mapping[str, Floats]:
        """m of a rig's sensors by name, (N,) each; read-only."""
        self._measured = {s.name: (s, self._one(s)) for s in rig}
        for kernel in self._kernels.values():
            kernel.forget_all_but(rig.sensors)
        return MappingProxyType({name: m for name, (_, m) in self._measured.items()})

    def _one(self, sensor: Sensor) -> Floats:
        known = self._measured.get(sensor.name)
        if known and known[0].model is sensor.model and known[0].pose == sensor.pose:
            return known[1]
        kind = kind_of(sensor)
        if kind.name not in self._kernels:
            self._kernels[kind.name] = kind.on_objects(self._view)
        m = self._kernels[kind.name].measure(sensor)
        m.flags.writeable = False
        return m
