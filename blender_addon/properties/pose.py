"""A sensor's pose in the ground frame, as fields: read from and written to its own transform."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
import numpy as np
from bpy.props import FloatVectorProperty

from .. import bridge
from ..engine import pe


def shown_pose(obj: bpy.types.Object) -> pe.Pose:
    """Return where an object stands in the ground frame, rounded as a score reads it.

    One that no score takes (scaled, mirrored) is told as near as a pose can tell it.
    """
    ground_from_sensor = np.array(obj.matrix_world, dtype=float)
    try:
        held = bridge.held_pose(obj, ground_from_sensor)
        return bridge.pose_of_matrix(ground_from_sensor) if held is None else held
    except pe.InputError:
        location, rotation, _ = obj.matrix_world.decompose()
        angles = rotation.to_euler("XYZ")
        return bridge.pose_from_numbers((*location, *(math.degrees(angle) for angle in angles)))


def _position(settings: bpy.types.PropertyGroup) -> tuple[float, ...]:
    return shown_pose(settings.id_data).position


def _rotation(settings: bpy.types.PropertyGroup) -> tuple[float, ...]:
    return tuple(map(math.radians, shown_pose(settings.id_data).rotation_deg))


def _set_position(settings: bpy.types.PropertyGroup, value: Sequence[float]) -> None:
    obj = settings.id_data
    _stand(obj, value, shown_pose(obj).rotation_deg)


def _set_rotation(settings: bpy.types.PropertyGroup, value: Sequence[float]) -> None:
    obj = settings.id_data
    _stand(obj, shown_pose(obj).position, [math.degrees(angle) for angle in value])


def _stand(obj: bpy.types.Object, position: Sequence[float], degrees: Sequence[float]) -> None:
    bridge.stand_at(obj, bridge.pose_from_numbers((*position, *degrees)))


class GroundPose:
    """Fields of an object's settings that are its transform: nothing is stored here."""

    ground_position: FloatVectorProperty(
        name="Position",
        description="Optical centre in the ground frame: ahead, left, and over the ground",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
        precision=3,
        step=1,
        get=_position,
        set=_set_position,
    )
    ground_rotation: FloatVectorProperty(
        name="Rotation",
        description="Roll, pitch and yaw in the ground frame: a positive pitch is nose down, a "
        "positive yaw turns left",
        size=3,
        subtype="EULER",
        unit="ROTATION",
        precision=2,
        step=100,
        get=_rotation,
        set=_set_rotation,
    )
