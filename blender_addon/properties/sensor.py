"""What is stored on an object: what makes it a sensor, and its part in the last result.

A sensor's pose is its transform: the fields of the pose in the ground frame store nothing.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object, PropertyGroup
from mathutils import Matrix

from .. import document
from ..caches import edge_cache
from ..choices import BODY_ITEMS
from ..engine import catalog, graphics, pe, search, studies
from ..sensor_kinds import DEFAULT_MODEL
from .callbacks import changed, model_chosen, models_of_a_kind, recolored, redraw
from .declared import own_path, table_group
from .fields import menu, number, numbers, rows, switch, switches, text, view, whole
from .list_rows import PE_SensorOption

AXIS_LABELS = ("X", "Y", "Z", "Roll", "Pitch", "Yaw")  # Of `search.AXES`

BOUNDS = ("bounds",)
COLOR = ("color",)
EDGES = ("measured_from",)
EDGE_ABOUT = "Edge of the vehicle from which this coordinate is told; empty: the ground frame"
CURVE = ("ap",)
REACH_M = 0.5
REACH_DEG = 10.0
"""New bounds are this far to either side of a sensor's value."""
FREE_BY_DEFAULT = tuple(axis in search.PAPER_FREE for axis in search.AXES)


def shown_pose(obj: Object) -> pe.Pose:
    """Return the pose of an object in the ground frame, rounded as a score reads it. A scaled or
    mirrored object, which cannot be scored, gets the nearest pose."""
    rows = tuple(map(tuple, obj.matrix_world))
    return _pose_of_rows(rows, tuple(obj.perception_entropy.placed))


@lru_cache(maxsize=64)
def _pose_of_rows(rows: tuple[tuple[float, ...], ...], placed: tuple[float, ...]) -> pe.Pose:
    """Return the pose of a matrix, by its rows: the panel asks for it twelve times a redraw."""
    ground_from_sensor = np.array(rows, dtype=float)
    try:
        held = document.last_written_pose(placed, ground_from_sensor)
        return document.pose_of_matrix(ground_from_sensor) if held is None else held
    except pe.InputError:
        location, rotation, _ = Matrix(rows).decompose()
        angles = rotation.to_euler("XYZ")
        return document.pose_from_numbers((*location, *(math.degrees(angle) for angle in angles)))


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
    document.place_at(obj, document.pose_from_numbers((*position, *degrees)))


def _edges(settings: PropertyGroup) -> dict[str, str]:
    """Return the edges that a sensor's position is told from, by axis."""
    return dict(document.value_at(settings.table, EDGES, {}))


def _edge_of(axis: str) -> dict[str, Any]:
    """Return the callbacks of the edge that an axis is measured from; empty: of none."""

    def write(settings: PropertyGroup, name: str) -> None:
        named = _edges(settings) | {axis: name}
        own = {each: named[each] for each in search.POSITION_AXES if named.get(each)}
        document.put(settings, EDGES, own or None)

    return view(lambda settings: _edges(settings).get(axis, ""), write)


def _edge_names(axis: str) -> Callable[[PropertyGroup, Context, str], list[str]]:
    """Return the callback that lists the edges that an axis can be measured from."""

    def names(_settings: PropertyGroup, context: Context, typed: str) -> list[str]:
        known = edge_cache.edges(context.scene).names(axis)
        return [name for name in known if typed.lower() in name.lower()]

    return names


def measured_distances(settings: PropertyGroup) -> dict[str, studies.Distance]:
    """Return the distances of a sensor from its edges, by axis; an edge that the vehicle does not
    have is left out."""
    position = shown_pose(settings.id_data).position
    edges = edge_cache.edges(bpy.context.scene)
    return {each.axis: each for each in edges.distances(position, _edges(settings))}


def _distances(settings: PropertyGroup) -> list[float]:
    """Return how far a sensor is from its edges along each axis [m], 0 without an edge."""
    known = measured_distances(settings)
    return [abs(known[a].offset) if a in known else 0.0 for a in search.POSITION_AXES]


