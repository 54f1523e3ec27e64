"""Sensors measured on some voxels, kept by name: one that has not moved is not measured again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from numpy.typing import NDArray

from ..metric.entropy import ApCurve
from ..metric.fusion import CurveOf
from ..scene.sensors import Rig, Sensor
from ..scene.vehicle import Vehicle
from .kernels import Measured, SampleKernel, Stopped, Voxels
from .table import kind_of


class MeasuredByName:
    """Measures rigs on one fixed set of voxels.

    What was measured last is kept by the sensor's name, for the sensors of the last rig.

    Parameters
    ----------
    voxels : Voxels
    vehicle : Vehicle or None
    enough : callable
        The whole number from which on the m of a kind is saturated, by the kind's name.
    known : dict, optional
        What kernels know besides voxels, by kind, for several of these on one vehicle.
    """

    def __init__(
        self,
        voxels: Voxels,
        vehicle: Vehicle | None,
        enough: Callable[[CurveOf], int],
        known: dict[str, Any] | None = None,
    ) -> None:
        self._voxels, self._vehicle, self._enough = voxels, vehicle, enough
        self._known = {} if known is None else known
        self._kernels: dict[tuple[str, ApCurve | None], SampleKernel] = {}  # as many as there are
        self._measured: dict[str, Measured] = {}  # by sensor name: those of the last rig

    @property
    def last(self) -> Mapping[str, Measured]:
        """What is kept: the sensors of the last rig by name."""
        return MappingProxyType(self._measured)

    @property
    def m(self) -> dict[str, NDArray]:
        """m of the sensors of the last rig by name, (V,) each."""
        return {name: known.m for name, known in self._measured.items()}

    def measure(self, rig: Rig, draft: bool = False) -> None:
        """Measure what has moved, or is known as a draft only and now asked for in earnest."""
        self._measured = {
            s.name: self.known(s, draft) or self._kernel(s).measure(s, draft) for s in rig
        }
        for kernel in self._kernels.values():
            kernel.forget_all_but(rig.sensors)

    def measure_again(self, sensor: Sensor) -> NDArray:
        """Measure one sensor in earnest, keep what was found, and return its m."""
        found = self._measured[sensor.name] = self._kernel(sensor).measure(sensor, False)
        return found.m

    def known(self, sensor: Sensor, draft: bool) -> Measured | None:
        """Return what is known of a sensor, unless it has moved or only a draft of it is kept."""
        known = self._measured.get(sensor.name)
        if known is None or (known.draft and not draft):
            return None
        before = known.sensor
        same = before.model is sensor.model and before.curve == sensor.curve
        return known if same and before.pose == sensor.pose else None

    def unhidden(self, sensor: Sensor) -> NDArray:
        """Measure a sensor as if there were no vehicle; nothing of it is kept."""
        return self._kernel(sensor).unhidden(sensor)

    def stopped(self, sensor: Sensor) -> Stopped:
        """Say what the vehicle stops of a sensor of the last rig."""
        return self._kernel(sensor).stopped(self._measured[sensor.name])

    def _kernel(self, sensor: Sensor) -> SampleKernel:
        """Return what measures sensors of its kind."""
        kind, key = kind_of(sensor), (sensor.kind, sensor.curve)
        if key not in self._kernels:
            enough = self._enough(sensor.curve or kind.name)
            kernel = kind.on_sample(self._voxels, self._vehicle, enough)
            kernel.share(self._known.setdefault(kind.name, kernel.known))
            self._kernels[key] = kernel
        return self._kernels[key]
