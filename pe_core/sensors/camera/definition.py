"""The measurement of a camera by definition: the area of each voxel's image, if it is in range.

The distance of a voxel's centre decides whether it is in range. A ray to the centre decides whether
it is occluded.

The image of a cube is the union of its visible faces. There are at most three, and they do not
overlap, so the area of the cube is the sum of their areas. Polygons need not be clipped: by Green's
theorem the area of a face inside the picture is the sum over its edges of the integral of y dx,
with x and y clamped to the picture. The integral of each edge has a closed form.

Through a lens with distortion each edge of a face is split into PIECES straight pieces, and the
ends of the pieces are projected. The aperture is the picture, cut by the edge of the lens's field.
A cube that is partly outside the field counts by its visible part. The reference are cubes whose
faces are split into small patches. Areas differ from it by at most 0.5 %. Images that the aperture
cuts may differ by another 0.1 % of the area of a face on the lens's axis.

Tie rules decide where rounding errors would decide otherwise.

Ties are common: designers put cameras at round numbers and angles, and vehicles have round
dimensions. Then corners of voxels lie in the camera's plane, centres lie on the vehicle's surface,
and rays to centres run exactly along its edges. The definition and all kernels follow the same
rules. So they agree wherever the origin of the ground frame is:

- The camera's axes have the same bits for angles a full turn apart; components that are
  mathematically zero are exactly zero.
- The position of a voxel relative to the camera is rounded, in voxels: round numbers stay round.
- All corners of a voxel have to be IN_FRONT of the camera. A corner in the camera's plane counts as
  behind it.
- The ray that tests a voxel aims at its centre, moved a little nearer to the camera along each
  axis. So a centre on a visible surface is visible. Where a ray would run along an edge, this
  nudge decides, not rounding.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Singles
from ...geometry.bins import blocks
from ...geometry.poses import Pose, dot, rotation_matrix
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle, VisibleMesh
from .lens import Lens
from .model import Camera, camera_of

TURN_DEG = 360.0
ANGLE_DECIMALS = 11
"""Decimals of degrees: what double precision leaves of ten turns."""
AXES_DECIMALS = 15
"""Components of axes below this are zero: they are rounding errors of a sine."""
SNAP_DECIMALS = 11
"""Decimals of positions in voxels that rounding leaves for some thousand voxels."""
IN_FRONT = 1e-6
"""In sides; the image of a nearer corner is so large that its area is only rounding errors."""
NUDGE = np.sqrt([5.0, 11.0, 26.0]) * 1e-8
"""In sides: nanometres. Their ratios are not ratios of integers, unlike directions to centres: a
nudge along the ray would decide nothing."""
MARGIN = 1e-6
"""Voxels are enlarged by this, in sides, where the forms of their area meet."""
SensorAxes = tuple[Floats, Floats, Floats]
"""Depth (forward), left and up of points, each (V,) [m]."""
QUAD = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
"""Corners of a face, in order, in half sides along its two axes."""
ROUNDING_PX = 1e-6
"""Areas are sums of terms as large as the picture: a smaller result is only rounding."""
ImagePoints = tuple[Floats, Floats]  # Image positions, right and down [px]
PIECES = 8  # Straight pieces of an edge of a face
BESIDE_SIDES = 4.0
BESIDE_PIECES = 32
"""Nearer than this many sides an edge covers 15 degrees and more: it has this many pieces."""
BALL = math.sqrt(3.0) / 2.0  # Radius of the ball round a cube, in sides
RIGHT_BEHIND = math.pi - 1e-3
"""A cube whose ball reaches the direction opposite to the view has no outline [rad]."""
CUBES_AT_ONCE = 4096
CLIPPED_AT_ONCE = 1024
"""Cubes whose faces are clipped together: their arrays fit the processor's cache."""
Mask = NDArray[np.bool_]


def axes_of(pose: Pose) -> Floats:
    """(3, 3) rotation from the camera's frame to the ground frame."""
    degrees = (math.remainder(angle, TURN_DEG) for angle in pose.rotation_deg)
    turned = rotation_matrix(*(math.radians(round(d, ANGLE_DECIMALS)) for d in degrees))
    return np.round(turned, AXES_DECIMALS) + 0.0


