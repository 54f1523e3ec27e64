"""Export and import: the study, the scene for other programs, the review picture and page."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import bridge, signals
from ..engine import app, exchange, jobs, outputs, page, pe
from ..language import shown
from .export_job import ExportJob, ExportOperator, ExportSteps, WrittenFiles, report_files
from .reports import (
    USER_ERRORS,
    OperatorResult,
    begin_in_results_folder,
    chosen_file,
    report,
    report_error,
)


class PE_OT_export_study(ExportHelper, bpy.types.Operator):
    """Write a study (.toml) and the vehicle's mesh (.npz) beside it"""

    bl_idname = "pe.export_study"
    bl_label = "Export Study"

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        begin_in_results_folder(self)
        return super().invoke(context, event)

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        try:
            path = chosen_file(self.filepath)
            study = bridge.study_as_drawn(context.scene)
            pe.export_study(study, path, replace_study=True)  # the file dialog has confirmed it
        except USER_ERRORS as error:
            return report_error(self, error)
        return report_files(self, path)


class PE_OT_import_study(ImportHelper, bpy.types.Operator):
    """Load a study into the scene: its vehicle, sensors, mounts, and search settings.

    A vehicle that is already the same stays"""

    bl_idname = "pe.import_study"
    bl_label = "Import Study"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Studies are imported in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        try:
            path = chosen_file(self.filepath)
            study = bridge.with_mesh_files_of(pe.load_study(path), path.parent)
            lost = bridge.load_into(context.scene, study)
        except USER_ERRORS as error:
            return report_error(self, error)
        signals.study_changed.emit()
        if lost:
            report(self, "WARNING", f"The scene differs from the file in: {', '.join(lost)}")
        else:
            report(self, "INFO", f"Imported {self.filepath} without any loss")
        return {"FINISHED"}


_OUTPUT_ITEMS = tuple(
    (row.name, row.title, "", k) for k, row in enumerate(outputs.scene_outputs().values())
)


