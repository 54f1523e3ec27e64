"""Fix the cause of a warning, if there is a known fix: turn, move or scale the vehicle, ..."""

import math
from collections.abc import Callable, Iterable

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, FloatVectorProperty, StringProperty
from mathutils import Euler, Matrix, Vector

from .. import document, signals
from ..engine import geometry, pe, text
from .declared import operator
from .edit_sensors import rigid

AdviceAmount = tuple[float, float, float]
AMOUNT = text.Number(cap=1e6)
FACTOR = text.Number(1e-6, 1e6)
"""Amounts of a correction, and of a scale. Beyond single precision Blender ends at an undo."""
ON_VEHICLE_M = 0.5
"""A sensor this near to the vehicle's box goes with it when that is turned or moved."""
Fix = Callable[[bpy.types.Context, str, AdviceAmount], None]


def turn_vehicle(context: bpy.types.Context, _subject: str, amount: AdviceAmount) -> None:
    """Turn the vehicle about the vertical through the origin, counter-clockwise [deg]."""
    _transform_vehicle(context, Matrix.Rotation(math.radians(amount[0]), 4, "Z"))


def stand_vehicle(context: bpy.types.Context, _subject: str, amount: AdviceAmount) -> None:
    """Turn the vehicle about x, y and z [deg]; put it on the ground, its axis on the x axis."""
    turn = Euler([math.radians(each) for each in amount]).to_matrix()
    collection = _chosen_vehicle(context)
    depsgraph = context.evaluated_depsgraph_get()
    vehicle = document.vehicle_from_collection(collection, depsgraph)
    turned = vehicle.triangles @ np.array(turn).T
    shape = geometry.BodyShape(turned, vehicle.parts, vehicle.part_names)
    shift = (*shape.middle, shape.bounds[0][2])
    _transform_vehicle(context, Matrix.Translation(-Vector(shift)) @ turn.to_4x4())


def move_vehicle(context: bpy.types.Context, _subject: str, amount: AdviceAmount) -> None:
    """Move the vehicle [m]."""
    _transform_vehicle(context, Matrix.Translation(amount))


def scale_vehicle(context: bpy.types.Context, _subject: str, amount: AdviceAmount) -> None:
    """Scale the vehicle about the origin; the sensors keep their size."""
    factor = FACTOR.checked("fix", "amount", amount[0])
    _transform_vehicle(context, Matrix.Scale(factor, 4))


def roll_sensor(context: bpy.types.Context, subject: str, amount: AdviceAmount) -> None:
    """Turn a sensor about its viewing direction [deg]."""
    obj = _sensor_named(context, subject)
    obj.matrix_world = obj.matrix_world @ Matrix.Rotation(math.radians(amount[0]), 4, "X")


def apply_scale(context: bpy.types.Context, subject: str, _amount: AdviceAmount) -> None:
    """Set a sensor's scale to 1, also if its parents cause the scale."""
    obj = _sensor_named(context, subject)
    obj.matrix_world = rigid(obj.matrix_world)
    context.view_layer.update()


def metric_units(context: bpy.types.Context, _subject: str, _amount: AdviceAmount) -> None:
    """Set the scene's unit to one metre; no object is moved or scaled."""
    units = context.scene.unit_settings
    units.system = "METRIC"
    units.scale_length = 1.0
    units.length_unit = "METERS"


def show_vehicle(context: bpy.types.Context, _subject: str, _amount: AdviceAmount) -> None:
    """Make the vehicle's collection and its parent collections visible again."""
    vehicle = context.scene.perception_entropy.vehicle
    root = context.view_layer.layer_collection
    for layer in reversed(document.layers_of(root, vehicle)[:-1] if vehicle else []):
        layer.exclude = layer.hide_viewport = False
        layer.collection.hide_viewport = layer.collection.hide_render = False


FIXES: dict[str, tuple[str, Fix]] = {
    "turn_vehicle": ("Turn the Vehicle", turn_vehicle),
    "stand_vehicle": ("Stand on Wheels", stand_vehicle),
    "scale_vehicle": ("Scale the Vehicle", scale_vehicle),
    "move_vehicle": ("Move the Vehicle", move_vehicle),
    "roll_sensor": ("Turn It Upright", roll_sensor),
    "apply_scale": ("Apply Its Scale", apply_scale),
    "metric_units": ("Set Units to Metres", metric_units),
    "show_vehicle": ("Show the Vehicle", show_vehicle),
}
"""By the name of a fix: what its button says, and what it does."""
FIX_LABELS = {key: label for key, (label, _) in FIXES.items()}


