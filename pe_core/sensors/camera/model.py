"""A camera's intrinsics, and its picture: rays, field of view, occlusion by the vehicle."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, cast

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints
from ...base.errors import InputError
from ...base.values import A_NAME, Angle, Number, Whole
from ...geometry.bins import Raster, corner_max, corner_min, count_up, spans_of_triangles
from ...geometry.poses import dot, rotate
from ...scene.rig import Sensor, SensorModel
from ...scene.vehicle import Vehicle
from ..field_of_view import (
    NEAREST,
    SHORTEST_RANGE_M,
    ViewPatch,
    checked_ranges,
    count_by_part,
    grid_faces,
)
from ..kernels import Occlusion
from .lens import Lens, Pinhole, field_outline, reaching

PIXELS = Whole(1, 1_000_000, "pixels")
FOV = Angle(0.001, 180.0, below=True)
FARTHEST = Number(SHORTEST_RANGE_M, cap=1e9, unit="m", noun="length", infinite=True)
"""Maximum range; a camera as a rule has none."""
PICTURE_RAYS = 16_384
"""Number of tested positions in the picture: shares are accurate to about a thousandth."""
Extent = tuple[Ints, Ints]  # First and last bin of triangles along one coordinate
CELLS = 64  # Number of bins along a side
MAP = Raster((-1.0, 1.0), (-1.0, 1.0), CELLS)
ROOM_PX = 1e-3
"""Rectangles are enlarged by this, against rounding errors."""
BORDER = 1.05
"""Bins extend beyond the picture by this, for voxels that only touch the picture."""


@dataclass(frozen=True, eq=False)
class Camera(SensorModel):
    """Intrinsics of a camera: an ideal pinhole (eq. 3) with a field of view, or any `Lens`.

    `InputError` when the name, the resolution, the field of view, a range or the lens is not
    possible. A lens must be invertible in all of the picture, with its principal point inside.

    Parameters
    ----------
    name : str
        Catalogue name, or the user's own.
    width, height : int
        Active resolution [px].
    hfov : float, optional
        Horizontal field of view [rad] of a pinhole with square pixels and a centred principal
        point, below 180 degrees; stored as a file in degrees gives it back. With a lens it is
        computed: the angle between the ends of the row through the principal point.
    lens : Lens, optional
        Instead of `hfov`. The edge of its field is set for this picture.
    min_range, max_range : float
        A voxel with a centre nearer or farther is not visible [m].
    """

    kind: ClassVar[str] = "camera"
    sees_through_glass: ClassVar[bool] = True

    name: str
    width: int
    height: int
    hfov: float = None  # type: ignore[assignment]  # of the lens
    lens: Lens | None = None
    min_range: float = NEAREST
    max_range: float = math.inf

    def __post_init__(self) -> None:
        name = A_NAME.checked("camera", "name", self.name)
        for key in ("width", "height"):
            object.__setattr__(self, key, PIXELS.checked(name, key, getattr(self, key)))
        ranges = checked_ranges(name, self.min_range, self.max_range, FARTHEST)
        object.__setattr__(self, "min_range", ranges[0])
        object.__setattr__(self, "max_range", ranges[1])
        if self.lens is None:
            object.__setattr__(self, "hfov", FOV.checked(name, "hfov", self.hfov))
        else:
            self._fit(name)

    def _fit(self, name: str) -> None:
        """Set the lens's edge for this picture, and the field of view."""
        if not isinstance(self.lens, Lens):
            raise InputError(name, "lens", "a lens", type(self.lens).__name__)
        for key, most in (("cx", self.width), ("cy", self.height)):
            if not 0.0 <= getattr(self.lens, key) <= most:
                found = f"{getattr(self.lens, key):g}"
                raise InputError(name, key, f"a place in the picture, 0 to {most}", found)
        object.__setattr__(self, "lens", reaching(self.lens, name, self.width, self.height))
        hfov = self._across((0.0, self.width), (self.projection.cy, self.projection.cy))
        if self.hfov is not None and abs(self.hfov - hfov) > 1e-9:
            raise InputError(name, "hfov", "either a field of view or a lens", "both")
        object.__setattr__(self, "hfov", hfov)

    @cached_property
    def projection(self) -> Lens:
        """The lens; for an ideal camera, the pinhole with its field of view."""
        if self.lens is not None:
            return self.lens
        f = self.width / (2.0 * math.tan(self.hfov / 2.0))
        return Pinhole(f, f, self.width / 2.0, self.height / 2.0)

    @property
    def focal_px(self) -> float:
        """Focal length ``W / (2 tan(r_h / 2))`` [px], for eq. 3; with a lens, mean of fx and fy."""
        lens = self.projection
        return lens.fx if lens.fx == lens.fy else math.sqrt(lens.fx * lens.fy)

    @property
    def pixels_per_radian(self) -> float:
        """Pixels per radian on the axis: the root of those per steradian."""
        ahead = np.ones(1)
        aside = np.zeros(1)
        return math.sqrt(self.projection.density(ahead, aside, aside)[0])

    @property
    def vfov(self) -> float:
        """Vertical field of view [rad], along the column through the principal point."""
        if self.lens is None:
            return 2.0 * math.atan(self.height / (2.0 * self.focal_px))
        return self._across((self.lens.cx, self.lens.cx), (0.0, self.height))

    def outline(self, places: int = 16) -> NDArray[np.float64]:
        """(4 places, 3) unit directions, forward, left, up, on the border of the view.

        From the upper left corner clockwise, as the camera sees it.
        """
        return field_outline(self.projection, self.width, self.height, places)

    def _across(self, right: tuple[float, float], down: tuple[float, float]) -> float:
        """Sum of the angles from the axis to two image positions [rad], each at most the edge."""
        depth = self.projection.unproject(np.array(right), np.array(down))[:, 0]
        angles = np.where(np.isnan(depth), self.projection.edge, np.arccos(np.clip(depth, -1, 1)))
        return float(angles.sum())


