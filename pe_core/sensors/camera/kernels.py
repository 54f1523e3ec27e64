"""The camera's kernels for voxels: all voxels of a space, and a sample of them."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from functools import partial, reduce
from operator import add
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from ...geometry.grids import PerceptionSpace
from ...metric.fusion import VisibleRows
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle, VisibleMesh
from ..kernels import GridKernel, Measured, Occlusion, Planes, SampleKernel, Voxels, block_voxels
from .bent_grid_areas import BentPlanes
from .grid_areas import CameraPlanes
from .model import Camera
from .picture import picture_occlusion
from .sample_areas import bent_pixel_areas, pixel_areas

SEEN_BYTES = 2
"""Memory of a voxel, averaged over visible and invisible ones (measured)."""


class ReadyCamera(NamedTuple):
    """A mounted camera with the object that measures planes through its lens."""

    sensor: Sensor
    view: CameraPlanes | BentPlanes


class CameraGrid(GridKernel):
    """Measures areas on all voxels of a space."""

    def __init__(self, space: PerceptionSpace, vehicle: Vehicle | None, _: int = 0) -> None:
        self._space, self._vehicle = space, vehicle

    def prepare(self, sensor: Sensor) -> ReadyCamera:
        """Prepare the measurement: the vehicle seen from the camera, and half spaces."""
        camera, seen = cast(Camera, sensor.model), _seen(self._vehicle, sensor)
        kind = CameraPlanes if camera.projection.is_straight else BentPlanes
        return ReadyCamera(sensor, kind(camera, sensor.pose, self._space, seen))

    def occlusion(self, prepared: ReadyCamera) -> Occlusion:
        """Count places of the picture that the vehicle hides."""
        return picture_occlusion(prepared.sensor, self._vehicle)

    def memory_bytes(
        self, groups: Sequence[Sequence[Sensor]], space: PerceptionSpace, workers: int
    ) -> int:
        """Estimate the memory for the areas of the rows that each group sees [bytes]."""
        return len(groups) * workers * block_voxels(space) * SEEN_BYTES

    def planes(self, groups: Sequence[Sequence[ReadyCamera]], pool: Executor) -> list[Planes]:
        """Return functions that measure a group's planes on request."""
        return [partial(_areas, cameras) for cameras in groups]


class CameraSample(SampleKernel):
    """Measures areas of sampled voxels."""

    def __init__(self, voxels: Voxels, vehicle: Vehicle | None, _: int = 0) -> None:
        self._voxels, self._vehicle = voxels, vehicle
        self._centers = np.asfortranarray(voxels.centers)  # fast for arithmetic axis by axis

    def measure(self, sensor: Sensor, approximate: bool) -> Measured:
        """Measure a camera, always exactly."""
        return Measured(sensor, self._pixels(sensor, self._vehicle))

    def unoccluded(self, sensor: Sensor) -> NDArray:
        """Measure a camera as if there were no vehicle."""
        return self._pixels(sensor, None)

    def occlusion(self, measured: Measured) -> Occlusion:
        """Count places of the picture that the vehicle hides."""
        return picture_occlusion(measured.sensor, self._vehicle)

    def _pixels(self, sensor: Sensor, vehicle: Vehicle | None) -> NDArray:
        camera, side = cast(Camera, sensor.model), self._voxels.space.interval
        seen = _seen(vehicle, sensor)
        areas = pixel_areas if camera.projection.is_straight else bent_pixel_areas
        return areas(camera, sensor.pose, self._centers, side, seen)


def _areas(cameras: Sequence[ReadyCamera], planes: slice) -> VisibleRows:
    return reduce(add, (camera.view.areas(planes) for camera in cameras))


def _seen(vehicle: Vehicle | None, sensor: Sensor) -> VisibleMesh | None:
    if vehicle is None:
        return None
    return vehicle.seen_from(sensor.pose.position, sensor.model.sees_through_glass)
