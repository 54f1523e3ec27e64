"""*Where?*: one more sensor scored all over the body, and put where one clicks."""

import math
from typing import Any

import bpy
from bpy.props import EnumProperty, IntProperty

from .. import document
from ..engine import catalog, jobs, kinds, pe
from ..queries import location_query, where_map
from ..sensor_kinds import mount_for
from ..view.housing import measured_housing
from .add_sensor import MODEL, new_sensor, select_only
from .declared import INTERNAL, OperatorResult, Refused, operator
from .jobs import JobRow, Task, begin, of_study
from .query_location import clicking

QUERY = "QUERY"
PLACES_SHOWN = "PLACES"
REGION_SHOWN = "REGION"
BUILT_SHOWN = "BUILT"
"""Answers that can be dismissed."""
WHOLE = "WHOLE"  # What is covered, where it is no mount
PICK = "Pick a Place: click the coloured body. Esc: cancel"
NEAR_M = 0.4  # A click takes the nearest place, if it is no farther away than this
FIGURE_AND_PLACES: dict[str, Any] = {
    "figure": EnumProperty(
        name="By",
        description="Figure of the rig by which places are compared",
        items=[
            (key, row.figure.label, row.figure.about) for key, row in jobs.PLACE_FIGURES.items()
        ],
    ),
    "places": IntProperty(
        name="Places",
        description="How many places are scored; 0: as many as take about 20 s",
        default=0,
        min=0,
        max=20_000,
    ),
}
"""Properties of operators that score a rig at many places."""
_listed: list[tuple[str, str, str]] = []
"""What the menu lists: Blender reads the texts after the function that made them returned."""


def _surfaces(_self: Any, _context: object) -> list[tuple[str, str, str]]:
    """Return the body and the mounts, as items of a Blender menu."""
    about = "This mount's surface, with its stand-off and orientation"
    mounts = [(row.name, row.name, about) for row in bpy.context.scene.perception_entropy.mounts]
    _listed[:] = [(WHOLE, "Whole Body", "All parts of the vehicle"), *mounts]
    return _listed


def _ask(self: Any, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
    if bpy.app.background:
        return self.execute(context)
    return context.window_manager.invoke_props_dialog(self)


def _lacks(context: bpy.types.Context) -> str | None:
    settings = context.scene.perception_entropy
    if settings.vehicle is None:
        return "There is no vehicle yet"
    return None if document.sensor_objects(context.scene) else "There are no sensors yet"


@operator(
    "Where?",
    mode="Sensors are placed in Object Mode",
    unless=_lacks,
    options=frozenset(),
    invoke=_ask,
    model=MODEL["model"],
    **FIGURE_AND_PLACES,
    on=EnumProperty(name="On", description="Surface that is covered", items=_surfaces),
)
def where(_context: bpy.types.Context, operator: Any) -> OperatorResult:
    """Score one more sensor all over the body: colours show where it is worth most"""
    asked = {name: getattr(operator, name) for name in ("model", "figure", "on", "places")}
    return begin(PLACES, **asked)


def _task(scene: bpy.types.Scene, study: pe.Study, _taken: document.Fingerprint) -> Task:
    asked = PLACES.asked
    model = catalog.load(asked["model"])
    name = asked["on"]
    sensor = pe.Sensor(kinds.kind_of(model).label, model)
    mount = "" if name == WHOLE else name
    study = document.with_mount(study, scene, bpy.context.evaluated_depsgraph_get(), mount)
    options: dict[str, Any] = {"mount": mount, "count": asked["places"] or None}
    job = jobs.WhereJob(study, sensor, asked["figure"], **options)
    seen = 0

    def progressed(scene: bpy.types.Scene, job: jobs.WhereJob) -> None:
        nonlocal seen
        if len(job.places) > 2 * seen and (found := job.found) is not None:
            seen = len(job.places)
            where_map.store(scene.name, found)

    def finish(scene: bpy.types.Scene, found: jobs.PlaceMap) -> str:
        where_map.store(scene.name, found)
        best = found.best()
        forbidden = f"Every place is forbidden: {', '.join(found.reasons())}"
        return f"Best place: {found.text(best[0].value or 0.0)}" if best else forbidden

    return Task(job, finish, "found", progressed)


PLACES = JobRow(read=of_study(_task), unfinished="Stopped before a place was scored")


def _lacks_map(context: bpy.types.Context) -> str | None:
    return None if where_map.maps.get(context.scene.name) else "Ask Where? first"


@operator(
    "Pick a Place",
    mode="Sensors are placed in Object Mode",
    unless=_lacks_map,
    **clicking(PICK, once=True, without=_lacks_map),
)
def take_place(context: bpy.types.Context, point: tuple[float, float, float]) -> str:
    """Click the coloured body: the sensor is put at the nearest place that was scored"""
    found = where_map.maps.get(context.scene.name)
    if found is None:
        raise Refused("Ask Where? first")
    near = min(found.places, key=lambda each: math.dist(each.point, point))
    if math.dist(near.point, point) > NEAR_M:
        raise Refused("Click the coloured surface")
    if near.value is None:
        raise Refused(f"Forbidden here: {near.reason}")
    obj = put(context, found.sensor.moved(near.pose))
    if found.mount:
        obj.perception_entropy.mount = found.mount
    return f"{obj.name}: {found.text(near.value)}"


def put(context: bpy.types.Context, sensor: pe.Sensor) -> bpy.types.Object:
    """Add a sensor of the catalogue to the scene at its pose, with its housing, and select it."""
    name = sensor.model.name
    body = measured_housing(name)
    obj = new_sensor(context, sensor.name, name, mount_for(sensor.model), body=body)
    document.place_poses(context.scene, {obj.name: sensor.pose})
    select_only(context, obj)
    return obj


@operator(
    "Dismiss",
    options=INTERNAL,
    answer=EnumProperty(
        name="Answer",
        description="What is removed",
        items=(
            (QUERY, "Location", "The answer of Query Location, and its mark"),
            (PLACES_SHOWN, "Places", "The colours of Where? on the body"),
            (BUILT_SHOWN, "Built Rig", "The built rig that is drawn beside this one"),
            (REGION_SHOWN, "Free Region", "The free region of a sensor"),
        ),
    ),
)
def dismiss(context: bpy.types.Context, answer: str) -> None:
    """Remove this answer from the 3D view"""
    if answer == QUERY:
        location_query.discard(context.scene)
    elif answer == BUILT_SHOWN:
        where_map.store_built(context.scene.name, None)
    elif answer == REGION_SHOWN:
        where_map.store_region(context.scene.name, None)
    else:
        where_map.store(context.scene.name, None)
