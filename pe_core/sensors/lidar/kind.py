"""The LiDAR as a kind of sensor: its row of the registry, and its figures in text."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import Floats
from ...geometry.grids import PerceptionSpace
from ...metric.entropy import POINTPILLARS, ApCurve
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..body_parts import BodyParts
from ..field_of_view import EgoMask, ViewPatch
from ..ground_kernel import GroundView
from ..kernels import Voxels
from ..kind import Kind, derived_object_curves
from ..object_kernel import ObjectView
from ..weather import Weather, lidar_range, limited
from . import sensor_table
from .definition import count_beams, count_on_objects, count_on_parts
from .field_of_view import beam_patch, revolution_mask
from .kernel_ground import LidarGround
from .kernel_objects import LidarObjects
from .kernel_voxels import LidarGrid, LidarSample
from .model import Lidar
from .query import beams_to, reason_missed, sample_beams

FITTED = {
    "car": ApCurve(0.237, -0.516),
    "pedestrian": ApCurve(0.163, -0.306),
    "cyclist": ApCurve(0.143, -0.022),
}
"""Fits of AP to the beams of an HDL-64E that end on the box (`pe fit` on docs/objects/*.csv):
PointRCNN's detections in KITTI's tracking sequences (from the public AB3DMOT repository), AP at 40
recalls by KITTI's overlaps (0.7 for cars, 0.5 for the others). The detector was trained on drives
that overlap with these, so its AP is rather high."""
OBJECT_CURVES = derived_object_curves(POINTPILLARS) | FITTED
PLOT_ROWS, BAR_WIDTH = 24, 48


class LidarKind(Kind):
    """LiDARs: m is the number of beams through a voxel."""

    name, label, plural, unit = "lidar", "LiDAR", "LiDARs", "beams"
    model = Lidar
    curve = POINTPILLARS
    weather_limits_range = True
    object_curves = OBJECT_CURVES
    counts_points = True
    shows_parts = True
    keys = sensor_table.KEYS

    def measure(
        self, sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None
    ) -> Floats:
        """Count the beams that pass through each cube before they end."""
        return count_beams(sensor, centers, side, vehicle)

    def measure_objects(
        self, sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
    ) -> Floats:
        """Count the beams that end on each object."""
        return count_on_objects(sensor, objects, vehicle, traffic)

    def measure_parts(self, sensor: Sensor, parts: BodyParts, vehicle: Vehicle | None) -> Floats:
        """Count the beams that meet each cell in the band in which they surely end."""
        return count_on_parts(sensor, parts, vehicle)

    def read(self, name: str, table: Mapping[str, Any], folder: Path) -> Lidar:
        """Build a LiDAR from its table."""
        return sensor_table.read(name, table, folder)

    def write(self, model: Lidar) -> dict[str, Any]:
        """Return a LiDAR's table."""
        return sensor_table.write(model)

    def in_weather(self, model: Lidar, weather: Weather) -> Lidar:
        """Limit the range: see `lidar_range`."""
        return limited(model, lidar_range(model.max_range, weather))

    def data_sheet(self, model: Lidar) -> list[str]:
        """Return the channels, azimuths, number of beams and range, a line each."""
        low, high = math.degrees(model.elevations.min()), math.degrees(model.elevations.max())
        left, right = (math.degrees(a) for a in model.horizontal_fov)
        min_range = f"{model.min_range:g} to " if model.min_range > 0.0 else ""
        return [
            f"channels        {len(model.elevations)}, {low:g} to {high:g} deg",
            f"azimuths        {len(model.azimuth_steps)}, {left:g} to {right:g} deg, "
            f"every {math.degrees(model.azimuth_step):.4g} deg",
            f"beams a frame   {model.beam_count}",
            f"range           {min_range}{model.max_range:g} m",
        ]

    def summary(self, model: Lidar) -> str:
        """Return the number of channels, the field of view across and up, and the range."""
        across = math.degrees(model.horizontal_fov[1] - model.horizontal_fov[0])
        up = math.degrees(model.elevations.max() - model.elevations.min())
        fov = f"{min(across, 360.0):.0f} x {up:.0f} deg"
        return f"{len(model.elevations)} channels, {fov}, {model.max_range:g} m"

    def plot(self, model: Lidar) -> list[str]:
        """Return a histogram of the elevations in text, top first: one mark is one channel."""
        counts, edges = np.histogram(np.degrees(model.elevations), bins=PLOT_ROWS)
        scale = min(1.0, BAR_WIDTH / counts.max())
        return [
            f"{(edges[i] + edges[i + 1]) / 2:8.2f} deg |{'#' * math.ceil(counts[i] * scale)}"
            for i in reversed(range(PLOT_ROWS))
        ]

    def rays(self, sensor: Sensor, most: int) -> Floats:
        """Return evenly picked beams."""
        return sample_beams(sensor, most)

    def rays_to(self, sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats]:
        """Return the beams through the cube without a vehicle, and where they enter it."""
        return beams_to(sensor, center, side)

    def missed(self, sensor: Sensor, center: Floats, side: float) -> str:
        """Return one of: out of range, out of view, between beams."""
        return reason_missed(sensor, center, side)

    def view(self, model: Lidar, step: float) -> ViewPatch:
        """Return the region between its beams."""
        return beam_patch(model, step)

    def ego_mask(self, sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
        """Cast all beams."""
        return revolution_mask(sensor, vehicle)

    def on_grid(
        self, space: PerceptionSpace, vehicle: Vehicle | None, saturation_count: int
    ) -> LidarGrid:
        """Return a kernel that sweeps beams through the planes of the grid."""
        return LidarGrid(space, vehicle, saturation_count)

    def on_sample(
        self, voxels: Voxels, vehicle: Vehicle | None, saturation_count: int
    ) -> LidarSample:
        """Return a kernel that looks beams up by direction."""
        return LidarSample(voxels, vehicle, saturation_count)

    def on_ground(self, view: GroundView) -> LidarGround:
        """Return a kernel that marks the ground below low beams."""
        return LidarGround(view)

    def on_objects(self, view: ObjectView) -> LidarObjects:
        """Return a kernel that counts runs of channels, azimuth by azimuth."""
        return LidarObjects(view)


LIDAR = LidarKind()