def _set_distances(settings: PropertyGroup, values: Sequence[float]) -> None:
    """Move a sensor to distances from its edges, on the side of each edge on which it is; a
    negative one is on the other side. Axes without an edge stay."""
    obj = settings.id_data
    pose = shown_pose(obj)
    known = measured_distances(settings)
    wanted: list[studies.MetresOrDistance] = list(pose.position)
    for index, axis in enumerate(search.POSITION_AXES):
        if (own := known.get(axis)) is None:
            continue
        typed = round(values[index], search.POSITION_DECIMALS)
        is_changed = abs(typed - abs(own.offset)) > search.ROUNDING_M
        offset = math.copysign(1.0, own.offset) * typed if is_changed else own.offset
        wanted[index] = replace(own, offset=offset)
    position = edge_cache.edges(bpy.context.scene).position(wanted)
    _stand(obj, position, pose.rotation_deg)


def _free(settings: PropertyGroup) -> list[bool]:
    free = document.ticked_axes(settings)
    return [axis in free for axis in search.AXES]


def _set_free(settings: PropertyGroup, ticked: Sequence[bool]) -> None:
    free = [axis for axis, is_free in zip(search.AXES, ticked, strict=True) if is_free]
    document.put(settings, ("free",), None if free == list(search.PAPER_FREE) else free)


def _bounds(settings: PropertyGroup) -> dict[str, list[float]]:
    """Return the bounds of a sensor's axes, as its table has them."""
    return {
        axis: list(ends) for axis, ends in document.value_at(settings.table, BOUNDS, {}).items()
    }


def _bounded(settings: PropertyGroup) -> list[bool]:
    own = _bounds(settings)
    return [axis in own for axis in search.AXES]


def _set_bounded(settings: PropertyGroup, bounded: Sequence[bool]) -> None:
    """Bound axes, round the sensor's values at first, and no others."""
    pose = shown_pose(settings.id_data)
    values = (*pose.position, *pose.rotation_deg)
    own = _bounds(settings)
    ends = {}
    for axis, value, is_bounded in zip(search.AXES, values, bounded, strict=True):
        reach = REACH_M if axis in search.POSITION_AXES else REACH_DEG
        if is_bounded:
            ends[axis] = own.get(axis, [round(value - reach, 3), round(value + reach, 3)])
    document.put(settings, BOUNDS, ends or None)


def _ends(which: int) -> dict[str, Any]:
    """Return the callbacks of the lower (0) or upper (1) bounds of all axes; those of an axis that
    is not bounded are 0, and stay so."""

    def read(settings: PropertyGroup) -> list[float]:
        own = _bounds(settings)
        return [own[axis][which] if axis in own else 0.0 for axis in search.AXES]

    def write(settings: PropertyGroup, values: Sequence[float]) -> None:
        own = _bounds(settings)
        for axis, value in zip(search.AXES, values, strict=True):
            if axis in own:
                own[axis][which] = document.as_typed(value)
        document.put(settings, BOUNDS, own or None)

    return view(read, write)


def _color(settings: PropertyGroup) -> tuple[float, ...]:
    color = document.value_at(settings.table, COLOR)
    return (0.0, 0.0, 0.0) if color is None else graphics.rgb_of(color)


def _set_color(settings: PropertyGroup, color: Sequence[float]) -> None:
    document.put(settings, COLOR, graphics.color_text(color))


def _has_curve(settings: PropertyGroup) -> bool:
    return document.value_at(settings.table, CURVE) is not None


def _switch_curve(settings: PropertyGroup, on: bool) -> None:
    """Begin with the curve of the sensor's kind, or remove its own one."""
    if on != _has_curve(settings):
        entry = catalog.entries().get(settings.model)
        usual = None if entry is None else document.curve_table(entry.kind)
        document.put(settings, CURVE, (usual or {"a": 0.0, "b": 0.0}) if on else None)


def _kept(key: str, usual: Any) -> dict[str, Any]:
    """Return the callbacks of a value that stands in the table as it is, unless it is the usual."""
    return view(
        lambda settings: document.value_at(settings.table, (key,), usual),
        lambda settings, value: document.put(settings, (key,), None if value == usual else value),
    )


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


CurveFields: Any = table_group(
    pe.ApCurve, prefix="curve_", path_of=lambda key: own_path(*CURVE, key), is_explicit=True
)
SheetFields: Any = table_group(pe.DataSheet)


