"""What is stored on an object: what makes it a sensor, and its part in the last result.

A sensor's pose is its transform: the fields of the pose in the ground frame store nothing.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from bpy.types import Context, Object, PropertyGroup

from .. import bridge
from ..choices import BODY_ITEMS
from ..engine import pe, search
from ..sensor_kinds import DEFAULT_MODEL
from .callbacks import (
    changed,
    model_chosen,
    models_of_a_kind,
    own_curve_switched,
    recolored,
    redraw,
)
from .declared import group_of
from .fields import menu, number, numbers, rows, switch, switches, text, whole
from .list_rows import PE_SensorOption

AXIS_LABELS = ("X", "Y", "Z", "Roll", "Pitch", "Yaw")  # Of `search.AXES`

REACH_M = 0.5
REACH_DEG = 10.0
"""New bounds are this far to either side of a sensor's value."""
FREE_BY_DEFAULT = tuple(axis in search.PAPER_FREE for axis in search.AXES)


def shown_pose(obj: Object) -> pe.Pose:
    """Return the pose of an object in the ground frame, rounded as a score reads it. A scaled or
    mirrored object, which cannot be scored, gets the nearest pose."""
    ground_from_sensor = np.array(obj.matrix_world, dtype=float)
    try:
        held = bridge.last_written_pose(obj, ground_from_sensor)
        return bridge.pose_of_matrix(ground_from_sensor) if held is None else held
    except pe.InputError:
        location, rotation, _ = obj.matrix_world.decompose()
        angles = rotation.to_euler("XYZ")
        return bridge.pose_from_numbers((*location, *(math.degrees(angle) for angle in angles)))


def _position(settings: PropertyGroup) -> tuple[float, ...]:
    return shown_pose(settings.id_data).position


def _rotation(settings: PropertyGroup) -> tuple[float, ...]:
    return tuple(map(math.radians, shown_pose(settings.id_data).rotation_deg))


def _set_position(settings: PropertyGroup, value: Sequence[float]) -> None:
    obj = settings.id_data
    _stand(obj, value, shown_pose(obj).rotation_deg)


def _set_rotation(settings: PropertyGroup, value: Sequence[float]) -> None:
    obj = settings.id_data
    _stand(obj, shown_pose(obj).position, [math.degrees(angle) for angle in value])


def _stand(obj: Object, position: Sequence[float], degrees: Sequence[float]) -> None:
    bridge.place_at(obj, bridge.pose_from_numbers((*position, *degrees)))


def bounds_begun(settings: PropertyGroup, _context: Context) -> None:
    """Update callback of bounded axes: bounds that are empty begin round the sensor's value."""
    pose = shown_pose(settings.id_data)
    values = (*pose.position, *pose.rotation_deg)
    for index, axis in enumerate(search.AXES):
        if settings.bounded[index] and settings.bounds_low[index] == settings.bounds_high[index]:
            reach = REACH_M if axis in search.POSITION_AXES else REACH_DEG
            settings.bounds_low[index] = round(values[index] - reach, 3)
            settings.bounds_high[index] = round(values[index] + reach, 3)


class GroundPose:
    """Fields of an object's settings that are its transform: nothing is stored here."""

    ground_position: numbers(
        "Position",
        "Optical centre in the ground frame: forward, left, up",
        3,
        subtype="XYZ",
        unit="LENGTH",
        precision=3,
        step=1,
        get=_position,
        set=_set_position,
    )
    ground_rotation: numbers(
        "Rotation",
        "Roll, pitch and yaw in the ground frame: a positive pitch is nose down, a "
        "positive yaw turns left",
        3,
        subtype="EULER",
        unit="ROTATION",
        precision=2,
        step=100,
        get=_rotation,
        set=_set_rotation,
    )


def mounts_of_scene(_settings: PropertyGroup, context: Context, _typed: str) -> list[str]:
    """Return the names of the scene's mounts."""
    return [row.name for row in context.scene.perception_entropy.mounts]


def racks_of_scene(_settings: PropertyGroup, context: Context, _typed: str) -> list[str]:
    """Return the names of the racks that sensors of the scene are on."""
    return sorted({obj.perception_entropy.rack for obj in context.scene.objects} - {""})


