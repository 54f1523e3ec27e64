"""A spot on the vehicle's surface under the mouse, and the pose of a sensor on it."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import bpy
import numpy as np
from bpy_extras import view3d_utils
from mathutils import Matrix, Vector

from .. import document
from ..engine import Floats, search
from ..sensor_kinds import Mount

PASS_STEP_M = 1e-3  # How far behind a surface that is not the vehicle's a ray goes on
MAX_STEPS = 64
REACH_M = 0.5  # How far out from a spot a ray starts that finds the surface beside it
POSITION_DECIMALS = 3  # A sensor that is put down by hand stands at whole millimetres
PARALLEL_COS = 0.999  # Of two unit vectors: they are parallel
QUARTER = math.pi / 2.0
MAGNET_RAD = math.radians(12.0)
MAGNET_PX = 12.0
"""The magnet: to a quarter turn from so near, to the centre line from so near on the screen, at a
scale of 1."""
STAND_OFF_STEP_M = 0.01
MIN_STAND_OFF_M = 0.0
MAX_STAND_OFF_M = 2.0
MAX_PITCH_DEG = 90.0
"""A sensor pitches no further than straight down or up."""


class SurfaceSpot(NamedTuple):
    """A point of the surface [m], its unit normal towards the viewer, and the object's name."""

    point: Vector
    normal: Vector
    part: str


def parts_of(
    collection: bpy.types.Collection | None, depsgraph: bpy.types.Depsgraph
) -> set[str] | None:
    """Return the names of objects that a sensor may be put on; None (all) without a vehicle."""
    if collection is None:
        return None
    members = document.visible_members(collection, depsgraph.view_layer)
    return {obj.name_full for obj in members if not document.mounted_on_sensor(obj)}


def spot_on_ray(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    parts: set[str] | None,
    origin: Vector,
    direction: Vector,
) -> SurfaceSpot | None:
    """Return the spot where a ray first meets one of the parts; other objects are ignored."""
    start = origin.copy()
    for _ in range(MAX_STEPS):
        hit, point, normal, _, obj, _ = scene.ray_cast(depsgraph, start, direction)
        if not hit:
            return None
        if parts is None or obj.original.name_full in parts:
            facing = normal.normalized()
            return SurfaceSpot(point, facing if facing.dot(direction) <= 0.0 else -facing, obj.name)
        start = point + direction * PASS_STEP_M
    return None


def spot_beside(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    parts: set[str] | None,
    spot: SurfaceSpot,
    wanted: dict[int, float],
) -> SurfaceSpot:
    """Return the spot on the same side of the body with the wanted coordinates [m], by axis. Where
    the body does not reach so far, the point itself is moved."""
    point = spot.point.copy()
    for axis, value in wanted.items():
        point[axis] = value
    found = spot_on_ray(
        scene, depsgraph, parts, point + spot.normal * REACH_M, direction=-spot.normal
    )
    if found is None or (found.point - point).length > REACH_M:
        return spot._replace(point=point)
    return found


class ViewUnderMouse(NamedTuple):
    """The 3D view under the mouse, and the mouse position in it [px]."""

    area: bpy.types.Area
    region: bpy.types.Region
    mouse: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Stance:
    """How a sensor is put on a surface: its distance from it [m], and its direction. `yaw_deg`
    (positive is left) and `pitch_deg` (positive is nose down) turn it from there."""

    stand_off_m: float
    along_normal: bool = False
    yaw_deg: float = 0.0
    pitch_deg: float = 0.0
    magnet: bool = False

    def changed(self, by_m: float) -> "Stance":
        """Return the stance with a changed distance, clipped to the allowed range."""
        nearer = min(max(self.stand_off_m + by_m, MIN_STAND_OFF_M), MAX_STAND_OFF_M)
        return replace(self, stand_off_m=round(nearer, POSITION_DECIMALS))

    def turned(self, yaw_deg: float, pitch_deg: float) -> "Stance":
        """Return the stance, turned further by these angles."""
        yaw = (self.yaw_deg + yaw_deg + 180.0) % 360.0 - 180.0
        pitch = min(max(self.pitch_deg + pitch_deg, -MAX_PITCH_DEG), MAX_PITCH_DEG)
        return replace(self, yaw_deg=yaw, pitch_deg=pitch)

    @property
    def is_turned(self) -> bool:
        """Whether a sensor is turned from the default direction at its spot."""
        return bool(self.yaw_deg or self.pitch_deg)

    def placed(self, spot: SurfaceSpot, mount: Mount, middle: Vector) -> Matrix:
        """Return the pose (4, 4) on a spot of a vehicle with the given middle. Upright: z is up,
        and a sensor that has a front looks away from the middle. Along the normal: the front looks
        along it, or, of sensors that look all around, their z stands so."""
        origin = spot.point + spot.normal * self.stand_off_m
        at = Matrix.Translation([round(value, POSITION_DECIMALS) for value in origin])
        if not self.along_normal:
            yaw = outward_yaw(spot.point, middle) if mount.outward else 0.0
            near = round(yaw / QUARTER) * QUARTER
            yaw = near if self.magnet and abs(yaw - near) <= MAGNET_RAD else yaw
            return at @ Matrix.Rotation(yaw, 4, "Z") @ self._turn()
        turned = (
            _axes_looking_along(spot.normal) if mount.outward else _axes_standing_on(spot.normal)
        )
        return at @ turned.to_4x4() @ self._turn()

    def _turn(self) -> Matrix:
        """(4, 4) yaw, then pitch, in the sensor's own frame."""
        yaw = math.radians(self.yaw_deg)
        pitch = math.radians(self.pitch_deg)
        return Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "Y")


