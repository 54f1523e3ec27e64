"""Exports: the study, the scene and the rig for other programs, the review picture and page.

What takes long is a job, whose files are written as one set at the end. A file
dialog's operator ends with it: the job then runs in an operator of its own.
"""

import shlex
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import document
from ..engine import app, exchange, jobs, outputs, page, pe
from ..processes import own_jobs
from ..processes.own_jobs import ExportJob, WrittenFiles
from . import running_job
from .declared import Answer, OperatorResult, Stopped, Told, chosen_file, operator
from .jobs import JobRow, Task, begin

STOPPED = "Stopped: nothing was written"
REPLACE = BoolProperty(
    name="Replace", description="Replace existing files of a folder", default=False
)
FORMAT_ITEMS = tuple(
    (row.name, row.title, "", k) for k, row in enumerate(exchange.RIG_FORMATS.values())
)


def _take_waiting(_context: bpy.types.Context) -> Task:
    job = EXPORT.asked.pop("job")
    return Task(job, lambda _scene, written: told_of(written), "written")


EXPORT = JobRow(read=_take_waiting, unfinished=STOPPED, of_scene=False)


def run(job: ExportJob, asked_in_window: bool) -> Answer:
    """Run an export: at once, or after a file dialog in an operator of its own."""
    if asked_in_window:
        begin(EXPORT, job=job)
        return None
    for _ in job:
        pass
    if job.written is None:
        raise Stopped(STOPPED)
    return told_of(job.written)


def told_of(written: WrittenFiles) -> Told:
    """Return the report of written files."""
    paths = written.paths
    return Told(f"Wrote {paths[0]}" if len(paths) == 1 else written.text, written.lines)


def _unless_running(_context: bpy.types.Context) -> str | None:
    busy = running_job.current is not None
    return "Another score, search or export is running; Esc stops it" if busy else None