CurveFields: Any = group_of(pe.ApCurve, prefix="curve_")
SheetFields: Any = group_of(pe.DataSheet)


class PE_ObjectSettings(GroundPose, CurveFields, SheetFields, PropertyGroup):
    """What makes an object a sensor, and its part in the last result."""

    is_sensor: switch(
        "Is a Sensor", "This object is a sensor: its x axis is forward, z is up", update=changed
    )
    model: text(
        "Model",
        "Name of the sensor in the catalogue",
        DEFAULT_MODEL,
        search=models_of_a_kind,
        search_options={"SUGGESTION"},
        update=model_chosen,
    )
    color: numbers(
        "Color",
        "Colour of this sensor in the panel, the 3D view, pictures, pages and exports",
        3,
        subtype="COLOR_GAMMA",
        min=0.0,
        max=1.0,
        update=recolored,
    )
    color_of: text(
        "Color Of",
        "Name of the sensor that has got this colour: a copy gets another one",
        options={"HIDDEN"},
    )
    fusion: text(
        "Fusion",
        "The beams or pixels of all sensors of a group are summed. If empty, all LiDARs"
        " are one group and each camera is a group of its own",
        update=changed,
    )
    own_curve: switch(
        "Own AP Curve",
        "Use the numbers below for this sensor instead of those of its kind. Sensors of"
        " one fusion group have the same curve",
        update=own_curve_switched,
    )
    free: switches(
        "Free Axes", "Axes that the search may change", len(search.AXES), default=FREE_BY_DEFAULT
    )
    bounded: switches(
        "Bounded",
        "The axis has its own bounds in a search; otherwise those of the vehicle's outline",
        len(search.AXES),
        update=bounds_begun,
    )
    bounds_low: numbers(
        "From",
        "Lowest value that the search may try: metres, or degrees",
        len(search.AXES),
        precision=3,
    )
    bounds_high: numbers(
        "To",
        "Highest value that the search may try: metres, or degrees",
        len(search.AXES),
        precision=3,
    )
    mount: text(
        "Mount",
        "Mount of this sensor in a search; empty: a box of coordinates",
        search=mounts_of_scene,
        search_options={"SUGGESTION"},
        update=redraw,
    )
    rack: text(
        "Rack",
        "Sensors with the same rack move as one in a search; the first by name leads",
        search=racks_of_scene,
        search_options={"SUGGESTION"},
    )
    is_no_go: switch(
        "No-Go Area",
        "In a search, no part of a sensor may be in the box round this object",
        update=redraw,
    )
    options: rows("Models", "Models that a search may choose for this sensor", PE_SensorOption)
    stays: switch("Stays", "A search leaves this sensor where it is, and those that follow it")
    may_be_left_out: switch("May Be Left Out", "A search may choose a design without this sensor")
    show: switch(
        "Show Beams", "Draw this sensor's beams or frustum in the 3D view", True, update=redraw
    )
    placed: numbers(
        "Placed",
        "Placement last written by a search: x, y, z [m], roll, pitch, yaw [deg]",
        len(search.AXES),
        options={"HIDDEN"},
    )

    stands_when_dropped: switch(
        "Stands When Dropped",
        "Stands upright on the surface when it is dropped from the asset browser",
        options={"HIDDEN"},
    )
    is_parked: switch(
        "Is Inactive",
        "This sensor is inactive, because only other variants have it",
        options={"HIDDEN"},
    )
    parked_from: text(
        "Inactive From", "Collections of an inactive sensor before it became inactive"
    )

    order: whole("Order", "Its place in an imported study's rig", options={"HIDDEN"})

    mirror_of: text("Mirror Of", "Name of the sensor that is linked as its mirror image")

    is_view: switch("Is a View", "This camera shows the view of its parent sensor")

    body: menu(
        "Test Body",
        "What this object is: the 3D view says which sensors see such a body there. In a story of "
        "its own animation its size is that of the object",
        BODY_ITEMS,
        update=changed,
    )
    see_through: switch(
        "Cameras See Through",
        "Glass: cameras see through this object; it occludes LiDAR beams",
        update=changed,
    )
    cover_loss_db: number(
        "Radar Cover",
        "Radars measure through this object and lose so many decibels one way; 0: it occludes them",
        min=0.0,
        max=100.0,
        soft_max=10.0,
        update=changed,
    )
