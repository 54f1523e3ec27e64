"""LiDAR: the row of the table of kinds."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...metric.entropy import POINTPILLARS
from ...scene.objects import Objects
from ...scene.sensors import Sensor
from ...scene.space import PerceptionSpace
from ...scene.vehicle import Vehicle
from ..ego_mask import EgoMask
from ..ground_kernel import GroundView
from ..kernels import Floats, Voxels
from ..kind import Kind
from ..object_kernel import ObjectView
from ..view_patch import ViewPatch
from . import table as tables
from .asked import beams_to, missed, some_beams
from .definition import count_beams
from .detectors import OBJECT_CURVES
from .ego import revolution_mask
from .model import Lidar
from .object_definition import count_on_objects
from .on_grid import LidarGrid
from .on_ground import LidarGround
from .on_objects import LidarObjects
from .on_sample import LidarSample
from .view import beam_patch
from .words import brief, channel_plot, figures


class LidarKind(Kind):
    """LiDARs: m is the number of beams through a voxel."""

    name, label, plural, unit = "lidar", "LiDAR", "LiDARs", "beams"
    model = Lidar
    curve = POINTPILLARS
    object_curves = OBJECT_CURVES
    counts_points = True
    keys = tables.KEYS

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

    def read(self, name: str, table: Mapping[str, Any], folder: Path) -> Lidar:
        """Build a LiDAR from its table."""
        return tables.read(name, table, folder)

    def write(self, model: Lidar) -> dict[str, Any]:
        """Return a LiDAR's table."""
        return tables.write(model)

    def words(self, model: Lidar) -> list[str]:
        """Channels, azimuths, beams, range."""
        return figures(model)

    def brief(self, model: Lidar) -> str:
        """Channels, field of view, range."""
        return brief(model)

    def plot(self, model: Lidar) -> list[str]:
        """Where the channels are."""
        return channel_plot(model)

    def rays(self, sensor: Sensor, most: int) -> Floats:
        """Take every n-th beam."""
        return some_beams(sensor, most)

    def rays_to(self, sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats]:
        """Take the beams that would pass through the cube, and where they enter it."""
        return beams_to(sensor, center, side)

    def missed(self, sensor: Sensor, center: Floats, side: float) -> str:
        """Out of range, out of view, or between two beams."""
        return missed(sensor, center, side)

    def view(self, model: Lidar, step: float) -> ViewPatch:
        """Take all that lies between its beams."""
        return beam_patch(model, step)

    def ego_mask(self, sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
        """Ask every beam."""
        return revolution_mask(sensor, vehicle)

    def on_grid(self, space: PerceptionSpace, vehicle: Vehicle | None, enough: int) -> LidarGrid:
        """Sweep planes of the grid."""
        return LidarGrid(space, vehicle, enough)

    def on_sample(self, voxels: Voxels, vehicle: Vehicle | None, enough: int) -> LidarSample:
        """Look beams up by direction."""
        return LidarSample(voxels, vehicle, enough)

    def on_ground(self, view: GroundView) -> LidarGround:
        """Follow beams where they are low."""
        return LidarGround(view)

    def on_objects(self, view: ObjectView) -> LidarObjects:
        """Take runs of channels, azimuth by azimuth."""
        return LidarObjects(view)


LIDAR = LidarKind()
