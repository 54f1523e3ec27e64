"""LiDARs on a sample of voxels."""

from __future__ import annotations

from collections.abc import Collection
from typing import cast

from numpy.typing import NDArray

from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..kernels import Measured, SampleKernel, Stopped, Voxels
from .beams import beam_field, stopped_beams
from .ends import AnyEnds, LazyEnds
from .known import KnownBeams, is_same
from .lattice import lattice_of
from .model import Lidar
from .near import count_again_near
from .points import PlacedLidar, Unhidden, VoxelPoints, count_through, count_unhidden
from .ties import position_in_voxels


class LidarSample(SampleKernel):
    """Counts beams through sampled voxels."""

    def __init__(self, voxels: Voxels, vehicle: Vehicle | None, enough: int) -> None:
        self._space, self._vehicle, self._enough = voxels.space, vehicle, enough
        self._points = VoxelPoints(voxels.index)
        self.known = KnownBeams(vehicle)
        self._unhidden: dict[str, tuple[Sensor, Unhidden]] = {}  # by name: those of the last rig

    def measure(self, sensor: Sensor, draft: bool) -> Measured:
        """Count a LiDAR's beams; a draft has them stopped by a map of the vehicle's top."""
        ended = self.known.ended(sensor, draft)
        lidar = self._placed(sensor, ended.ends)
        known = self._unhidden.get(sensor.name)
        unhidden = known[1] if known and is_same(known[0], sensor) else None
        counts = count_through(self._points, lidar, self._enough, unhidden)
        counts = count_again_near(self._points, lidar, counts, _nearest(sensor))
        return Measured(sensor, counts, ended.is_draft, ended.ends)

    def unhidden(self, sensor: Sensor) -> NDArray:
        """Count a LiDAR's beams as if there were no vehicle."""
        lidar = self._placed(sensor, self.known.endless(sensor))
        found = count_unhidden(self._points, lidar, self._enough)
        self._unhidden[sensor.name] = sensor, found
        nearest = _nearest(sensor)
        return count_again_near(self._points, lidar, found.counts, nearest, is_free=True)

    def stopped(self, measured: Measured) -> Stopped:
        """Count the beams that the vehicle stops; those of a draft are cast for it."""
        ends = measured.found
        is_cast = isinstance(ends, LazyEnds)
        field = ends.field() if is_cast else beam_field(measured.sensor, self._vehicle)
        return stopped_beams(field, self._vehicle)

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep the beams of these sensors alone."""
        self.known.forget_all_but(sensors)
        names = {sensor.name for sensor in sensors}
        self._unhidden = {name: kept for name, kept in self._unhidden.items() if name in names}

    def share(self, known: KnownBeams) -> None:
        """Use beams that another sample of voxels knows as well."""
        self.known = known

    def _placed(self, sensor: Sensor, ends: AnyEnds) -> PlacedLidar:
        side = self._space.interval
        return PlacedLidar(
            lattice_of(cast(Lidar, sensor.model)),
            position_in_voxels(sensor.pose.position, self._space.origin, side),
            sensor.pose.ground_from_sensor,
            self.known.turned(sensor),
            ends,
            side,
        )


def _nearest(sensor: Sensor) -> float:
    """Minimum range of a LiDAR [m]."""
    return cast(Lidar, sensor.model).min_range
