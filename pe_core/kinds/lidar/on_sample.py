"""LiDARs on a sample of voxels; what turning and casting the beams gave is kept while it holds."""

from __future__ import annotations

from collections.abc import Collection
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..kernels import Floats, Measured, SampleKernel, Stopped, Voxels
from .beams import BeamEnds, TurnedBeams, beam_field, stopped_beams
from .lattice import lattice_of
from .model import Lidar
from .points import PlacedLidar, VoxelPoints, count_through
from .ties import position_in_voxels


class LidarSample(SampleKernel):
    """Counts beams through sampled voxels."""

    def __init__(self, voxels: Voxels, vehicle: Vehicle | None, enough: int) -> None:
        self._space, self._vehicle, self._enough = voxels.space, vehicle, enough
        self._points = VoxelPoints(voxels.index)
        self._ends = BeamEnds(vehicle)
        self._turned: dict[str, tuple[Sensor, TurnedBeams]] = {}
        """By the sensor's name, with the sensor they hold for: as many as the last rig had."""

    def measure(self, sensor: Sensor, draft: bool) -> Measured:
        """Count a LiDAR's beams; a draft has them stopped by a map of the vehicle's top."""
        beams = self._turn(sensor)
        if draft and self._ends.can_draft(sensor):
            return Measured(
                sensor, self._count(sensor, beams, self._ends.draft(sensor, beams)), True
            )
        field = beam_field(sensor, self._vehicle, beams.directions)
        return Measured(sensor, self._count(sensor, beams, field.ends), found=field)

    def unhidden(self, sensor: Sensor) -> NDArray:
        """Count a LiDAR's beams as if there were no vehicle."""
        beams = self._turn(sensor)
        max_range = cast(Lidar, sensor.model).max_range
        return self._count(sensor, beams, np.full(len(beams.directions), max_range))

    def stopped(self, measured: Measured) -> Stopped:
        """Count the beams that the vehicle stops; those of a draft are cast for it."""
        field = measured.found or beam_field(measured.sensor, self._vehicle)
        return stopped_beams(field, self._vehicle)

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep the beams of these sensors alone."""
        names = {sensor.name for sensor in sensors}
        self._turned = {name: kept for name, kept in self._turned.items() if name in names}

    def _turn(self, sensor: Sensor) -> TurnedBeams:
        """Return a LiDAR's beams, kept until it turns."""
        known = self._turned.get(sensor.name)
        if known and known[0].model is sensor.model and known[0].pose.rpy == sensor.pose.rpy:
            return known[1]
        beams = TurnedBeams.of(sensor)
        self._turned[sensor.name] = (sensor, beams)
        return beams

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