def dialog(suffix: str, name: Callable[[Any], str] | None = None) -> dict[str, Any]:
    """Return what operators have that ask for a file to write. `suffix` is that of the file's name;
    without, the name says which format. `name` returns the first name."""

    def invoke(self: Any, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        self.asked_in_window = not bpy.app.background
        if name is not None:
            self.filepath = name(self)
        return ExportHelper.invoke(self, context, event)

    found = {"bases": (ExportHelper,), "invoke": invoke, "filename_ext": suffix}
    found |= {"options": frozenset(), "asked_in_window": False}
    if not suffix:
        return found | {"check_extension": None}
    return found | {"filter_glob": StringProperty(default=f"*{suffix}", options={"HIDDEN"})}


@operator("Export Study", **dialog(".toml"))
def export_study(context: bpy.types.Context, filepath: str) -> Told:
    """Write a study (.toml) and the vehicle's mesh (.npz) beside it"""
    path = chosen_file(filepath)
    study = document.study_as_drawn(context.scene)
    jobs.export_study(study, path, replace_study=True)  # the file dialog has confirmed it
    return told_of(WrittenFiles((path,)))


@operator(
    "Export Scene",
    unless=_unless_running,
    **dialog("", lambda self: outputs.scene_output(self.output).file),
    output=EnumProperty(
        items=tuple(
            (row.name, row.title, "", k) for k, row in enumerate(outputs.scene_outputs().values())
        ),
        name="Output",
        description="What to write",
    ),
    range_m=FloatProperty(
        name="Range",
        description="Length of the drawn fields of view; 0: the default of the output",
        default=0.0,
        min=0.0,
        subtype="DISTANCE",
    ),
    replace=REPLACE,
)
def export_scene(
    context: bpy.types.Context,
    filepath: str,
    output: str,
    range_m: float,
    replace: bool,
    asked_in_window: bool,
) -> Answer:
    """Write vehicle, sensors and fields of view for CAD, viewers and other programs"""
    row = outputs.scene_output(output)
    path = chosen_file(filepath)
    if not (row.has_several or path.suffix):
        path = path.with_suffix(Path(row.file).suffix)
    exchange.format_of_file(path, outputs.output_files(), row.name)  # refuses another's suffix
    study = document.study_from_scene(context.scene, context.evaluated_depsgraph_get())
    replace = replace or not row.has_several  # of one file the dialog has confirmed it

    return run(
        own_jobs.scene_job(study, row.name, path, range_m or None, replace=replace), asked_in_window
    )


@operator("Render Review", unless=_unless_running, **dialog(".svg"))
def render_review(context: bpy.types.Context, filepath: str, asked_in_window: bool) -> Answer:
    """Score the present sensors and write a picture of the rig (.svg)"""
    path = chosen_file(filepath)
    study = document.study_as_drawn(context.scene)
    jobs.prepare_folder(path.parent)  # fail before the work, not after

    return run(own_jobs.picture_job(study, path), asked_in_window)


@operator(
    "Export Review",
    unless=_unless_running,
    **dialog(".html"),
    title=StringProperty(name="Title", description="Title of the page instead of the file's name"),
    author=StringProperty(name="Author", description="Author of the page"),
    date=StringProperty(
        name="Date", description='Any text; "today" is the day of the export. Empty: none'
    ),
    revision=StringProperty(name="Revision", description="Revision of the page"),
)
def export_review(
    context: bpy.types.Context,
    filepath: str,
    title: str,
    author: str,
    date: str,
    revision: str,
    asked_in_window: bool,
) -> Answer:
    """Score the present sensors and write a page of the results (.html)"""
    path = chosen_file(filepath)
    about = page.About(title, author, date, revision)
    study = document.study_as_drawn(context.scene)
    facts: dict[str, Any] = {
        "name": name_of(context.scene, path),
        "command": headless_command(path, about),
        "versions": document.blender_version(),
    }
    jobs.prepare_folder(path.parent)  # fail before the work, not after
    search = searched_from(context.scene, study)

    return run(own_jobs.page_job(study, path, about, facts, search=search), asked_in_window)


def name_of(scene: bpy.types.Scene, path: Path) -> str:
    """Return the name of what a page is about: that of the chosen file; of the vehicle where the
    dialog proposed "untitled", as the .blend has no name."""
    vehicle = scene.perception_entropy.vehicle
    return path.stem if bpy.data.filepath or vehicle is None else vehicle.name


def searched_from(scene: bpy.types.Scene, study: pe.Study) -> own_jobs.SearchedFrom | None:
    """Return what the search began with that a study is the result of; None if it is of none."""
    settings = scene.perception_entropy
    result = settings.result
    if result is None or result.kind != "optimize" or settings.result_stale:
        return None
    poses = {
        name: pe.Pose.from_degrees(each["position"], each["rotation"])
        for name, each in result.placed_before.items()
    }
    if set(poses) != {sensor.name for sensor in study.rig}:
        return None
    rig = pe.Rig([sensor.moved(poses[sensor.name]) for sensor in study.rig])
    return own_jobs.SearchedFrom(study.with_rig(rig), result.data)


def headless_command(path: Path, about: page.About) -> str:
    """Return the command that makes the page from the saved file; empty if it is unsaved."""
    if not bpy.data.filepath or bpy.data.is_dirty:
        return ""
    options = ["review", "-o", path.parent.name or "."]
    texts = {field.name: getattr(about, field.name) for field in fields(about)}
    options += [f"--{name}={text}" for name, text in texts.items() if text]
    file = shlex.quote(Path(bpy.data.filepath).name)
    return app.as_typed(f"blender -b {file} --command pe", options)


def rig_file(name: str) -> str:
    """Return the usual name of a format's file, or of its folder."""
    row = exchange.rig_format(name)
    return f"{name}_rig" if row.is_folder else row.files[0]


@operator(
    "Export Rig",
    **dialog("", lambda self: rig_file(self.format)),
    format=EnumProperty(
        items=FORMAT_ITEMS,
        name="Format",
        description="The program and format to write for; by default that of the file's name",
    ),
    into=StringProperty(
        name="Into",
        description="File or folder of that format whose other content is kept; by default that "
        "which is replaced",
        subtype="FILE_PATH",
    ),
    replace=REPLACE,
)
def export_rig(
    context: bpy.types.Context,
    filepath: str,
    format: str,
    properties: Any,
    into: str,
    replace: bool,
    asked_in_window: bool,
) -> Answer:
    """Write the sensors for another program: URDF, ROS 2, Autoware, nuScenes, CARLA and others"""
    path = chosen_file(filepath)
    told = format if properties.is_property_set("format") or not path.suffix else None
    if told is not None and path.name in map(rig_file, exchange.RIG_FORMATS):
        path = path.with_name(rig_file(told))  # the dialog's own name, of another format
    name = exchange.format_of_file(path, exchange.FILES, told)
    row = exchange.rig_format(name)
    study = document.study_from_scene(context.scene, context.evaluated_depsgraph_get())
    replace = replace or not (row.beside or row.is_folder)  # of one file the dialog has asked
    target = bpy.path.abspath(into) or None
    if row.write_scene is not None:
        result = document.stored_result(context.scene, study)
        job = own_jobs.rig_job(study, name, path, target, replace=replace, result=result)
        return run(job, asked_in_window)
    return told_of(own_jobs.write_rig(study, name, path, target, replace=replace))


def unregister() -> None:
    """Drop the waiting job."""
    EXPORT.asked.clear()
