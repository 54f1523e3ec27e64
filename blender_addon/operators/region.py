"""*Free Region*: where on its mount a sensor may go."""

from typing import Any

import bpy
from bpy.props import BoolProperty
from mathutils import Vector

from .. import document, signals
from ..engine import advice, jobs, pe
from ..queries import where_map
from .declared import OperatorResult, Refused, chosen_sensor, operator
from .edit_sensors import NAME
from .jobs import JobRow, Task, begin, of_study
from .mounts import put_on_mount
from .rows import new_row
from .where import FIGURE_AND_PLACES


def _lacks(context: bpy.types.Context) -> str | None:
    settings = context.scene.perception_entropy
    return "There is no vehicle yet" if settings.vehicle is None else None


@operator(
    "Free Region",
    mode="Sensors are placed in Object Mode",
    unless=_lacks,
    options=frozenset(),
    name=NAME,
    **FIGURE_AND_PLACES,
    others=BoolProperty(
        name="Search Others",
        description="Search the other sensors again at places outside, which takes minutes",
    ),
)
def free_region(context: bpy.types.Context, operator: Any) -> OperatorResult:
    """Find where on its mount this sensor may go while the score loses little and all limits
    hold"""
    name = chosen_sensor(context, operator.name).name
    asked = {key: getattr(operator, key) for key in ("figure", "others", "places")}
    return begin(REGION, sensor=name, **asked)


def _task(scene: bpy.types.Scene, study: pe.Study, _taken: document.Fingerprint) -> Task:
    asked = REGION.asked
    loss = scene.perception_entropy.view.region_loss
    options: dict[str, Any] = {"allowed": loss or None, "count": asked["places"] or None}
    options["search_others"] = asked["others"]
    job = jobs.RegionJob(study, asked["sensor"], asked["figure"], **options)

    def progressed(scene: bpy.types.Scene, job: jobs.RegionJob) -> None:
        if job.found is not None and job.found is not where_map.regions.get(scene.name):
            where_map.store_region(scene.name, job.found)

    def finish(scene: bpy.types.Scene, found: advice.FreeRegion) -> str:
        where_map.store_region(scene.name, found)
        return f"{found.sensor}: {found.extent or advice.region_lines(found)[0]}"

    return Task(job, finish, "result", progressed)


REGION = JobRow(read=of_study(_task), unfinished="Stopped before a place was scored")


def _no_region(context: bpy.types.Context) -> str | None:
    return None if where_map.regions.get(context.scene.name) else "Ask Free Region first"


@operator(
    "Use as Mount",
    mode="Mounts are added in Object Mode",
    unless=_no_region,
    signal=signals.study_changed,
)
def use_as_mount(context: bpy.types.Context) -> str:
    """Make the free region the mount of its sensor, as a mesh beside the vehicle: a search then
    stays inside"""
    scene = context.scene
    found = where_map.regions.get(scene.name)
    obj = None if found is None else scene.objects.get(found.sensor)
    if found is None or obj is None:
        raise Refused("The sensor of the region is gone")
    loss = scene.perception_entropy.view.region_loss
    found = found.allowing(loss) if loss > 0.0 else found
    mount = jobs.region_mount(found)
    row = new_row(scene, "mounts", f"{found.sensor} region")
    document.write_mount(scene, row, mount)
    context.view_layer.update()
    before = Vector(obj.matrix_world.translation)
    if not found.holds_sensor:  # the region errs to the safe side, and the sensor has to be on it
        put_on_mount(scene, context.evaluated_depsgraph_get(), obj, row.name)
    obj.perception_entropy.mount = row.name
    moved = (obj.matrix_world.translation - before).length
    note = f", moved {moved * 100.0:.0f} cm onto it" if moved else ""
    return f"{obj.name} is on {row.name}, {found.area:.2f} m2{note}"
