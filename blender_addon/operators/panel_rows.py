"""Rows of focus, own sensors, AP curves and models; axles, and colours of the ground map."""

from itertools import count

import bpy

from .. import document
from ..caches import vehicle_cache
from ..choices import REGION_ITEMS
from ..engine import catalog, kinds, pe, studies
from ..properties import DEFAULT_REGION
from ..sensor_kinds import own_kinds
from ..view.view_settings import FITTED
from .declared import Refused, operator
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
    for name in kinds.KINDS:
        if name not in rows:
            rows.add().name = name


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


@operator("From Wheels")
def guess_axles(context: bpy.types.Context) -> str:
    """Find the axles from the vehicle's parts with wheel, tire or tyre in their names"""
    scene = context.scene
    vehicle = vehicle_cache.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
    reference = pe.guessed_reference(vehicle)
    if reference is None:
        raise pe.InputError("vehicle", "axles", "parts named as wheels, front and rear", "none")
    document.put(scene.perception_entropy, document.REFERENCE, studies.write(reference))
    return f"Rear axle at x {reference.rear_axle_x:g} m, z {reference.rear_axle_z:g} m"


@operator("Fit Colors")
def fit_colors(context: bpy.types.Context) -> None:
    """Fit the range of the ground map's colours to what is shown now"""
    view = context.scene.perception_entropy.view
    view.ground_range = FITTED
    view.ground_fits += 1
