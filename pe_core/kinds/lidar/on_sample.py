"""LiDARs on a sample of voxels."""

from __future__ import annotations

from collections.abc import Collection
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..kernels import Floats, Measured, SampleKernel, Stopped, Voxels
from .beams import TurnedBeams, beam_field, stopped_beams
from .known import KnownBeams
from .lattice import lattice_of
from .model import Lidar
from .points import PlacedLidar, VoxelPoints, count_through
from .ties import position_in_voxels


class LidarSample(SampleKernel):
    """Counts beams through sampled voxels."""

    def __init__(self, voxels: Voxels, vehicle: Vehicle | None, enough: int) -> None:
        self._space, self._vehicle, self._enough = voxels.space, vehicle, enough
        self._points = VoxelPoints(voxels.index)
        self.known = KnownBeams(vehicle)

    def measure(self, sensor: Sensor, draft: bool) -> Measured:
        """Count a LiDAR's beams; a draft has them stopped by a map of the vehicle's top."""
        beams, ended = self.known.turned(sensor), self.known.ended(sensor, draft)
        is_draft = ended.field is None
        return Measured(sensor, self._count(sensor, beams, ended.ends), is_draft, ended.field)

    def unhidden(self, sensor: Sensor) -> NDArray:
        """Count a LiDAR's beams as if there were no vehicle."""
        beams = self.known.turned(sensor)
        max_range = cast(Lidar, sensor.model).max_range
        return self._count(sensor, beams, np.full(len(beams.directions), max_range))

    def stopped(self, measured: Measured) -> Stopped:
        """Count the beams that the vehicle stops; those of a draft are cast for it."""
        field = measured.found or beam_field(measured.sensor, self._vehicle)
        return stopped_beams(field, self._vehicle)

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep the beams of these sensors alone."""
        self.known.forget_all_but(sensors)

    def share(self, known: KnownBeams) -> None:
        """Use beams that another sample of voxels knows as well."""
        self.known = known

    def _count(self, sensor: Sensor, beams: TurnedBeams, ends: Floats) -> NDArray:
        side = self._space.interval
        lidar = PlacedLidar(
            lattice_of(cast(Lidar, sensor.model)),
            position_in_voxels(sensor.pose.position, self._space.origin, side),
            sensor.pose.ground_from_sensor,
            beams.without_zeros,
            ends / side,
        )
        return count_through(self._points, lidar, self._enough)
