"""Camera: the row of the table of kinds."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from ...metric.entropy import RTM3D
from ...scene.objects import Objects
from ...scene.sensors import Sensor
from ...scene.space import PerceptionSpace
from ...scene.vehicle import Vehicle
from ..ego_mask import EgoMask
from ..ground_kernel import GroundView
from ..kernels import Floats, Voxels
from ..kind import OUT_OF_RANGE, OUT_OF_VIEW, Kind
from ..object_curves import all_carried_over
from ..object_kernel import ObjectView
from ..view_patch import ViewPatch
from . import table as tables
from .definition import count_pixels
from .ego import picture_mask
from .kernels import CameraGrid, CameraSample
from .model import Camera
from .object_definition import count_object_pixels
from .on_ground import CameraGround
from .on_objects import CameraObjects
from .picture import picture_rays
from .ranged import out_of_range
from .view import picture_patch
from .words import brief, figures


class CameraKind(Kind):
    """Cameras: m is the number of pixels that a voxel covers."""

    name, label, plural, unit = "camera", "Camera", "Cameras", "pixels"
    model = Camera
    curve = RTM3D
    object_curves = all_carried_over(RTM3D)
    keys = tables.KEYS
    has_top = True
    loss = "picture hidden"

    def measure(
        self, sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None
    ) -> Floats:
        """Measure the area of each cube's image."""
        return count_pixels(sensor, centers, side, vehicle)

    def measure_objects(
        self, sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
    ) -> Floats:
        """Measure what is seen of each object's image."""
        return count_object_pixels(sensor, objects, vehicle, traffic)

    def read(self, name: str, table: Mapping[str, Any], folder: Path) -> Camera:
        """Build a camera from its table."""
        return tables.read(name, table)

    def write(self, model: Camera) -> dict[str, Any]:
        """Return a camera's table."""
        return tables.write(model)

    def words(self, model: Camera) -> list[str]:
        """Picture, field of view, focal length."""
        return figures(model)

    def rays(self, sensor: Sensor, most: int) -> Floats:
        """Look through pixels that are spread over the picture."""
        return picture_rays(sensor, most)

    def missed(self, sensor: Sensor, center: Floats, side: float) -> str:
        """Out of range, or out of view."""
        offset = np.asarray(center)[None] - np.asarray(sensor.pose.position)
        out = out_of_range(cast(Camera, sensor.model), offset)[0]
        return OUT_OF_RANGE if out else OUT_OF_VIEW

    def brief(self, model: Camera) -> str:
        """Picture and field of view."""
        return brief(model)

    def view(self, model: Camera, step: float) -> ViewPatch:
        """Take what the picture shows."""
        return picture_patch(model, step)

    def ego_mask(self, sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
        """Ask every pixel."""
        return picture_mask(sensor, vehicle)

    def on_grid(self, space: PerceptionSpace, vehicle: Vehicle | None, enough: int) -> CameraGrid:
        """Fill columns of voxels between the sides of the picture."""
        return CameraGrid(space, vehicle)

    def on_sample(self, voxels: Voxels, vehicle: Vehicle | None, enough: int) -> CameraSample:
        """Take the closed form of the area where it is good."""
        return CameraSample(voxels, vehicle)

    def on_ground(self, view: GroundView) -> CameraGround:
        """Look at points of what stands there."""
        return CameraGround(view)

    def on_objects(self, view: ObjectView) -> CameraObjects:
        """Look only where something may be seen, and be hidden."""
        return CameraObjects(view)


CAMERA = CameraKind()
