"""*Export*: one operator writes each format: study, review page, picture, film; rig and scene for
other programs.

A format is a row of `FORMATS`. What takes long is a job, whose files are written as one set at the
end. A file dialog's operator ends with it: the job then runs in an operator of its own.
"""

import contextlib
import shlex
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import document
from ..engine import app, exchange, jobs, outputs, page, pe
from ..processes import own_jobs
from ..processes.own_jobs import ExportJob, WrittenFiles
from ..view import film
from . import running_job
from .declared import (
    Answer,
    OperatorResult,
    PollReason,
    Refused,
    Report,
    Stopped,
    chosen_file,
    operator,
)
from .jobs import JobRow, Task, begin
from .rows import unless_selected

STOPPED = "Stopped: nothing was written"
BUSY = "Another score, search or export is running; Esc stops it"
RENDERING = "Another render is running; Esc stops it"
ABOUT_PAGE = ("title", "author", "date", "revision")


class Asked(NamedTuple):
    """What *Export* is asked for: the scene's context, the file or folder to write, and the
    operator, whose properties are its options."""

    context: bpy.types.Context
    path: Path
    options: Any

    @property
    def study(self) -> pe.Study:
        """The study of the scene as it is shown."""
        depsgraph = self.context.evaluated_depsgraph_get()
        return document.study_from_scene(self.context.scene, depsgraph)


def _always(_context: bpy.types.Context) -> None:
    """Nothing keeps a format from being written."""


@dataclass(frozen=True, kw_only=True)
class ExportFormat:
    """A format of *Export*.

    `title` is its entry in the menu, `file` the usual name of its file, or of its folder where it
    `has_folder`. `write` writes it. `options` are the properties of the operator that it has.
    `unless` says why it cannot be written now. One that is `named_after_scene` has the name of the
    .blend, not its usual one.
    """

    title: str
    file: str
    write: Callable[[Asked], Answer]
    options: tuple[str, ...] = ()
    unless: PollReason = _always
    has_folder: bool = False
    named_after_scene: bool = False

    @property
    def first_name(self) -> str:
        """The name that the file dialog proposes."""
        if not self.named_after_scene:
            return self.file
        return str(Path(bpy.data.filepath or "untitled").with_suffix(Path(self.file).suffix))


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


def told_of(written: WrittenFiles) -> Report:
    """Return the report of written files."""
    paths = written.paths
    return Report(f"Wrote {paths[0]}" if len(paths) == 1 else written.text, written.lines)


def _unless_running(_context: bpy.types.Context) -> str | None:
    return None if running_job.current is None else BUSY


def _unless_rendering(context: bpy.types.Context) -> str | None:
    """Why no film can be begun; None: one can."""
    if bpy.app.is_job_running("RENDER"):
        return RENDERING
    return unless_selected("scenarios")(context)


def _write_study(asked: Asked) -> Report:
    study = document.study_as_drawn(asked.context.scene)
    jobs.export_study(study, asked.path, replace_study=True)  # the file dialog has confirmed it
    return told_of(WrittenFiles((asked.path,)))


def _write_review(asked: Asked) -> Answer:
    path = asked.path
    about = page.About(*(getattr(asked.options, name) for name in ABOUT_PAGE))
    scene = asked.context.scene
    study = document.study_as_drawn(scene)
    facts: dict[str, Any] = {
        "name": name_of(scene, path),
        "command": headless_command(path, about),
        "versions": document.blender_version(),
    }
    jobs.prepare_folder(path.parent)  # fail before the work, not after
    search = searched_from(scene, study)

    job = own_jobs.page_job(study, path, about, facts, search=search)
    return run(job, asked.options.asked_in_window)


def _write_picture(asked: Asked) -> Answer:
    study = document.study_as_drawn(asked.context.scene)
    jobs.prepare_folder(asked.path.parent)  # fail before the work, not after
    return run(own_jobs.picture_job(study, asked.path), asked.options.asked_in_window)


def _write_film(asked: Asked) -> str:
    scene = asked.context.scene
    settings = scene.perception_entropy
    scenario = document.scenario_of(settings.scenarios[settings.scenario_index])
    study = document.study_as_drawn(scene)
    if bpy.app.background or not asked.options.asked_in_window:
        film.write_film(scene, study, scenario, asked.path)
        return f"Wrote {asked.path}"
    film.FilmRender(scene, study, scenario, asked.path)
    return "Rendering: Esc ends it, and keeps what is done"


def _write_scene(name: str, asked: Asked) -> Answer:
    row = outputs.scene_output(name)
    replace = asked.options.replace or not row.has_several  # of one file the dialog has asked
    reach = asked.options.range_m or None
    job = own_jobs.scene_job(asked.study, name, asked.path, reach, replace=replace)
    return run(job, asked.options.asked_in_window)


def _write_rig(name: str, asked: Asked) -> Answer:
    row = exchange.rig_format(name)
    study = asked.study
    replace = asked.options.replace or not (row.beside or row.is_folder)  # as `_write_scene`
    target = bpy.path.abspath(asked.options.into) or None
    if row.write_scene is not None:
        result = document.stored_result(asked.context.scene, study)
        job = own_jobs.rig_job(study, name, asked.path, target, replace=replace, result=result)
        return run(job, asked.options.asked_in_window)
    return told_of(own_jobs.write_rig(study, name, asked.path, target, replace=replace))


