"""The camera as a kind of sensor: its row of the registry, and its figures in text."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from ...base.arrays import Floats
from ...geometry.grids import PerceptionSpace
from ...metric.entropy import RTM3D
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..body_parts import BodyParts
from ..field_of_view import EgoMask, ViewPatch
from ..ground_kernel import GroundView
from ..kernels import Voxels
from ..kind import OUT_OF_RANGE, OUT_OF_VIEW, Kind, derived_object_curves
from ..object_kernel import ObjectView, PlacedBoxes
from ..weather import Weather, camera_range, limited
from . import sensor_table
from .box_area import box_images
from .definition import count_pixels, out_of_range
from .kernel_ground import CameraGround
from .kernel_objects import CameraObjects
from .kernels import CameraGrid, CameraSample
from .model import Camera
from .object_definition import count_object_pixels
from .picture import picture_mask, picture_patch, picture_rays
from .tie_rules import axes_of


def summary(camera: Camera) -> str:
    """Return the resolution, and the field of view across and up, in one line."""
    across, up = math.degrees(camera.hfov), math.degrees(camera.vfov)
    return f"{camera.width} x {camera.height} px, {across:.0f} x {up:.0f} deg"


def figures(camera: Camera) -> list[str]:
    """Picture, field of view, focal length."""
    across, up = math.degrees(camera.hfov), math.degrees(camera.vfov)
    wide = f"{across:g}" if camera.lens is None else f"{across:.4g}"
    return [
        f"image           {camera.width} x {camera.height} px",
        f"field of view   {wide} x {up:.4g} deg",
        f"focal length    {camera.focal_px:.2f} px",
        *_lens(camera),
        *_ranges(camera),
    ]


def _lens(camera: Camera) -> list[str]:
    lens = camera.lens
    if lens is None:
        return []
    shown = ", ".join(f"{key} {v:g}" for key in lens.coefficients if (v := getattr(lens, key)))
    return [
        f"principal point {lens.cx:g}, {lens.cy:g} px",
        f"lens            {lens.model}{': ' if shown else ''}{shown}",
    ]


def _ranges(camera: Camera) -> list[str]:
    if not (camera.min_range > 0.0 or camera.max_range < math.inf):
        return []
    most = f"{camera.max_range:g} m" if camera.max_range < math.inf else "any distance"
    return [f"range           {camera.min_range:g} m to {most}"]


class CameraKind(Kind):
    """Cameras: m is the number of pixels that a voxel covers."""

    name, label, plural, unit = "camera", "Camera", "Cameras", "pixels"
    model = Camera
    curve = RTM3D
    weather_limits_range = True
    object_curves = derived_object_curves(RTM3D)
    keys = sensor_table.KEYS
    has_top = True
    shows_parts = True
    occlusion_text = "picture occluded"

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

    def measure_parts(self, sensor: Sensor, parts: BodyParts, vehicle: Vehicle | None) -> Floats:
        """Measure what is seen of each cell's image, of each alone."""
        return count_object_pixels(sensor, parts.cells, vehicle, False)

    def image_widths(self, sensor: Sensor, objects: Objects) -> Floats:
        """Measure how wide the images are in the picture, whatever hides them."""
        boxes = PlacedBoxes.of(objects, sensor.pose.position)
        found = box_images(cast(Camera, sensor.model), axes_of(sensor.pose), boxes)
        return np.maximum(found.high - found.low, 0.0)[:, 0]

    def read(self, name: str, table: Mapping[str, Any], folder: Path) -> Camera:
        """Build a camera from its table."""
        return sensor_table.read(name, table)

    def write(self, model: Camera) -> dict[str, Any]:
        """Return a camera's table."""
        return sensor_table.write(model)

    def in_weather(self, model: Camera, weather: Weather) -> Camera:
        """Limit the range: see `camera_range`."""
        return limited(model, camera_range(model.max_range, weather))

    def data_sheet(self, model: Camera) -> list[str]:
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

    def summary(self, model: Camera) -> str:
        """Picture and field of view."""
        return summary(model)

    def view(self, model: Camera, step: float) -> ViewPatch:
        """Take what the picture shows."""
        return picture_patch(model, step)

    def ego_mask(self, sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
        """Ask every pixel."""
        return picture_mask(sensor, vehicle)

    def on_grid(
        self, space: PerceptionSpace, vehicle: Vehicle | None, saturation_count: int
    ) -> CameraGrid:
        """Fill columns of voxels between the sides of the picture."""
        return CameraGrid(space, vehicle)

    def on_sample(
        self, voxels: Voxels, vehicle: Vehicle | None, saturation_count: int
    ) -> CameraSample:
        """Take the closed form of the area where it is good."""
        return CameraSample(voxels, vehicle)

    def on_ground(self, view: GroundView) -> CameraGround:
        """Look at points of what stands there."""
        return CameraGround(view)

    def on_objects(self, view: ObjectView) -> CameraObjects:
        """Look only where something may be seen, and be hidden."""
        return CameraObjects(view)


CAMERA = CameraKind()
