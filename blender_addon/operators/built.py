"""*Compare Built Rig*: the rig of a calibration against the designed one, both drawn."""

from typing import Any

import bpy
from bpy.props import EnumProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from .. import document
from ..engine import advice, jobs, pe
from ..queries import where_map
from .declared import OperatorResult, Report, chosen_file, operator
from .imports import BY_NAME, FORMAT_OR_NAME, rig_of_file
from .jobs import JobRow, Task, begin, of_study


@operator(
    "Compare Built Rig",
    mode="Rigs are compared in Object Mode",
    options=frozenset(),
    bases=(ImportHelper,),
    filter_glob=StringProperty(default="*", options={"HIDDEN"}),
    format=EnumProperty(items=FORMAT_OR_NAME, name="Format", default=BY_NAME),
)
def compare_built(context: bpy.types.Context, operator: Any) -> OperatorResult:
    """Compare the built rig in another program's file with this one: how far each sensor is off,
    and what that costs. The scene stays as it is"""
    found = rig_of_file(context.scene, chosen_file(operator.filepath), operator.format)
    return begin(BUILT, rig=found.rig, lines=found.lines_without_models)


def _task(_scene: bpy.types.Scene, study: pe.Study, _taken: document.Fingerprint) -> Task:
    job = jobs.BuiltJob(study, BUILT.asked["rig"], BUILT.asked["lines"])

    def finish(scene: bpy.types.Scene, found: advice.AsBuilt) -> Report:
        where_map.store_built(scene.name, found)
        first, *more = advice.built_sensor_lines(found)
        worst = [advice.pair_text(pair) for pair in found.worst_first[:1]]
        level: Any = "WARNING" if found.fallen else "INFO"
        return Report("; ".join([first, *worst, *more]), level=level)

    return Task(job, finish, "result")


BUILT = JobRow(read=of_study(_task), unfinished="Stopped before the comparison was complete")
