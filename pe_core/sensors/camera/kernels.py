"""The camera's kernels: all voxels of a space, a sample of them, the ground, and objects.

**Ground.** Posts stand in the middles of squares, and are seen if a point of theirs is in the
picture and not occluded. The visible ground is a region with an edge, so first one square of each
block is tested, then all squares of the blocks along the edge.

**Objects.** Rays are cast only for boxes that may be partly occluded.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints
from ...geometry.grids import PerceptionSpace
from ...geometry.poses import dot
from ...metric.fusion import VisibleRows
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle, VisibleMesh
from ..boxes import BoxRays, PlacedBoxes, Rivals, behind_others
from ..kernels import (
    GridKernel,
    GroundKernel,
    GroundView,
    ObjectKernel,
    ObjectView,
    Occlusion,
    VisibleGround,
    block_voxels,
    heights_of_post,
)
from .definition import (
    IN_FRONT,
    aims_at,
    axes_of,
    frustum_distance,
    hidden,
    in_sensor_frame,
    is_ranged,
    out_of_range,
)
from .grid_areas import BentPlanes, CameraPlanes
from .model import Camera, PictureBins, camera_of, picture_occlusion
from .object_definition import BoxImages, along_camera, box_images, visible_share
from .sample_areas import bent_pixel_areas, pixel_areas

SEEN_BYTES = 2  # Memory of a voxel, averaged over visible and invisible ones (measured)
BLOCK_M = 0.125
"""Side of a block of squares: gaps between the middles of blocks are too narrow to count."""
ROOM_M = 1e-3  # Balls round posts are enlarged by this
MARGIN_M = 1e-3  # Balls round boxes are enlarged by this


class ReadyCamera(NamedTuple):
    """A mounted camera with the object that measures planes through its lens."""

    sensor: Sensor
    view: CameraPlanes | BentPlanes


class CameraGrid(GridKernel):
    """Measures areas on all voxels of a space."""

    def __init__(self, space: PerceptionSpace, vehicle: Vehicle | None, _: int = 0) -> None:
        self._space = space
        self._vehicle = vehicle

    def prepare(self, sensor: Sensor) -> ReadyCamera:
        """Prepare the measurement: the vehicle seen from the camera, and half spaces."""
        camera = camera_of(sensor)
        seen = _seen(self._vehicle, sensor)
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

    def rows(self, prepared: ReadyCamera, planes: slice) -> VisibleRows:
        """Measure areas on a block of planes."""
        return prepared.view.areas(planes)


def sampled_pixels(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    """Return the areas (V,) of cubes with centres (V, 3), equal to the definition [px]."""
    camera = camera_of(sensor)
    seen = _seen(vehicle, sensor)
    areas = pixel_areas if camera.projection.is_straight else bent_pixel_areas
    return areas(camera, sensor.pose, centers, side, seen)


def _seen(vehicle: Vehicle | None, sensor: Sensor) -> VisibleMesh | None:
    if vehicle is None:
        return None
    return vehicle.seen_from(sensor.pose.position, sensor.model.sees_through_glass)


class CameraGround(GroundKernel):
    """Marks squares with a visible post in their middle."""

    def __init__(self, view: GroundView) -> None:
        self._view = view

    def mark(self, sensor: Sensor) -> VisibleGround:
        """Test one post of each block, then the posts along the edges of the visible area."""
        grid = self._view.grid
        look = PostVisibility(sensor, self._view)
        side = max(1, int(BLOCK_M / grid.step + 1e-9))
        marked = np.zeros(grid.shape, bool)
        flat = marked.reshape(-1)
        i, j = (np.arange(side // 2, n + side // 2, side).clip(max=n - 1) for n in grid.shape)
        first = np.add.outer(i * grid.shape[1], j)
        seen = look.sees(first.reshape(-1)).reshape(first.shape)
        flat[first[seen]] = True
        along = np.repeat(np.repeat(_edges(seen), side, axis=0), side, axis=1)
        rest = np.flatnonzero(along[: grid.shape[0], : grid.shape[1]])
        flat[rest] = look.sees(rest)
        return VisibleGround(sensor, marked)


class PostVisibility:
    """Tests which posts a camera sees."""

    def __init__(self, sensor: Sensor, view: GroundView) -> None:
        self._camera = camera_of(sensor)
        self._view = view
        self._position = np.asarray(sensor.pose.position)
        self._axes = axes_of(sensor.pose)
        self._seen = _seen(view.vehicle, sensor)
        self._shadow: PictureBins | None = None
        if self._seen is not None and self._camera.projection.is_straight:
            self._shadow = PictureBins(self._camera, self._axes, self._seen.seen.triangles)

    def sees(self, squares: Ints) -> Flags:
        """Whether a point of each post (N,) in the middle of its square is visible."""
        middles = self._view.grid.middles(squares) - self._position[:2]
        possible = self._may_see(middles)
        found = np.zeros(len(squares), bool)
        for z in heights_of_post(self._view.height).tolist():
            left = np.flatnonzero(possible & ~found)
            height = np.full(len(left), z - self._position[2])
            found[left] = self._sees_points(np.column_stack([middles[left], height]))
        return found

    def _may_see(self, middles: Floats) -> Flags:
        """Whether balls round posts (N, 2) reach into the view; true for every visible post."""
        radius = self._view.height / 2.0 + ROOM_M
        up = np.full(len(middles), self._view.height / 2.0 - self._position[2])
        depth, aside, high = in_sensor_frame(self._axes, np.column_stack([middles, up]))
        if self._camera.projection.is_straight:
            away = frustum_distance(self._camera, depth, aside, high)
            return np.asarray((away > -radius) & (depth > -radius))
        flat = np.hypot(aside, high)
        distance = np.hypot(flat, depth)
        wide = np.arcsin(np.minimum(radius / np.maximum(distance, radius), 1.0))
        outside = np.arctan2(flat, depth) - wide > self._camera.projection.edge
        return np.asarray(~outside | (distance <= radius))

    def _sees_points(self, offsets: Floats) -> Flags:
        """Whether points (N, 3) from the camera are in the picture, in range, and not hidden."""
        depth, left, up = in_sensor_frame(self._axes, offsets)
        camera = self._camera
        lens = self._camera.projection
        if lens.is_straight:
            shown = (frustum_distance(camera, depth, left, up) >= 0.0) & (depth > IN_FRONT)
        else:
            right, down = lens.project(depth, left, up)
            shown = (right >= 0.0) & (right <= camera.width) & (down >= 0.0)
            shown &= (down <= camera.height) & (np.arctan2(np.hypot(left, up), depth) <= lens.edge)
        if is_ranged(self._camera):
            shown &= ~out_of_range(self._camera, offsets)
        if self._seen is None:
            return shown
        asked = np.flatnonzero(shown)
        if self._shadow is not None:
            asked = asked[self._shadow.may_hide(depth[asked], left[asked], up[asked])]
        shown[asked] = ~hidden(self._seen, aims_at(offsets[asked], self._view.grid.step))
        return shown


def _edges(seen: Flags) -> Flags:
    """Blocks with a neighbour of the other state, visible or not; corners count as neighbours."""
    return _beside(seen) & _beside(~seen)


def _beside(flags: Flags) -> Flags:
    """Set the flagged cells and all their neighbours."""
    found = flags.copy()
    for axis in (0, 1):
        moved = np.moveaxis(found, axis, 0)
        both = moved.copy()
        both[1:] |= moved[:-1]
        both[:-1] |= moved[1:]
        found = np.moveaxis(both, 0, axis)
    return found


class CameraObjects(ObjectKernel):
    """Measures the visible area of objects' images."""

    def __init__(self, view: ObjectView) -> None:
        self._view = view
        self._balls = np.sqrt(dot(view.objects.sizes, view.objects.sizes)) / 2.0 + MARGIN_M

    def measure(self, sensor: Sensor) -> Floats:
        """Measure the objects with a camera; equal to the definition."""
        objects = self._view.objects
        camera = camera_of(sensor)
        axes = axes_of(sensor.pose)
        boxes = PlacedBoxes.of(objects, sensor.pose.position)
        which = np.flatnonzero(_may_be_visible(camera, axes, boxes, self._balls))
        images = box_images(camera, axes, boxes.take(which))
        if is_ranged(camera):
            offsets = objects.centers[which] - np.asarray(sensor.pose.position)
            images.area[out_of_range(camera, offsets)] = 0.0
        area = np.zeros(len(objects))
        area[which] = images.area * self._share(sensor, axes, boxes, which, images=images)
        return area

    def _share(
        self, sensor: Sensor, axes: Floats, boxes: PlacedBoxes, which: Ints, images: BoxImages
    ) -> Floats:
        """Visible share of the images of boxes `which`."""
        view = self._view
        camera = camera_of(sensor)
        seen = _seen(view.vehicle, sensor)
        image = images.some(shown := np.flatnonzero(images.area > 0.0))
        by_vehicle = np.full(len(image.area), seen is not None)
        if seen is not None and camera.projection.is_straight:
            bins = PictureBins(camera, axes, seen.seen.triangles)
            by_vehicle = bins.may_hide_in(image.low, image.high)
        rivals = None
        asked = by_vehicle
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

        share = np.ones(len(which))
        own = np.flatnonzero(asked)
        placed = boxes.take(which[shown])
        share[shown[own]] = visible_share(
            camera, axes, placed, image, which=own, is_hidden=is_hidden
        )
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