def _of_rig(name: str) -> ExportFormat:
    row = exchange.rig_format(name)
    return ExportFormat(
        title=row.title,
        file=f"{name}_rig" if row.is_folder else row.files[0],
        write=partial(_write_rig, name),
        options=("into", "replace"),
        unless=_unless_running if row.write_scene is not None else _always,
        has_folder=row.is_folder,
    )


def _of_scene(name: str) -> ExportFormat:
    row = outputs.scene_output(name)
    return ExportFormat(
        title=row.title,
        file=row.file,
        write=partial(_write_scene, name),
        options=("range_m", "replace") if row.has_range else ("replace",),
        unless=_unless_running,
        has_folder=row.has_several,
    )


FORMATS = {
    "study": ExportFormat(
        title="Study (.toml)", file="study.toml", write=_write_study, named_after_scene=True
    ),
    "review": ExportFormat(
        title="Review Page (.html)",
        file="review.html",
        write=_write_review,
        options=ABOUT_PAGE,
        unless=_unless_running,
        named_after_scene=True,
    ),
    "film": ExportFormat(
        title="Film of the Selected Scenario",
        file=f"drive_by{film.WEBM}",
        write=_write_film,
        unless=_unless_rendering,
    ),
    **{name: _of_rig(name) for name in exchange.RIG_FORMATS},
    **{name: _of_scene(name) for name in outputs.scene_outputs()},
    "picture": ExportFormat(
        title="Picture (.svg)",
        file="rig.svg",
        write=_write_picture,
        unless=_unless_running,
        named_after_scene=True,
    ),
}
"""What *Export* writes, by the format's name, as ``pe export --to`` has it."""
FILES = {name: row.file for name, row in FORMATS.items() if not row.has_folder}


def _propose(self: Any, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
    """Open the file dialog; refuse at once what cannot be written now. A name that a script gives
    tells the format."""
    if self.filepath and not self.properties.is_property_set("format"):
        with contextlib.suppress(pe.InputError):  # of a name that tells none the dialog decides
            self.format = exchange.format_of_file(Path(self.filepath), FILES)
    row = FORMATS[self.format]
    reason = row.unless(context)
    if reason:
        self.report({"WARNING"}, reason)
        return {"CANCELLED"}
    self.asked_in_window = not bpy.app.background
    if Path(self.filepath).suffix != Path(row.file).suffix:  # of none, or the last one's format
        self.filepath = str(Path(self.filepath).parent / row.first_name)
    return ExportHelper.invoke(self, context, event)


def _draw(self: Any, _context: bpy.types.Context) -> None:
    """Draw the format, and the options that it has."""
    self.layout.prop(self, "format")
    for name in FORMATS[self.format].options:
        self.layout.prop(self, name)


def _about_format(about: str, chosen: bpy.types.OperatorProperties) -> str:
    return f"{about}: {FORMATS[chosen.format].title}"


@operator(
    "Export",
    bases=(ExportHelper,),
    invoke=_propose,
    draw=_draw,
    options=frozenset(),
    tooltip=_about_format,
    filename_ext="",
    check_extension=None,
    asked_in_window=False,
    format=EnumProperty(
        items=tuple((name, row.title, "", k) for k, (name, row) in enumerate(FORMATS.items())),
        name="Format",
        description="The format to write; by default that of the file's name",
    ),
    range_m=FloatProperty(
        name="Range",
        description="Length of the drawn fields of view; 0: the default of the output",
        default=0.0,
        min=0.0,
        subtype="DISTANCE",
    ),
    into=StringProperty(
        name="Into",
        description="File or folder of that format whose other content is kept; by default that "
        "which is replaced",
        subtype="FILE_PATH",
    ),
    replace=BoolProperty(
        name="Replace", description="Replace existing files of a folder", default=False
    ),
    title=StringProperty(name="Title", description="Title of the page instead of the file's name"),
    author=StringProperty(name="Author", description="Author of the page"),
    date=StringProperty(
        name="Date", description='Any text; "today" is the day of the export. Empty: none'
    ),
    revision=StringProperty(name="Revision", description="Revision of the page"),
)
def export_file(context: bpy.types.Context, filepath: str, operator: Any) -> Answer:
    """Write the study, its results, or its rig for another program"""
    path = chosen_file(filepath)
    told = operator.format if operator.properties.is_property_set("format") else None
    if told is not None:
        path = _named(path, FORMATS[told])
    name = exchange.format_of_file(path, FILES, told)
    row = FORMATS[name]
    if reason := row.unless(context):
        raise Refused(reason)
    return row.write(Asked(context=context, path=path, options=operator))


def _named(path: Path, row: ExportFormat) -> Path:
    """Return a path with the name that its format has: a name that the dialog proposed for another
    format is changed, and a file without a suffix gets one."""
    if path.name != row.file and path.name in {each.file for each in FORMATS.values()}:
        return path.with_name(row.file)
    if row.has_folder or path.suffix:
        return path
    return path.with_suffix(Path(row.file).suffix)


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


def unregister() -> None:
    """Drop the waiting job."""
    EXPORT.asked.clear()
