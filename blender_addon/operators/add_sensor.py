"""Add a sensor of the catalogue: the menus' entries, and the location of a new sensor."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, StringProperty
from mathutils import Vector

from .. import document
from ..engine import catalog, kinds, pe
from ..properties import DEFAULT_MODEL, model_suggestions
from ..sensor_kinds import Mount, mount_of
from ..view.housing import measured_housing
from .declared import INTERNAL, OperatorResult, operator
from .surface_pose import is_part

ROOF_DEPTH_M = 0.1  # Points this near to the vehicle's highest point belong to the roof
FRONT_INSET_M = 0.05  # How far behind the roof's front edge a camera is placed
DOWN = (0.0, 0.0, -1.0)
MODEL: dict[str, Any] = {
    "model": StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        default=DEFAULT_MODEL,
        search=model_suggestions,
        search_options=set(),
    ),
    "housing": BoolProperty(
        name="Housing",
        description="Show the sensor's own body in its true size, where a data sheet gives it",
        default=True,
    ),
}
"""Properties of operators that add a sensor."""


def default_location(context: bpy.types.Context, mount: Mount) -> Vector:
    """Return the 3D cursor; while that is at the origin, a location on the vehicle's roof."""
    cursor = context.scene.cursor.location
    collection = context.scene.perception_entropy.vehicle
    if cursor.length > 0.0:
        return cursor.copy()
    if collection is None:
        return Vector((0.0, 0.0, mount.height_m))
    depsgraph = context.evaluated_depsgraph_get()
    return Vector(roof_location(document.vehicle_from_collection(collection, depsgraph), mount))


def roof_location(vehicle: pe.Vehicle, mount: Mount) -> tuple[float, float, float]:
    """Return a location on the middle of the roof, or behind its front edge."""
    corners = vehicle.triangles.reshape(-1, 3)
    top = corners[:, 2].max()
    roof = corners[corners[:, 2] > top - ROOF_DEPTH_M]
    low = roof.min(axis=0)
    high = roof.max(axis=0)
    x, y = (low[:2] + high[:2]) / 2.0
    if mount.at_front:
        x = max(x, high[0] - FRONT_INSET_M)
    depth = float(vehicle.first_hit((x, y, top + 1.0), [DOWN]).distance[0])
    surface = top + 1.0 - depth if np.isfinite(depth) else top  # there may be a hole
    x, y, z = np.round((x, y, surface + mount.stand_off_m), 2).tolist()
    return x, y, z


@dataclass(frozen=True, slots=True)
class Offer:
    """A kind of sensor in the menus: its name, its label, its usual model."""

    kind: str
    label: str
    usual: str


def offers() -> Iterator[Offer]:
    """Yield the engine's kinds that have a model in the catalogue."""
    for kind in kinds.KINDS.values():
        models = catalog.names(kind.name)
        if models:
            usual = mount_of(kind.name).usual
            yield Offer(kind.name, kind.label, usual or models[0])


def models(kind: str | None) -> list[str]:
    """Return the names of sensors of a kind, or of all."""
    found = catalog.entries().values()
    return [e.name for e in found if e.kind in kinds.KINDS and kind in (None, e.kind)]


def tooltip_of(model: str) -> str:
    """Return a sensor of the catalogue in a few lines, for a tooltip; empty for an unknown name."""
    entry = catalog.entries().get(model)
    if entry is None:
        return ""
    loaded = catalog.load(model)
    lines = [" ".join(line.split()) for line in kinds.kind_of(loaded).data_sheet(loaded)]
    return "\n".join([model, *lines])


def with_data_sheet(about: str, chosen: bpy.types.OperatorProperties) -> str:
    """Return the tooltip of an operator that adds a sensor."""
    return f"{about}\n\n{tooltip_of(chosen.model)}"


@operator("Add Sensor", mode="Sensors are added in Object Mode", tooltip=with_data_sheet, **MODEL)
def add_sensor(context: bpy.types.Context, model: str, housing: bool) -> None:
    """Add a sensor at the 3D cursor, or on the roof while the cursor is at the origin"""
    kind = kinds.kind_of(catalog.load(model))
    mount = mount_of(kind.name)
    choose_vehicle(context.scene)
    location = default_location(context, mount)
    body = measured_housing(model) if housing else None
    obj = new_sensor(context, kind.label, model, mount, body=body)
    obj.location = location
    select_only(context, obj)


def choose_vehicle(scene: bpy.types.Scene) -> None:
    """Choose the only collection with meshes as the vehicle, if none has been chosen."""
    settings = scene.perception_entropy
    if settings.vehicle is None:
        solid = [
            child for child in scene.collection.children if any(map(is_part, child.all_objects))
        ]
        if len(solid) == 1:
            settings.vehicle = solid[0]


def new_sensor(
    context: bpy.types.Context,
    name: str,
    model: str,
    mount: Mount,
    body: bpy.types.Mesh | None = None,
) -> bpy.types.Object:
    """Create a sensor in the scene's collection of sensors: its `body` mesh, or an empty."""
    obj = bpy.data.objects.new(name, body)
    if body is None:
        obj.empty_display_type = mount.display
        obj.empty_display_size = mount.size_m
    document.shown_collection(context.scene).objects.link(obj)
    obj.perception_entropy.model = model
    obj.perception_entropy.is_sensor = True
    return obj


def select_only(context: bpy.types.Context, obj: bpy.types.Object) -> None:
    """Make an object the active one, and the only one that is selected."""
    for other in context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj


_listed: list[tuple[str, str, str, int]] = []
"""What the popup lists: Blender reads the texts after the function that made them returned."""


def menu_items(operator: Any, _context: object) -> list[tuple[str, str, str, int]]:
    """Return the catalogue's sensors of the operator's kind, as items of a Blender menu."""
    names = models(operator.kind or None)
    _listed[:] = [(n, n, tooltip_of(n), i) for i, n in enumerate(names)]
    return _listed


def _search(self: Any, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
    context.window_manager.invoke_search_popup(self)
    return {"FINISHED"}


@operator(
    "Search Sensors",
    options=INTERNAL,
    bl_property="model",
    invoke=_search,
    kind=StringProperty(name="Kind", description="Kind of sensors to list; all when empty"),
    model=EnumProperty(name="Model", description="Sensor of the catalogue", items=menu_items),
)
def search_sensor(_context: bpy.types.Context, model: str) -> OperatorResult:
    """Type a part of a sensor's name, such as QT128, and place it by pointing"""
    if not model:
        expected = "the name of a sensor of the catalogue"
        found = "an empty text"
        raise pe.InputError("search", "model", expected, found)
    return bpy.ops.pe.place_sensor("INVOKE_DEFAULT", True, model=model)