def _check_again(context: bpy.types.Context) -> None:
    context.view_layer.update()
    context.scene.perception_entropy.warnings_json = ""


@operator(
    "Fix",
    mode="This is fixed in Object Mode",
    signal=signals.study_changed,
    fix=EnumProperty(
        items=[(key, label, label) for key, label in FIX_LABELS.items()],
        name="Fix",
        description="The correction",
    ),
    subject=StringProperty(name="Subject", description="Name of the sensor; empty: the vehicle"),
    amount=FloatVectorProperty(name="Amount", description="Amount of the correction", size=3),
)
def fix_warning(context: bpy.types.Context, fix: str, subject: str, amount: Iterable[float]) -> str:
    """Fix the cause of this warning. Sensors on the vehicle move with the vehicle"""
    x, y, z = (AMOUNT.checked("fix", "amount", each) for each in amount)
    label, act = FIXES[fix]
    act(context, subject, (x, y, z))
    _check_again(context)
    return f"{label}: done"


def _chosen_vehicle(context: bpy.types.Context) -> bpy.types.Collection:
    vehicle = context.scene.perception_entropy.vehicle
    if vehicle is None:
        raise pe.InputError("scene", "vehicle collection", "a collection", "none chosen")
    return vehicle


def _transform_vehicle(context: bpy.types.Context, change: Matrix) -> None:
    """Apply a transform to the vehicle's outermost objects and the sensors on the vehicle."""
    members = list(_chosen_vehicle(context).all_objects)
    outermost = [obj for obj in members if obj.parent not in members]
    for obj in outermost:
        if obj.library is not None:
            expected = "an object of this file"
            found = f"linked from {obj.library.filepath}"
            raise pe.InputError("scene", f"vehicle object {obj.name!r}", expected, found)
    carried = [obj for obj in _sensors_on(context, members) if not _follows(obj, outermost)]
    for obj in outermost:
        obj.matrix_world = change @ obj.matrix_world
    for obj in carried:
        location, rotation, _ = (change @ obj.matrix_world).decompose()
        obj.matrix_world = Matrix.LocRotScale(location, rotation, obj.matrix_world.to_scale())


def _sensors_on(
    context: bpy.types.Context, members: list[bpy.types.Object]
) -> list[bpy.types.Object]:
    """Return the sensors within half a metre of the vehicle's bounding box."""
    low, high = _bounds(members)

    def near(point: Vector) -> bool:
        return all(
            low[k] <= point[k] + ON_VEHICLE_M and point[k] - ON_VEHICLE_M <= high[k]
            for k in range(3)
        )

    sensors = document.sensor_objects(context.scene)
    return [obj for obj in sensors if near(obj.matrix_world.translation)]


def _follows(obj: bpy.types.Object, carried: list[bpy.types.Object]) -> bool:
    """Whether an object or one of its parents is among the moved objects."""
    while obj is not None:
        if obj in carried:
            return True
        obj = obj.parent
    return False


def _sensor_named(context: bpy.types.Context, name: str) -> bpy.types.Object:
    for obj in document.sensor_objects(context.scene):
        if obj.name == name:
            return obj
    raise pe.InputError("scene", "sensor", "one of the scene", repr(name))


def _bounds(members: Iterable[bpy.types.Object]) -> tuple[Vector, Vector]:
    """Return the lowest and the highest corner of the meshes [m]; of none, a box without points."""
    low = Vector((math.inf,) * 3)
    high = Vector((-math.inf,) * 3)
    for obj in members:
        for corner in obj.bound_box if obj.type == "MESH" else ():
            point = obj.matrix_world @ Vector(corner)
            low = Vector(map(min, low, point))
            high = Vector(map(max, high, point))
    return low, high


@operator(
    "Turn Round",
    mode="The vehicle is turned in Object Mode",
    unless=lambda context: "" if context.scene.perception_entropy.vehicle is None else None,
    signal=signals.study_changed,
    angle=FloatProperty(
        name="Angle",
        description="Angle about the vertical, counter-clockwise",
        default=math.pi,
        subtype="ANGLE",
    ),
)
def turn_round(context: bpy.types.Context, angle: float) -> None:
    """Turn the vehicle round where it is: front becomes rear. Sensors on it move with it"""
    low, high = _bounds(_chosen_vehicle(context).all_objects)
    middle = (low + high) / 2.0 if low.x <= high.x else Vector()
    around = Euler((0.0, 0.0, angle)).to_matrix().to_4x4()
    _transform_vehicle(context, Matrix.Translation(middle) @ around @ Matrix.Translation(-middle))
    _check_again(context)