def offsets_of(centers: Floats, position: Sequence[float] | float, side: float) -> Floats:
    """Centres relative to a camera, ground axes [m]. Either (V, 3) relative to a position (3,), or
    one coordinate of each."""
    return np.round((centers - np.asarray(position)) / side, SNAP_DECIMALS) * side


def aims_at(offsets: Floats, side: float, nudge: Floats | float = NUDGE) -> Floats:
    """Points that the rays to voxels at offsets [m] aim at: (V, 3), or one coordinate of each."""
    toward = np.where(offsets < 0.0, side, -side)
    return offsets + toward * nudge


def clipped_pixel_area(camera: Camera, axes: Floats, offsets: Floats, side: float) -> Floats:
    """(V,) pixels covered by cubes of side `side` [m]; 0 with a corner not in front of the camera.

    `axes` (3, 3) rotate from the camera's frame to the ground frame (`definition.axes_of`),
    `offsets` (V, 3) are the cubes' centres from the camera, ground axes (`definition.offsets_of`).
    """
    depth, left, up = in_sensor_frame(axes, offsets)
    area = np.zeros(len(offsets))
    near = np.flatnonzero(in_view(camera, depth, left, up, side=side))
    for block in blocks(len(near), CLIPPED_AT_ONCE):
        some = near[block]
        area[some] = _area_in_view(camera, axes, offsets[some], side)
    return area


def in_sensor_frame(axes: Floats, offsets: Floats) -> SensorAxes:
    """Convert offsets (V, 3) from the ground axes to the camera's axes."""
    x, y, z = (offsets[:, k] for k in range(3))
    depth, left, up = (x * a + y * b + z * c for a, b, c in axes.T)
    return depth, left, up


def frustum_distance(camera: Camera, depth: Floats, left: Floats, up: Floats) -> Floats:
    """Signed distance to the nearest side of the frustum [m]; positive inside."""
    lens = camera.projection
    side = _inside(depth, left, lens.fx, (lens.cx, camera.width - lens.cx))
    top = _inside(depth, up, lens.fy, (lens.cy, camera.height - lens.cy))
    return np.minimum(side, top)


def _inside(depth: Floats, aside: Floats, focal: float, room: tuple[float, float]) -> Floats:
    """Distance to the nearer of two sides, which are `room` [px] from the axis."""
    this, other = room
    if this == other:
        return np.asarray((this * depth - focal * np.abs(aside)) / np.sqrt(this**2 + focal**2))
    near = (this * depth - focal * aside) / np.sqrt(this**2 + focal**2)
    return np.minimum(near, (other * depth + focal * aside) / np.sqrt(other**2 + focal**2))


def in_view(
    camera: Camera, depth: Floats, left: Floats, up: Floats, side: float
) -> NDArray[np.bool_]:
    """Whether cubes may touch the picture; true for every cube that does."""
    radius = side * np.sqrt(3.0) / 2.0
    return (depth > 0.0) & (frustum_distance(camera, depth, left, up) > -radius)


def _area_in_view(camera: Camera, axes: Floats, offsets: Floats, side: float) -> Floats:
    half = side / 2.0
    reach = half * np.abs(axes[:, 0]).sum() + IN_FRONT * side
    depth, left, up = in_sensor_frame(axes, offsets)
    across = np.array([_face_corners(axes, k, half) for k in range(3)])
    toward = -np.sign(offsets.T)[:, None] * half  # to the face on the camera's side, by axis
    corners = [
        center + toward * axes[:, n, None, None] + across[..., n, None]
        for n, center in enumerate((depth, left, up))
    ]
    x, y = _project(camera, *corners)  # (3 faces, 4 corners, V)
    edges = clamped_integral(
        x,
        y,
        np.roll(x, -1, axis=1),
        np.roll(y, -1, axis=1),
        width=float(camera.width),
        height=float(camera.height),
    )
    faces = np.abs(((edges[:, 0] + edges[:, 1]) + edges[:, 2]) + edges[:, 3])
    seen = np.where(np.abs(offsets.T) > half, faces, 0.0)
    area = (seen[0] + seen[1]) + seen[2]
    return np.where((depth > reach) & (area > ROUNDING_PX), area, 0.0)


