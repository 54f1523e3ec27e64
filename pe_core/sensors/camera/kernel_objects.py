"""Object kernel of cameras: rays are cast only for boxes that may be partly occluded."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints
from ...geometry.poses import dot
from ...scene.rig import Sensor
from ...scene.vehicle import VisibleMesh
from ..boxes import BoxRays, PlacedBoxes, Rivals, behind_others
from ..kernels import ObjectKernel, ObjectView
from .box_area import BoxImages, along_camera, box_images
from .definition import is_ranged, out_of_range
from .model import Camera
from .object_definition import visible_share
from .picture import PictureBins
from .pixel_area import frustum_distance
from .tie_rules import axes_of

MARGIN_M = 1e-3
"""Balls round boxes are enlarged by this."""


class CameraObjects(ObjectKernel):
    """Measures the visible area of objects' images."""

    def __init__(self, view: ObjectView) -> None:
        self._view = view
        self._balls = np.sqrt(dot(view.objects.sizes, view.objects.sizes)) / 2.0 + MARGIN_M

    def measure(self, sensor: Sensor) -> Floats:
        """Measure the objects with a camera; equal to the definition."""
        objects, camera, axes = self._view.objects, cast(Camera, sensor.model), axes_of(sensor.pose)
        boxes = PlacedBoxes.of(objects, sensor.pose.position)
        which = np.flatnonzero(_may_be_visible(camera, axes, boxes, self._balls))
        images = box_images(camera, axes, boxes.take(which))
        if is_ranged(camera):
            offsets = objects.centers[which] - np.asarray(sensor.pose.position)
            images.area[out_of_range(camera, offsets)] = 0.0
        area = np.zeros(len(objects))
        area[which] = images.area * self._share(sensor, axes, boxes, which, images)
        return area

    def unoccluded(self, sensor: Sensor) -> Floats:
        """Measure the whole images (N,) of the objects."""
        return CameraObjects(ObjectView(self._view.objects)).measure(sensor)

    def _share(
        self, sensor: Sensor, axes: Floats, boxes: PlacedBoxes, which: Ints, images: BoxImages
    ) -> Floats:
        """Visible share of the images of boxes `which`."""
        view, camera, seen = self._view, cast(Camera, sensor.model), None
        if view.vehicle is not None:
            seen = view.vehicle.seen_from(sensor.pose.position, camera.sees_through_glass)
        image = images.some(shown := np.flatnonzero(images.area > 0.0))
        by_vehicle = _may_be_hidden(camera, axes, image, seen)
        rivals, asked = None, by_vehicle
        if view.traffic:
            rivals = Rivals.near(boxes, view.objects.scenes, self._balls, which[shown])
            asked = by_vehicle | (rivals.count > 0)

        def is_hidden(rays: BoxRays) -> NDArray[np.bool_]:
            hidden = np.zeros(len(rays.item), bool)
            if seen is not None:
                near = np.flatnonzero(by_vehicle[rays.item])  # rays that the vehicle may occlude
                hidden[near] = seen.first_hit(rays.directions[near]).distance < rays.distance[near]
            if rivals is not None:
                hidden |= behind_others(boxes, rivals, rays)
            return hidden

        share, own = np.ones(len(which)), np.flatnonzero(asked)
        placed = boxes.take(which[shown])
        share[shown[own]] = visible_share(camera, axes, placed, image, own, is_hidden)
        return share


def _may_be_visible(
    camera: Camera, axes: Floats, boxes: PlacedBoxes, balls: Floats
) -> NDArray[np.bool_]:
    """Whether balls round boxes reach into the view; true for every visible box."""
    everything = np.arange(len(balls))
    depth, left, up = along_camera(axes, boxes, everything, boxes.offsets).T
    if camera.projection.is_straight:
        inside = frustum_distance(camera, depth, left, up) > -balls
        return np.asarray(inside & (depth > -balls))
    distance = np.sqrt(dot(boxes.offsets, boxes.offsets))
    safe = np.maximum(distance, balls)
    theta = np.arctan2(np.hypot(left, up), depth)
    within = theta - np.arcsin(balls / safe) < camera.projection.edge
    return np.asarray(within | (distance <= balls))


def _may_be_hidden(
    camera: Camera, axes: Floats, images: BoxImages, seen: VisibleMesh | None
) -> NDArray[np.bool_]:
    """Whether the vehicle may hide images; always true for a lens with distortion."""
    if seen is None or not camera.projection.is_straight:
        return np.full(len(images.area), seen is not None)
    return PictureBins(camera, axes, seen.seen.triangles).may_hide_in(images.low, images.high)
