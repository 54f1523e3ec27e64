"""The review: the picture of vehicle, sensors, beams and score, and the page to hand on."""

from __future__ import annotations

import shlex
from dataclasses import fields
from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import bridge
from ..engine import app, page, pe, studies
from .exporting import ExportJob, ExportOperator, ExportSteps, WrittenFiles
from .reports import chosen_file

SCORED, RENDERED = 0.25, 0.4
"""How much of an export is done when the score, and when the picture is there; nearly."""
RENDERING = "rendering"


def same_headless(path: Path, render: bool, about: page.About) -> str:
    """Return the command that makes a page of the file as it is saved; empty where it is not."""
    if not bpy.data.filepath or bpy.data.is_dirty:
        return ""
    options = ["review", "-o", path.parent.name or ".", *([] if render else ["--no-render"])]
    texts = {field.name: getattr(about, field.name) for field in fields(about)}
    options += [f"--{name}={text}" for name, text in texts.items() if text]
    file = shlex.quote(Path(bpy.data.filepath).name)
    return app.as_typed(f"blender -b {file} --command pe", options)


class PE_OT_render_review(ExportOperator, bpy.types.Operator):
    """Score the sensors where they are and render a picture of what they see (.png)"""

    bl_idname = "pe.render_review"
    bl_label = "Render Review"

    filename_ext = ".png"
    filter_glob: StringProperty(default="*.png", options={"HIDDEN"})

    def job(self, context: bpy.types.Context) -> ExportJob:
        """Read the scene; score and render it step by step."""
        path, scene = chosen_file(self.filepath), context.scene.name
        study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
        return ExportJob(study, lambda job: PE_OT_render_review.steps(job, path, scene))

    @staticmethod
    def steps(job: ExportJob, path: Path, scene: str) -> ExportSteps:
        """Score, then render: the latter in Blender's own turn."""
        from .. import review  # only who wants a picture pays for it

        outcome = yield from job.scored(SCORED)
        if outcome is None:
            return None
        yield pe.Progress(RENDERING, SCORED)
        if job.stopped:
            return None
        review.render_review(open_scene(scene), outcome.study, outcome, path)
        return WrittenFiles((path,))


class PE_OT_export_review(ExportOperator, bpy.types.Operator):
    """Score the sensors where they are and write a page to hand on (.html), with all they see"""

    bl_idname = "pe.export_review"
    bl_label = "Export Review"

    filename_ext = ".html"
    filter_glob: StringProperty(default="*.html", options={"HIDDEN"})
    render: BoolProperty(
        name="Rendered Picture",
        description="Have Blender render the picture at the head of the page",
        default=True,
    )
    title: StringProperty(name="Title", description="Of the page, in place of the file's name")
    author: StringProperty(name="Author", description="Who made it")
    date: StringProperty(
        name="Date", description='Any text; "today" is the day of the export. Empty: none'
    )
    revision: StringProperty(name="Revision", description="Of the page")

    def job(self, context: bpy.types.Context) -> ExportJob:
        """Read the scene; score, render and write the page step by step."""
        path, scene = chosen_file(self.filepath), context.scene.name
        about = page.About(self.title, self.author, self.date, self.revision)
        study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
        told = {
            "command": same_headless(path, self.render, about),
            "versions": bridge.blender_version(),
        }
        shown = scene if self.render else ""
        steps = PE_OT_export_review.steps  # the operator ends with its dialog
        pe.prepare_folder(path.parent)  # not refused after all the work
        return ExportJob(study, lambda job: steps(job, path, shown, told, about))

    @staticmethod
    def steps(
        job: ExportJob, path: Path, scene: str, told: dict[str, Any], about: page.About
    ) -> ExportSteps:
        """Score, render the picture of a scene, if one is wanted, and make the page in a thread."""
        from .. import review  # only who wants a page pays for it

        outcome = yield from job.scored(SCORED)
        if outcome is None:
            return None
        picture = None
        if scene:
            yield pe.Progress(RENDERING, SCORED)
            if job.stopped:
                return None
            picture = review.picture_of(open_scene(scene), outcome)
        one = page.Reviewed(path.stem, outcome, picture=picture, **told)
        watch = job.watch(RENDERED)
        made = yield from job.made("page", RENDERED, lambda: page.page_bytes([one], watch, about))
        if made is None:
            return None
        with studies.FileSet(path.parent, (path.name,)) as files:  # the dialog has asked
            files.add(path.name, made)
        return WrittenFiles((path,))


def open_scene(name: str) -> bpy.types.Scene:
    """Return a scene by its name.

    Raises
    ------
    InputError
        When it is gone.
    """
    scene = bpy.data.scenes.get(name)
    if scene is None:
        raise pe.InputError("export", "scene", "the scene that was scored", f"no {name!r} any more")
    return scene


CLASSES = (PE_OT_render_review, PE_OT_export_review)
