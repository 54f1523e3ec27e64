"""What scoring objects asks of a kind: sensors measured again and again on the same objects."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.objects import Objects
from ..scene.sensors import Sensor
from ..scene.vehicle import Vehicle

Floats = NDArray[np.float64]
ObjectDefinition = Callable[[Sensor, Objects, Vehicle | None, bool], Floats]


@dataclass(frozen=True, slots=True)
class ObjectView:
    """What sensors are measured on: objects, the vehicle, and whether objects hide each other."""

    objects: Objects
    vehicle: Vehicle | None = None
    traffic: bool = False


class ObjectKernel(ABC):
    """Measures sensors of one kind on a fixed set of objects."""

    @abstractmethod
    def measure(self, sensor: Sensor) -> Floats:
        """m (N,) of a sensor, as its kind defines it."""

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep nothing of other sensors than these."""
        return


class DefinedObjects(ObjectKernel):
    """Measures objects by a definition of m."""

    def __init__(self, measure: ObjectDefinition, view: ObjectView) -> None:
        self._measure, self._view = measure, view

    def measure(self, sensor: Sensor) -> Floats:
        """Measure a sensor by the definition."""
        view = self._view
        return np.asarray(
            self._measure(sensor, view.objects, view.vehicle, view.traffic), dtype=float
        )