def _face_corners(axes: Floats, k: int, half: float) -> list[Floats]:
    """Corners of a face across ground axis k from its middle: depth, left and up of each [m]."""
    i = (k + 1) % 3
    j = (k + 2) % 3
    return [(a * half) * axes[i] + (b * half) * axes[j] for a, b in QUAD]


def _project(camera: Camera, depth: Floats, left: Floats, up: Floats) -> ImagePoints:
    """Image positions of points."""
    lens = camera.projection
    safe = np.where(depth > 0.0, depth, 1.0)
    scale = lens.fx / safe
    high = scale if lens.fx == lens.fy else lens.fy / safe
    return lens.cx - left * scale, lens.cy - up * high


def clamped_integral(
    x0: Floats, y0: Floats, x1: Floats, y1: Floats, width: float, height: float
) -> Floats:
    """Integral over an edge of clamp(y, 0, height) dx, for x in [0, width]."""
    run = x1 - x0
    level = run == 0.0
    slope = (y1 - y0) / np.where(level, 1.0, run)
    xa = np.clip(x0, 0.0, width)
    xb = np.clip(x1, 0.0, width)
    ya = y0 + slope * (xa - x0)
    yb = y0 + slope * (xb - x0)
    ca = np.clip(ya, 0.0, height)
    cb = np.clip(yb, 0.0, height)
    # Between ya and yb the clamped line is a ramp with level ends, each weighted by its share of y.
    rise = yb - ya
    flat = np.abs(rise) < 1e-12
    steep = np.where(flat, 1.0, rise)
    ramp = (cb - ca) / steep * (ca + cb) / 2.0
    above = (np.maximum(yb, height) - np.maximum(ya, height)) / steep * height
    mean = np.where(flat, ca, ramp + above)
    return np.where(level, 0.0, mean * (xb - xa))


@dataclass(frozen=True)
class Aperture:
    """A picture of `width` by `height` [px] that lies inside the lens's field."""

    width: float
    height: float

    def area(self, places: ImagePoints) -> Floats:
        """Area (V,) inside the picture of outlines with corners (V, N) each."""
        x0, y0 = places
        x1, y1 = _next(places)
        parts = clamped_integral(x0, y0, x1, y1, width=self.width, height=self.height)
        return np.asarray(np.abs(parts.sum(axis=1)))


@dataclass(frozen=True)
class RoundAperture(Aperture):
    """A picture cut by the edge of the field, an ellipse of half axes `wide` and `high` [px].
    Tangential distortion shifts the ellipse, differently on each side of the picture. An outline is
    cut by the ellipse with the shift at the outline."""

    lens: Lens
    wide: float
    high: float

    def area(self, places: ImagePoints) -> Floats:
        """Area (V,) inside picture and ellipse of outlines with corners (V, N) each. Parts outside
        the picture are first moved onto its border, where they have no area."""
        x, y = places
        inside = ((x >= 0.0) & (x <= self.width) & (y >= 0.0) & (y <= self.height)).all(axis=1)
        area = np.empty(len(x))
        centers = self._centers(places)
        for some, folds in ((inside, False), (~inside, True)):
            held = x[some], y[some]
            right, down = self._folded(held) if folds else held
            cx, cy = centers[some].T[..., None]
            circle = _area_in_circle(((right - cx) / self.wide, (down - cy) / self.high))
            area[some] = circle * (self.wide * self.high)
        return area

    def _centers(self, places: ImagePoints) -> Floats:
        """(V, 2) centres of the ellipse with the shift at each outline [px]."""
        lens = self.lens
        centers = np.broadcast_to([lens.cx, lens.cy], (len(places[0]), 2))
        if not lens.shifts:
            return centers
        x, y = (
            (w.mean(axis=1) - c) / f
            for w, c, f in zip(places, (lens.cx, lens.cy), (lens.fx, lens.fy), strict=True)
        )
        away = np.maximum(np.hypot(x, y), 1e-12)
        moved = lens.shift(np.full(len(x), lens.edge), x / away, y / away)
        return centers + np.stack(moved, axis=1) * (lens.fx, lens.fy)

    def _folded(self, places: ImagePoints) -> ImagePoints:
        """Outlines clamped to the picture, with corners where they cross its sides: (V, 5 N)."""
        starts = places
        ends = _next(places)
        shares = [np.zeros_like(places[0])]
        for a, b, most in zip(starts, ends, (self.width, self.height), strict=True):
            run = np.where(a == b, np.inf, b - a)
            shares += [np.clip((side - a) / run, 0.0, 1.0) for side in (0.0, most)]
        share = np.sort(np.stack(shares, axis=2), axis=2)
        x, y = (
            np.clip(a[..., None] + (b - a)[..., None] * share, 0.0, most).reshape(
                len(a), 5 * a.shape[1]
            )
            for a, b, most in zip(starts, ends, (self.width, self.height), strict=True)
        )
        return x, y


