"""The review: the picture of vehicle, sensors, beams and score, and the page to hand on."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import bridge
from ..engine import app, page, pe
from .reports import REFUSALS, chosen_file, refuse, tell


@contextmanager
def waiting(context: bpy.types.Context) -> Iterator[Callable[[float], None]]:
    """Show by the mouse that Blender is at work, and how far; it takes no input meanwhile."""
    manager, window = context.window_manager, context.window
    if bpy.app.background or window is None:
        yield lambda _share: None
        return
    manager.progress_begin(0.0, 1.0)
    window.cursor_modal_set("WAIT")
    try:
        yield manager.progress_update
    finally:
        window.cursor_modal_restore()
        manager.progress_end()


def scored(context: bpy.types.Context, show: Callable[[float], None]) -> pe.Outcome:
    """Score the sensors where they are, on the scene's own voxels."""
    job = pe.ScoreJob(bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get()))
    for progress in job:
        show(progress.fraction)
    return job.outcome


def same_headless(path: Path, render: bool) -> str:
    """Return the command that makes a page of the file as it is saved; empty where it is not."""
    if not bpy.data.filepath or bpy.data.is_dirty:
        return ""
    options = ["review", "-o", path.parent.name or ".", *([] if render else ["--no-render"])]
    file = shlex.quote(Path(bpy.data.filepath).name)
    return app.as_typed(f"blender -b {file} --command pe", options)


class PE_OT_render_review(ExportHelper, bpy.types.Operator):
    """Score the sensors where they are and render a picture of what they see (.png)"""

    bl_idname = "pe.render_review"
    bl_label = "Render Review"

    filename_ext = ".png"
    filter_glob: StringProperty(default="*.png", options={"HIDDEN"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        from .. import review  # only who wants a picture pays for it

        try:
            path = chosen_file(self.filepath)
            with waiting(context) as show:
                outcome = scored(context, show)
                review.render_review(context.scene, outcome.study, outcome, path)
        except REFUSALS as error:
            return refuse(self, error)
        tell(self, "INFO", f"Wrote {path}")
        return {"FINISHED"}


class PE_OT_export_review(ExportHelper, bpy.types.Operator):
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

    def execute(self, context: bpy.types.Context) -> set[str]:
        from .. import review  # only who wants a page pays for it

        try:
            path = chosen_file(self.filepath)
            with waiting(context) as show:
                outcome = scored(context, show)
                picture = review.picture_of(context.scene, outcome) if self.render else None
                versions = bridge.blender_version()
                told = {"command": same_headless(path, self.render), "versions": versions}
                one = page.Reviewed(path.stem, outcome, picture=picture, **told)
                # The file dialog has asked whether to replace it.
                page.write_page([one], path.parent, name=path.name, replace=True)
        except REFUSALS as error:
            return refuse(self, error)
        tell(self, "INFO", f"Wrote {path}")
        return {"FINISHED"}


CLASSES = (PE_OT_render_review, PE_OT_export_review)