class PE_OT_export_scene(ExportOperator, bpy.types.Operator):
    """Write vehicle, sensors and fields of view for CAD, viewers and other programs"""

    bl_idname = "pe.export_scene"
    bl_label = "Export Scene"

    filename_ext = ""
    check_extension = None
    output: EnumProperty(items=_OUTPUT_ITEMS, name="Output", description="What to write")
    range_m: FloatProperty(
        name="Range",
        description="Length of the drawn fields of view; 0: the default of the output",
        default=0.0,
        min=0.0,
        subtype="DISTANCE",
    )
    replace: BoolProperty(
        name="Replace", description="Replace existing files of a folder", default=False
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        self.filepath = outputs.scene_output(self.output).file
        return super().invoke(context, event)

    def job(self, context: bpy.types.Context) -> ExportJob:
        """Read the scene; its files are made on a thread."""
        row = outputs.scene_output(self.output)
        path = _with_ending(chosen_file(self.filepath), row)
        # Refuses the suffix of another output.
        exchange.format_of_file(path, outputs.output_files(), row.name)
        study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
        replace = self.replace or not row.has_several  # of one file the dialog has confirmed it
        reach = self.range_m or None
        steps = PE_OT_export_scene.steps  # the operator ends with its dialog
        return ExportJob(study, lambda job: steps(job, row, path, reach, replace))

    @staticmethod
    def steps(
        job: ExportJob, row: outputs.SceneOutput, path: Path, reach: float | None, replace: bool
    ) -> ExportSteps:
        """Make the files on a thread, then write them."""

        def work() -> tuple[Mapping[str, bytes], list[str]]:
            return outputs.scene_files(job.study, row.name, reach)

        made = yield from job.made(f"exporting {row.title}", 0.0, work)
        if made is None:
            return None
        files, lines = made
        paths = exchange.write_files(files, path, inside=row.has_several, replace=replace)
        return WrittenFiles(tuple(paths), tuple(lines))


def _with_ending(path: Path, row: outputs.SceneOutput) -> Path:
    """Return the path with the file extension of the output, if it has none."""
    return path if row.has_several or path.suffix else path.with_suffix(Path(row.file).suffix)


SCORED_SHARE = 0.25
"""About which share of an export is done after the score."""


def headless_command(path: Path, about: page.About) -> str:
    """Return the command that makes the page from the saved file; empty if it is unsaved."""
    if not bpy.data.filepath or bpy.data.is_dirty:
        return ""
    options = ["review", "-o", path.parent.name or "."]
    texts = {field.name: getattr(about, field.name) for field in fields(about)}
    options += [f"--{name}={text}" for name, text in texts.items() if text]
    file = shlex.quote(Path(bpy.data.filepath).name)
    return app.as_typed(f"blender -b {file} --command pe", options)


class PE_OT_render_review(ExportOperator, bpy.types.Operator):
    """Score the present sensors and write a picture of the rig (.png)"""

    bl_idname = "pe.render_review"
    bl_label = "Render Review"

    filename_ext = ".png"
    filter_glob: StringProperty(default="*.png", options={"HIDDEN"})

    def job(self, context: bpy.types.Context) -> ExportJob:
        """Read the scene; score and draw it step by step."""
        path = chosen_file(self.filepath)
        study = bridge.study_as_drawn(context.scene)
        pe.prepare_folder(path.parent)  # fail before the work, not after
        steps = PE_OT_render_review.steps  # the operator ends with its dialog
        return ExportJob(study, lambda job: steps(job, path))

    @staticmethod
    def steps(job: ExportJob, path: Path) -> ExportSteps:
        """Score, then make the picture in a thread."""
        outcome = yield from job.scored(SCORED_SHARE)
        if outcome is None:
            return None
        made = yield from job.made(
            "picture", SCORED_SHARE, lambda: page.picture_file(outcome.study, outcome)
        )
        return _written(path, made)


class PE_OT_export_review(ExportOperator, bpy.types.Operator):
    """Score the present sensors and write a page of the results (.html)"""

    bl_idname = "pe.export_review"
    bl_label = "Export Review"

    filename_ext = ".html"
    filter_glob: StringProperty(default="*.html", options={"HIDDEN"})
    title: StringProperty(name="Title", description="Title of the page instead of the file's name")
    author: StringProperty(name="Author", description="Author of the page")
    date: StringProperty(
        name="Date", description='Any text; "today" is the day of the export. Empty: none'
    )
    revision: StringProperty(name="Revision", description="Revision of the page")

    def job(self, context: bpy.types.Context) -> ExportJob:
        """Read the scene; score it and write the page step by step."""
        path = chosen_file(self.filepath)
        about = page.About(self.title, self.author, self.date, self.revision)
        study = bridge.study_as_drawn(context.scene)
        facts = {"command": headless_command(path, about), "versions": bridge.blender_version()}
        steps = PE_OT_export_review.steps  # the operator ends with its dialog
        pe.prepare_folder(path.parent)  # fail before the work, not after
        return ExportJob(study, lambda job: steps(job, path, facts, about))

    @staticmethod
    def steps(job: ExportJob, path: Path, facts: dict[str, Any], about: page.About) -> ExportSteps:
        """Score, then make the page in a thread."""
        outcome = yield from job.scored(SCORED_SHARE)
        if outcome is None:
            return None
        one = page.ReportContext(path.stem, outcome, **facts)
        watch = job.watch(SCORED_SHARE)
        made = yield from job.made(
            "page", SCORED_SHARE, lambda: page.page_bytes([one], watch, about)
        )
        return _written(path, made)


def _written(path: Path, made: bytes | None) -> WrittenFiles | None:
    """Write what was made; nothing where the export was stopped."""
    if made is None:
        return None
    with jobs.FileSet(path.parent, (path.name,)) as files:  # the dialog has confirmed it
        files.add(path.name, made)
    return WrittenFiles((path,))


CLASSES = (
    PE_OT_export_study,
    PE_OT_import_study,
    PE_OT_export_scene,
    PE_OT_render_review,
    PE_OT_export_review,
)
