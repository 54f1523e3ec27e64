"""Render the review picture: the vehicle, its sensors, their beams and their score."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import bridge
from ..engine import pe
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
                study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
                job = pe.ScoreJob(study)
                for progress in job:
                    show(progress.fraction)
                review.render_review(context.scene, study, job.outcome, path)
        except REFUSALS as error:
            return refuse(self, error)
        tell(self, "INFO", f"Wrote {path}")
        return {"FINISHED"}


CLASSES = (PE_OT_render_review,)