class PE_ObjectSettings(GroundPose, CurveFields, SheetFields, PropertyGroup):
    """What makes an object a sensor: views of its table, which is that of a study file; and its
    part in the last result."""

    table: text("Sensor", "The sensor as a study file has it, as JSON", options={"HIDDEN"})
    edge_x: text("X From", EDGE_ABOUT, search=_edge_names("x"), **_edge_of("x"))
    edge_y: text("Y From", EDGE_ABOUT, search=_edge_names("y"), **_edge_of("y"))
    edge_z: text("Height From", EDGE_ABOUT, search=_edge_names("z"), **_edge_of("z"))
    edge_distances: numbers(
        "Distances",
        "How far the optical centre is from these edges of the vehicle, along the axes of the "
        "ground frame; a negative distance puts it on the other side",
        3,
        subtype="XYZ",
        unit="LENGTH",
        precision=3,
        step=1,
        get=_distances,
        set=_set_distances,
    )
    edge_name: text(
        "Edge",
        "Name of the edge of the vehicle that the vertices of this object are; empty: none",
        update=redraw,
    )
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
        **view(
            lambda own: document.value_at(own.table, ("model",), DEFAULT_MODEL),
            lambda own, name: document.put(own, ("model",), name),
        ),
    )
    color: numbers(
        "Color",
        "Colour of this sensor in the panel, the 3D view, pictures, pages and exports",
        3,
        subtype="COLOR_GAMMA",
        min=0.0,
        max=1.0,
        update=recolored,
        **view(_color, _set_color),
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
        **_kept("fusion", ""),
    )
    own_curve: switch(
        "Own AP Curve",
        "Use the numbers below for this sensor instead of those of its kind. Sensors of"
        " one fusion group have the same curve",
        update=changed,
        **view(_has_curve, _switch_curve),
    )
    free: switches(
        "Free Axes",
        "Axes that the search may change",
        len(search.AXES),
        default=FREE_BY_DEFAULT,
        **view(_free, _set_free),
    )
    bounded: switches(
        "Bounded",
        "The axis has its own bounds in a search; otherwise those of the vehicle's outline",
        len(search.AXES),
        **view(_bounded, _set_bounded),
    )
    bounds_low: numbers(
        "From",
        "Lowest value that the search may try: metres, or degrees",
        len(search.AXES),
        precision=3,
        **_ends(0),
    )
    bounds_high: numbers(
        "To",
        "Highest value that the search may try: metres, or degrees",
        len(search.AXES),
        precision=3,
        **_ends(1),
    )
    mount: text(
        "Mount",
        "Mount of this sensor in a search; empty: a box of coordinates",
        search=mounts_of_scene,
        search_options={"SUGGESTION"},
        update=redraw,
        **_kept("mount", ""),
    )
    rack: text(
        "Rack",
        "Sensors with the same rack move as one in a search; the first by name leads",
        search=racks_of_scene,
        search_options={"SUGGESTION"},
        **_kept("rack", ""),
    )
    is_no_go: switch(
        "No-Go Area",
        "In a search, no part of a sensor may be in the box round this object",
        update=redraw,
    )
    options: rows("Models", "Models that a search may choose for this sensor", PE_SensorOption)
    stays: switch(
        "Stays",
        "A search leaves this sensor where it is, and those that follow it",
        **_kept("stays", False),
    )
    may_be_left_out: switch(
        "May Be Left Out",
        "A search may choose a design without this sensor",
        **_kept("may_be_left_out", False),
    )
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

    order: whole(
        "Order", "Its place in an imported study's rig", options={"HIDDEN"}, **_kept("order", 0)
    )

    mirror_of: text(
        "Mirror Of",
        "Name of the sensor that is linked as its mirror image",
        **_kept("mirror_of", ""),
    )

    is_view: switch("Is a View", "This camera shows the view of its parent sensor")

    body: menu(
        "Test Body",
        "What this object is: the 3D view says which sensors see such a body there. In a scenario "
        "of its own animation its size is that of the object",
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
        "One-way loss of a radar through this object; 0: it occludes radars",
        min=0.0,
        max=100.0,
        soft_max=10.0,
        update=changed,
    )