def aperture_of(camera: Camera) -> Aperture:
    """Return the part of a camera's image that counts."""
    lens = camera.projection
    width = float(camera.width)
    height = float(camera.height)
    reach = float(lens.radius(np.asarray(lens.edge)))
    wide = lens.fx * reach
    high = lens.fy * reach
    x = max(lens.cx, width - lens.cx)
    y = max(lens.cy, height - lens.cy)
    if (x / wide) ** 2 + (y / high) ** 2 <= 1.0:
        return Aperture(width, height)
    return RoundAperture(width, height, lens, wide, high=high)


def _next(places: ImagePoints) -> ImagePoints:
    """The next corner of each corner."""
    x, y = places
    return np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)


def _area_in_circle(places: ImagePoints) -> Floats:
    """Area (V,) inside the unit circle, of outlines with corners (V, N) each. Sums over the edges
    the triangle of edge and centre, cut by the circle: a sector where the edge is outside the
    circle, a triangle where it is inside."""
    a = places
    b = _next(places)
    step = b[0] - a[0], b[1] - a[1]
    length = np.maximum(step[0] ** 2 + step[1] ** 2, 1e-300)
    along = a[0] * step[0] + a[1] * step[1]
    root = along**2 - length * (a[0] ** 2 + a[1] ** 2 - 1.0)
    half = np.sqrt(np.maximum(root, 0.0))
    enter, leave = (np.clip((-along + s * half) / length, 0.0, 1.0) for s in (-1.0, 1.0))
    p = a[0] + enter * step[0], a[1] + enter * step[1]
    q = a[0] + leave * step[0], a[1] + leave * step[1]
    twice = _angle(a, p) + (p[0] * q[1] - p[1] * q[0]) + _angle(q, b)
    return np.asarray(np.abs(twice.sum(axis=1)) / 2.0)


def _angle(a: ImagePoints, b: ImagePoints) -> Floats:
    """Angle from one direction to another [rad]."""
    return np.asarray(np.arctan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]))


def bent_pixel_area(
    camera: Camera, axes: Floats, offsets: Floats, side: float, pieces: int = PIECES
) -> Floats:
    """(V,) pixels covered by cubes of side `side` [m] through a camera's lens.

    0 where the camera is inside the ball round a cube, or the ball reaches the direction opposite
    to the view. Arguments are those of `clipped_pixel_area`, and `pieces` of an edge: fewer are
    enough for distant cubes.
    """
    area = np.zeros(len(offsets))
    edge = camera.projection.edge
    distance = np.sqrt(dot(offsets, offsets))
    shown = distance > BALL * side
    safe = np.where(shown, distance, 1.0)
    theta = np.arccos(np.clip(dot(offsets, axes[:, 0]) / safe, -1.0, 1.0))
    half = np.arcsin(np.minimum(BALL * side / safe, 1.0))
    shown &= (theta - half < edge) & (theta + half < RIGHT_BEHIND)  # at least every visible cube
    beside = dot(offsets, offsets) < (BESIDE_SIDES * side) ** 2
    for which, count in ((shown & beside, max(pieces, BESIDE_PIECES)), (shown & ~beside, pieces)):
        near = np.flatnonzero(which)
        for start in range(0, len(near), CUBES_AT_ONCE):
            some = near[start : start + CUBES_AT_ONCE]
            area[some] = _area(camera, axes, offsets[some], side, pieces=count)
    return area


