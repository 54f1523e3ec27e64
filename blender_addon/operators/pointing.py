"""Where the mouse points, and how a sensor stands there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import bpy
from bpy_extras import view3d_utils
from mathutils import Matrix, Vector

from .mounting import Mount
from .surface import Spot

UPRIGHT_M = 0.05
"""A place nearer to the vehicle's middle than this has no outward direction: it looks ahead."""
POSITION_DECIMALS, YAW_STEP_DEG = 3, 1.0
"""A sensor that is put down by hand stands at whole millimetres and looks along whole degrees."""
STEEP = 0.999
"""Of two unit vectors: they are parallel."""
STEP_M, LEAST_M, MOST_M = 0.01, 0.0, 2.0
STEEPEST_DEG = 90.0
"""A sensor pitches no further than straight down or up."""


class Aim(NamedTuple):
    """The 3D view that the mouse is over, and where in it [px]."""

    area: bpy.types.Area
    region: bpy.types.Region
    mouse: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Stance:
    """How a sensor stands on a surface: its distance from it [m], and along which direction.

    `yaw_deg` (positive is left) and `pitch_deg` (positive is nose down) turn it from there.
    """

    stand_off_m: float
    along_normal: bool = False
    yaw_deg: float = 0.0
    pitch_deg: float = 0.0

    def changed(self, by_m: float) -> Stance:
        """Return one that is nearer or farther, within reason."""
        nearer = min(max(self.stand_off_m + by_m, LEAST_M), MOST_M)
        return replace(self, stand_off_m=round(nearer, POSITION_DECIMALS))

    def turned(self, yaw_deg: float, pitch_deg: float) -> Stance:
        """Return one that is turned further by these angles."""
        yaw = (self.yaw_deg + yaw_deg + 180.0) % 360.0 - 180.0
        pitch = min(max(self.pitch_deg + pitch_deg, -STEEPEST_DEG), STEEPEST_DEG)
        return replace(self, yaw_deg=yaw, pitch_deg=pitch)

    @property
    def is_turned(self) -> bool:
        """Whether a sensor is turned from the direction that its place gives it."""
        return bool(self.yaw_deg or self.pitch_deg)

    def placed(self, spot: Spot, mount: Mount, middle: Vector) -> Matrix:
        """(4, 4) placement on a spot of a vehicle with that middle.

        Upright: z is up, and a sensor that has a front looks away from the middle. Along the
        normal: the front looks along it, or, of sensors that look all around, their z stands so.
        """
        origin = spot.point + spot.normal * self.stand_off_m
        at = Matrix.Translation([round(value, POSITION_DECIMALS) for value in origin])
        if not self.along_normal:
            yaw = outward(spot.point, middle) if mount.outward else 0.0
            return at @ Matrix.Rotation(yaw, 4, "Z") @ self._turn()
        turned = _looking(spot.normal) if mount.outward else _standing(spot.normal)
        return at @ turned.to_4x4() @ self._turn()

    def _turn(self) -> Matrix:
        """(4, 4) yaw, then pitch, in the sensor's own frame."""
        yaw, pitch = math.radians(self.yaw_deg), math.radians(self.pitch_deg)
        return Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "Y")


def view_under(context: bpy.types.Context, event: bpy.types.Event) -> Aim | None:
    """Return the 3D view under the mouse; None over its sidebar, its header or anything else."""
    x, y = event.mouse_x, event.mouse_y
    for area in context.window.screen.areas:
        if area.type != "VIEW_3D" or not _holds(area, x, y):
            continue
        over = [region for region in area.regions if _holds(region, x, y)]
        if any(region.type != "WINDOW" for region in over):
            return None
        for region in over:
            if isinstance(region.data, bpy.types.RegionView3D):
                return Aim(area, region, (x - region.x, y - region.y))
    return None


def ray_of(view: Aim) -> tuple[Vector, Vector]:
    """Return where the ray under the mouse begins, and its direction."""
    look = view.region.data
    origin = view3d_utils.region_2d_to_origin_3d(view.region, look, view.mouse)
    return origin, view3d_utils.region_2d_to_vector_3d(view.region, look, view.mouse)


def _holds(rectangle: bpy.types.Area | bpy.types.Region, x: int, y: int) -> bool:
    inside_x = rectangle.x <= x < rectangle.x + rectangle.width
    return inside_x and rectangle.y <= y < rectangle.y + rectangle.height


def outward(point: Vector, middle: Vector) -> float:
    """Yaw from the vehicle's middle to a point of it [rad], in whole degrees."""
    away = (point - middle).to_2d()
    if away.length < UPRIGHT_M:
        return 0.0
    degrees = math.degrees(math.atan2(away.y, away.x))
    return math.radians(round(degrees / YAW_STEP_DEG) * YAW_STEP_DEG)


def _looking(normal: Vector) -> Matrix:
    """Axes of a sensor that looks along a normal, as upright as that allows."""
    up = Vector((0.0, 0.0, 1.0))
    if abs(normal.dot(up)) > STEEP:
        up = Vector((-math.copysign(1.0, normal.z), 0.0, 0.0))
    left = up.cross(normal).normalized()
    return Matrix((normal, left, normal.cross(left))).transposed()


def _standing(normal: Vector) -> Matrix:
    """Axes of a sensor that stands on a surface, as much ahead as that allows."""
    ahead = Vector((1.0, 0.0, 0.0))
    if abs(normal.dot(ahead)) > STEEP:
        ahead = Vector((0.0, 0.0, -math.copysign(1.0, normal.x)))
    left = normal.cross(ahead).normalized()
    return Matrix((left.cross(normal), left, normal)).transposed()
