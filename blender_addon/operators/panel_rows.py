"""Operators on rows of the panel: focus, own sensors, AP curves, models, axles, view settings."""

import math
from itertools import count

import bpy
from bpy.props import IntProperty

from .. import bridge, vehicle_cache
from ..choices import REGION_ITEMS
from ..engine import catalog, kinds, pe, search
from ..properties import DEFAULT_REGION
from ..sensor_kinds import own_kinds
from ..view_settings import FITTED
from .declared import INTERNAL, Refused, operator
from .rows import new_row, row_list

REGION_KINDS = tuple(sorted(REGION_ITEMS, key=lambda item: item[0] != DEFAULT_REGION))
"""Regions of a new focus, the usual one first."""


def add_focus(context: bpy.types.Context, region: str) -> str:
    """Add a weight for a region, or for some classes of objects"""
    taken = {row.name for row in context.scene.perception_entropy.focus}
    free = next(name for name in (f"Focus {n}" for n in count(1)) if name not in taken)
    row = new_row(context.scene, "focus", free)
    row.region = region
    return f"Added {row.name}"


def add_own_sensor(context: bpy.types.Context, kind: str) -> None:
    """Define your own sensor: a LiDAR by channels, view and range, or a camera by its pixels"""
    name = f"My {kinds.KINDS[kind].label}"
    row = new_row(context.scene, "own_sensors", name, set(catalog.entries()))
    row.kind = kind


def add_curves(context: bpy.types.Context, _kind: str) -> None:
    """Set your own AP curves; they start as the curves of each kind"""
    rows = context.scene.perception_entropy.curves
    for name, kind in kinds.KINDS.items():
        if name not in rows:
            row = rows.add()
            row.name = name
            row.a = kind.curve.a
            row.b = kind.curve.b


def of_sensor(context: bpy.types.Context) -> bpy.types.PropertyGroup:
    """Return the settings of the selected sensor. `Refused` where none is selected."""
    obj = context.active_object
    if obj is None or not obj.perception_entropy.is_sensor:
        raise Refused("Select a sensor")
    return obj.perception_entropy


def add_option(context: bpy.types.Context, _kind: str) -> None:
    """Add a model to the choices for this sensor: first its own model, then others"""
    settings = of_sensor(context)
    is_first = not settings.options
    settings.options.add().model = settings.model if is_first else ""


row_list("focus", "focus", add=add_focus, kinds=REGION_KINDS)
row_list(
    "own_sensors",
    "own sensor",
    add=add_own_sensor,
    kinds=lambda: [(name, label, about) for name, label, about, *_ in own_kinds(None, None)],
    loss="; sensors of this model can then no longer be scored",
)
row_list("curves", "AP curve", add=add_curves)
row_list("options", "model", add=add_option, owner=of_sensor)


BOUND_REACH = (0.5, 10.0)
"""New bounds are this far to either side of a sensor's value: metres, degrees."""


@operator(
    "Bound Axis",
    axis=IntProperty(name="Axis", description="x, y, z, roll, pitch, yaw", min=0, max=5),
)
def bound_axis(context: bpy.types.Context, axis: int) -> None:
    """Set bounds of the search around this sensor's value; press again to remove them"""
    settings = context.active_object.perception_entropy
    pose = bridge.pose_of(context.active_object, context.evaluated_depsgraph_get())
    settings.bounded[axis] = not settings.bounded[axis]
    if settings.bounded[axis]:
        middle = (*pose.position, *map(math.degrees, pose.rpy))[axis]
        reach = BOUND_REACH[search.AXES[axis] not in ("x", "y", "z")]
        settings.bounds_low[axis] = round(middle - reach, 3)
        settings.bounds_high[axis] = round(middle + reach, 3)


@operator("From Wheels")
def guess_axles(context: bpy.types.Context) -> str:
    """Find the axles from the vehicle's parts with wheel, tire or tyre in their names"""
    scene = context.scene
    vehicle = vehicle_cache.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
    reference = pe.guessed_reference(vehicle)
    if reference is None:
        raise pe.InputError("vehicle", "axles", "parts named as wheels, front and rear", "none")
    bridge.write_reference(scene.perception_entropy, reference)
    return f"Rear axle at x {reference.rear_axle_x:g} m, z {reference.rear_axle_z:g} m"


@operator("Fit Colors")
def fit_colors(context: bpy.types.Context) -> None:
    """Fit the range of the ground map's colours to what is shown now"""
    view = context.scene.perception_entropy.view
    view.ground_range = FITTED
    view.ground_fits += 1


@operator(
    "Compare Live With",
    options=INTERNAL,
    key=IntProperty(
        name="Key",
        description="0: the sensors before the last move; otherwise the key of a variant",
        options={"HIDDEN", "SKIP_SAVE"},
    ),
)
def live_against(context: bpy.types.Context, key: int) -> None:
    """Compare the live score with this reference"""
    context.scene.perception_entropy.live.against = key


def reference_label(scene: bpy.types.Scene) -> str:
    """Return what the live score of a scene is compared with, for the panel."""
    names = {row.key: row.name for row in scene.perception_entropy.variants}
    return names.get(scene.perception_entropy.live.against, "Before the Last Move")