def _area(camera: Camera, axes: Floats, offsets: Floats, side: float, pieces: int) -> Floats:
    half = side / 2.0
    aperture = aperture_of(camera)
    area = np.zeros(len(offsets))
    for k in range(3):
        toward = -np.sign(offsets[:, k]) * half  # the face that faces the camera
        face = offsets.copy()
        face[:, k] += toward
        outline = np.zeros((4 * pieces, 3))  # from the face's centre
        outline[:, [(k + 1) % 3, (k + 2) % 3]] = round_a_face(pieces) * half
        x, y, z = np.moveaxis(face[:, None, :] + outline[None], -1, 0)
        depth, left, up = (x * a[0] + y * a[1] + z * a[2] for a in axes.T)
        places = camera.projection.project(depth, left, up)
        area += np.where(np.abs(offsets[:, k]) > half, aperture.area(places), 0.0)
    return np.where(area > ROUNDING_PX, area, 0.0)


def round_a_face(pieces: int) -> Floats:
    """(4 pieces, 2) points on the border of a face, in half sides."""
    corners = np.array(QUAD)
    share = (np.arange(pieces) / pieces)[None, :, None]
    steps = np.roll(corners, -1, axis=0) - corners
    return (corners[:, None] + steps[:, None] * share).reshape(-1, 2)


def is_ranged(camera: Camera) -> bool:
    """Whether a camera has a minimum or maximum range."""
    return camera.min_range > 0.0 or camera.max_range < math.inf


def out_of_range(camera: Camera, offsets: Floats) -> Mask:
    """Whether centres (V, 3), relative to the camera [m], are out of its range."""
    return _beyond(camera, dot(offsets, offsets))


def cut_to_range(camera: Camera, area: Singles, axes: list[Floats], first: tuple[int, int]) -> None:
    """Set the areas (n, rows, nz) of voxels out of range to 0. `axes` are the centres' coordinates
    along each axis, `first` the first plane and row."""
    x, y, z = axes
    y = y[first[1] : first[1] + area.shape[1]]
    for plane, here in zip(area, x[first[0] :], strict=False):
        plane[_beyond(camera, (here * here + y * y)[:, None] + z * z)] = 0.0


def _beyond(camera: Camera, square: Floats) -> Mask:
    beyond: Mask = square > camera.max_range**2
    if camera.min_range > 0.0:
        beyond |= square < camera.min_range**2
    return beyond


def count_pixels(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    """Return the pixels (V,) that cubes with centres (V, 3) and a side [m] cover: m of voxels."""
    camera = camera_of(sensor)
    position = sensor.pose.position
    offsets = offsets_of(centers, position, side)
    exact = clipped_pixel_area if camera.projection.is_straight else bent_pixel_area
    area = exact(camera, axes_of(sensor.pose), offsets, side)
    if is_ranged(camera):
        area[out_of_range(camera, offsets)] = 0.0
    in_view = np.flatnonzero(area)
    if vehicle is not None and len(in_view):
        seen = vehicle.seen_from(position, camera.sees_through_glass)
        area[in_view[hidden(seen, aims_at(offsets[in_view], side))]] = 0.0
    return area


def hidden(seen: VisibleMesh, aims: Floats) -> NDArray[np.bool_]:
    """Whether the vehicle occludes the points (V, 3) that rays from the camera aim at [m]."""
    distance = np.sqrt(dot(aims, aims))
    hits = seen.first_hit(aims / distance[:, None])
    return hits.distance < distance