def view_under(context: bpy.types.Context, event: bpy.types.Event) -> ViewUnderMouse | None:
    """Return the 3D view under the mouse; None over its sidebar, its header or anything else."""
    x = event.mouse_x
    y = event.mouse_y
    for area in context.window.screen.areas:
        if area.type != "VIEW_3D" or not _holds(area, x, y):
            continue
        over = [region for region in area.regions if _holds(region, x, y)]
        if any(region.type != "WINDOW" for region in over):
            return None
        for region in over:
            if isinstance(region.data, bpy.types.RegionView3D):
                return ViewUnderMouse(area, region, (x - region.x, y - region.y))
    return None


def ray_of(view: ViewUnderMouse) -> tuple[Vector, Vector]:
    """Return where the ray under the mouse begins, and its direction."""
    look = view.region.data
    origin = view3d_utils.region_2d_to_origin_3d(view.region, look, view.mouse)
    return origin, view3d_utils.region_2d_to_vector_3d(view.region, look, view.mouse)


def pulls_to_middle(view: ViewUnderMouse, point: Vector, scale: float) -> bool:
    """Whether a point is seen so near to its place on the centre line that the magnet pulls it."""
    look = view.region.data
    middle = Vector((point.x, 0.0, point.z))
    ends = [view3d_utils.location_3d_to_region_2d(view.region, look, p) for p in (point, middle)]
    return None not in ends and (ends[0] - ends[1]).length <= MAGNET_PX * scale


def _holds(rectangle: bpy.types.Area | bpy.types.Region, x: int, y: int) -> bool:
    inside_x = rectangle.x <= x < rectangle.x + rectangle.width
    return inside_x and rectangle.y <= y < rectangle.y + rectangle.height


def outward_yaw(point: Vector, middle: Vector) -> float:
    """Yaw from the vehicle's middle to a point of it [rad], in whole degrees."""
    return search.outward_yaw(point.x - middle.x, point.y - middle.y)


def vehicle_center(vehicle: bpy.types.Collection | None) -> Vector:
    """Return the middle of the vehicle's box on the ground; the origin without one."""
    low, high = vehicle_box(vehicle)
    return Vector(((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, 0.0))


def vehicle_box(vehicle: bpy.types.Collection | None) -> Floats:
    """Return the lowest and highest corner (2, 3) of the vehicle's bounding boxes [m]; else 0."""
    solid = [] if vehicle is None else [each for each in vehicle.all_objects if is_part(each)]
    corners = [obj.matrix_world @ Vector(corner) for obj in solid for corner in obj.bound_box]
    if not corners:
        return np.zeros((2, 3))
    return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])


def is_part(obj: bpy.types.Object) -> bool:
    """Whether an object may be a part of a vehicle."""
    is_mesh = obj.type == "MESH" and not document.in_surroundings(obj)
    return is_mesh and not document.mounted_on_sensor(obj)


def _axes_looking_along(normal: Vector) -> Matrix:
    """Axes of a sensor that looks along a normal, as upright as that allows."""
    up = Vector((0.0, 0.0, 1.0))
    if abs(normal.dot(up)) > PARALLEL_COS:
        up = Vector((-math.copysign(1.0, normal.z), 0.0, 0.0))
    left = up.cross(normal).normalized()
    return Matrix((normal, left, normal.cross(left))).transposed()


def _axes_standing_on(normal: Vector) -> Matrix:
    """Axes of a sensor that stands on a surface, as much ahead as that allows."""
    ahead = Vector((1.0, 0.0, 0.0))
    if abs(normal.dot(ahead)) > PARALLEL_COS:
        ahead = Vector((0.0, 0.0, -math.copysign(1.0, normal.x)))
    left = normal.cross(ahead).normalized()
    return Matrix((left.cross(normal), left, normal)).transposed()
