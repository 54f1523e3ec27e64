"""Render the review picture: the vehicle, its sensors, their beams and their score."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import bridge
from ..engine import pe
from .reports import REFUSALS, chosen_file, refuse, tell


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
            study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
            job = pe.ScoreJob(study)
            for _ in job:
                pass
            review.render_review(context.scene, study, job.outcome, path)
        except REFUSALS as error:
            return refuse(self, error)
        tell(self, "INFO", f"Wrote {path}")
        return {"FINISHED"}


CLASSES = (PE_OT_render_review,)
