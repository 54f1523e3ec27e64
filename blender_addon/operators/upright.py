"""Sensors that were dropped as assets: they become upright and look away from the vehicle.

Blender turns an asset that is dropped onto a surface so that its z axis is the surface's normal: a
camera on a tailgate would look along the tailgate. A dropped sensor is turned as *Place* does it,
by the next timer; undo of the drop takes both back.
"""

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..caches import sensor_cache
from ..engine import catalog, pe
from ..sensor_kinds import mount_for
from .surface_pose import Stance, SurfaceSpot, vehicle_center


def on_moving() -> None:
    """Place dropped sensors, where there is a window: a script places what it appends itself."""
    if not bpy.app.background:
        place_dropped()


def place_dropped() -> None:
    """Turn sensors that were just dropped from the asset browser as *Place* does."""
    scene = bpy.context.scene
    dropped = [obj for obj in sensor_cache.sensors(scene) if is_dropped(obj)]
    if dropped:
        bpy.context.view_layer.update()  # Blender has noted where they are, not worked it out
        middle = vehicle_center(scene.perception_entropy.vehicle)
    for obj in dropped:
        obj.perception_entropy.stands_when_dropped = False
        place_on_surface(obj, middle)


def is_dropped(obj: bpy.types.Object) -> bool:
    """Whether a sensor was dropped from the asset browser and is not turned yet. Blender removes
    the mark of an asset from what is dropped, not from what is appended otherwise."""
    is_local = obj.library is None and obj.asset_data is None
    return is_local and obj.perception_entropy.stands_when_dropped


def place_on_surface(obj: bpy.types.Object, middle: Vector) -> None:
    """Put a sensor upright on the surface that the base of its body was dropped on. Blender puts
    the base of its bounding box there. Its body just touches the surface; a sensor without a body
    has the stand-off of its kind."""
    try:
        mount = mount_for(catalog.load(obj.perception_entropy.model))
    except pe.InputError:  # the model is not in this catalogue: its view is unknown
        return
    low = np.min(obj.bound_box, axis=0)
    high = np.max(obj.bound_box, axis=0)
    base = Vector(((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, low[2]))
    local = obj.matrix_world
    spot = SurfaceSpot(local @ base, local.col[2].to_3d().normalized(), "")
    stand_off = mount.stand_off_m
    if obj.data is not None:
        turned = Stance(0.0).placed(spot, mount, middle).to_3x3()
        corners = map(Vector, obj.bound_box)
        stand_off = max(0.0, *(-spot.normal.dot(turned @ corner) for corner in corners))
    placed = Stance(stand_off).placed(spot, mount, middle)
    obj.matrix_world = placed @ Matrix.Diagonal((*obj.scale, 1.0))