def camera_of(sensor: Sensor) -> Camera:
    """Return the model of a sensor that is a camera."""
    return cast("Camera", sensor.model)


def picture_rays(sensor: Sensor, most: int) -> Floats:
    """(R, 3) unit directions, ground frame, through a regular raster of at most `most` pixels."""
    camera = camera_of(sensor)
    size = max(1.0, math.sqrt(camera.width * camera.height / most))
    across = min(max(1, math.floor(camera.width / size)), most)
    down = max(1, min(math.floor(camera.height / size), most // across))
    u = (np.arange(across) + 0.5) / across - 0.5
    v = (np.arange(down) + 0.5) / down - 0.5
    if camera.lens is not None:
        places = np.meshgrid((u + 0.5) * camera.width, (v + 0.5) * camera.height, indexing="ij")
        bent = camera.lens.unproject(places[0].ravel(), places[1].ravel())
        return rotate(sensor.pose.ground_from_sensor, bent[~np.isnan(bent[:, 0])])
    left, up = np.meshgrid(-u * camera.width, -v * camera.height, indexing="ij")
    rays = np.stack([np.full(left.size, camera.focal_px), left.ravel(), up.ravel()], axis=1)
    return rotate(sensor.pose.ground_from_sensor, rays / np.sqrt(dot(rays, rays))[:, None])


def picture_patch(camera: Camera, step: float) -> ViewPatch:
    """Return the view of a camera as triangles of about `step` [rad]."""
    widest = max(camera.hfov, camera.vfov)
    outline = camera.outline(max(math.ceil(widest / step), 2))
    angle = np.arccos(np.clip(outline[:, 0], -1.0, 1.0))
    away = outline[:, 1:] / np.maximum(np.sin(angle), 1e-12)[:, None]
    rings = max(math.ceil(float(angle.max()) / step), 1)
    theta = np.arange(1, rings + 1)[:, None] / rings * angle
    flat = np.sin(theta)[..., None] * away
    directions = np.concatenate([np.cos(theta)[..., None], flat], axis=-1).reshape(-1, 3)
    directions = np.vstack([[[1.0, 0.0, 0.0]], directions])
    # The outline runs clockwise as the camera sees it: its rows go inwards as seen from outside.
    index = 1 + np.arange(rings * len(outline)).reshape(rings, -1)[::-1]
    index = np.vstack([index, np.zeros((1, len(outline)), np.int64)])
    return ViewPatch(directions, grid_faces(index, closed=True))


def picture_occlusion(sensor: Sensor, vehicle: Vehicle | None) -> Occlusion:
    """Count evenly spread positions of a picture: all, those on the vehicle, these by part."""
    rays = picture_rays(sensor, PICTURE_RAYS)
    if vehicle is None:
        return Occlusion(len(rays))
    hits = vehicle.first_hit(sensor.pose.position, rays, sensor.model.sees_through_glass)
    parts = np.asarray(vehicle.parts)[hits.face[np.isfinite(hits.distance)]]
    return Occlusion(len(rays), len(parts), count_by_part(parts, vehicle.part_names))


class PictureBins:
    """Bins of a picture, CELLS by CELLS, with a flag where a triangle of the vehicle may be. `axes`
    (3, 3) rotate from the camera's frame to the ground frame (`definition.axes_of`); `triangles`
    (F, 3, 3) are corners relative to the camera, ground axes [m]."""

    def __init__(self, camera: Camera, axes: Floats, triangles: Floats) -> None:
        self._lens = lens = camera.projection
        width = camera.width
        height = camera.height
        self._wide = BORDER * (2.0 * max(lens.cx, width - lens.cx)) / 2.0 / lens.fx
        self._high = BORDER * (2.0 * max(lens.cy, height - lens.cy)) / 2.0 / lens.fy
        corners = rotate(axes.T, triangles).transpose(2, 1, 0)
        depth, left, up = np.ascontiguousarray(corners)
        (i0, i1), (j0, j1) = _bins(depth, left / self._wide, up / self._high)
        high = j1 - j0 + 1
        n = (i1 - i0 + 1) * high
        step = count_up(n)
        rows = np.repeat(high, n)
        row = step // rows
        self._hit = np.zeros(CELLS * CELLS, bool)
        bins = (np.repeat(i0, n) + row) * CELLS + np.repeat(j0, n) + (step - row * rows)
        self._hit[bins] = True
        self.empty = not len(bins)

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Minimum and maximum of left / depth, and of up / depth, of the flagged bins."""
        hit = self._hit.reshape(CELLS, CELLS)
        ends = (np.flatnonzero(hit.any(axis=axis))[[0, -1]] for axis in (1, 0))
        (i0, i1), (j0, j1) = ((a * 2.0 / CELLS - 1.0, (b + 1) * 2.0 / CELLS - 1.0) for a, b in ends)
        return (i0 * self._wide, i1 * self._wide), (j0 * self._high, j1 * self._high)

    def may_hide(self, depth: Floats, left: Floats, up: Floats) -> NDArray[np.bool_]:
        """Whether the vehicle may hide points in front of the camera, each (V,)."""
        u = left / (depth * self._wide)
        v = up / (depth * self._high)
        bins = self._bin(u) * CELLS + self._bin(v)
        outside = np.maximum(np.abs(u), np.abs(v)) > 1.0
        return self._hit[bins] | outside

    def may_hide_in(self, low: Floats, high: Floats) -> NDArray[np.bool_]:
        """Whether the vehicle may be visible in rectangles of the picture, corners (V, 2) [px].
        Corners are (right, down); False for an empty rectangle."""
        shown = (low <= high).all(axis=1)
        ends = np.where(shown[:, None], low, 0.0), np.where(shown[:, None], high, 0.0)
        (x0, y0), (x1, y1) = (
            (p + room).T for p, room in zip(ends, (-ROOM_PX, ROOM_PX), strict=True)
        )
        lens = self._lens
        i0, i1 = (self._bin((lens.cx - x) / lens.fx / self._wide) for x in (x1, x0))
        j0, j1 = (self._bin((lens.cy - y) / lens.fy / self._high) for y in (y1, y0))
        sums = np.zeros((CELLS + 1, CELLS + 1), np.int32)
        sums[1:, 1:] = self._hit.reshape(CELLS, CELLS).cumsum(axis=0).cumsum(axis=1)
        inside = sums[i1 + 1, j1 + 1] - sums[i0, j1 + 1] - sums[i1 + 1, j0] + sums[i0, j0]
        return shown & (inside > 0)

    @staticmethod
    def _bin(u: Floats) -> NDArray[np.int32]:
        return np.clip((u + 1.0) * (CELLS / 2), 0, CELLS - 1).astype(np.int32)


def _bins(depth: Floats, u: Floats, v: Floats) -> tuple[Extent, Extent]:
    """First and last bin along u and v of triangles with corners (3, F). Triangles outside the
    picture are left out. The range has every bin that a triangle touches."""
    index = np.flatnonzero(_may_be_visible(depth, u, v))
    depth = depth[:, index]
    i0, i1 = (MAP.rows(w).astype(np.int64) for w in spans_of_triangles(depth, u[:, index]))
    j0, j1 = (MAP.columns(w).astype(np.int64) for w in spans_of_triangles(depth, v[:, index]))
    return (i0, i1), (j0, j1)


def _may_be_visible(depth: Floats, u: Floats, v: Floats) -> NDArray[np.bool_]:
    """Whether triangles (3, F) may be in the picture: no side has all three corners outside."""
    seen: NDArray[np.bool_] = corner_max(depth) > 0.0
    for w in (u, v):
        seen &= (corner_min(w - depth) <= 0.0) & (corner_max(w + depth) >= 0.0)
    return seen
