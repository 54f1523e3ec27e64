"""Score and optimize: one job, stepped by a timer in a window, or run to its end in a script."""

from __future__ import annotations

import bpy

from .. import bridge
from ..engine import pe
from . import running
from .reports import REFUSALS, refuse, tell


class JobOperator:
    """What score and optimize share; a subclass names the job and says what to report."""

    job_class: type[pe.Job]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if running.current is not None:
            cls.poll_message_set("Another score or search is running; Esc stops it")
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set("Vehicles are scored in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run to the end, as scripts and Blender without a window do."""
        try:
            job = self._job(context)
            for _ in job:
                pass
            return self._apply(context.scene, job.outcome)
        except REFUSALS as error:
            return refuse(self, error)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Start, and let the window's timer do the rest."""
        if bpy.app.background:
            return self.execute(context)
        try:
            running.begin(context, self._job(context))
        except REFUSALS as error:
            return refuse(self, error)
        context.window_manager.modal_handler_add(self)
        running.current.show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Give the job a turn; Esc asks it to stop."""
        if event.type == "ESC" and event.value == "PRESS":
            running.current.stop()
            running.current.show(context)
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        job, more = running.current, False
        try:
            more = job.step()
            if not more:
                return self._apply(bpy.data.scenes.get(job.scene_name), job.job.outcome)
            job.show_soon(context)
            return {"PASS_THROUGH"}
        except REFUSALS as error:
            return refuse(self, error)
        finally:
            if not more:
                running.end(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """Called by Blender when the window or the file goes: nothing is kept."""
        running.end(context)

    def _job(self, context: bpy.types.Context) -> pe.Job:
        return self.job_class(
            bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
        )

    def _apply(self, scene: bpy.types.Scene | None, outcome: pe.Outcome | None) -> set[str]:
        """Write placements and result to the scene; undo takes both back in one step."""
        if outcome is None:
            tell(self, "INFO", "Stopped before a score was complete: nothing was changed")
            return {"CANCELLED"}
        if scene is None:
            tell(self, "WARNING", "The scene is gone; its result was dropped")
            return {"CANCELLED"}
        gone = self.write(scene, outcome)
        if gone:
            tell(self, "WARNING", f"No longer there, so not placed: {', '.join(gone)}")
        else:
            tell(self, "INFO", self.message(outcome))
        return {"FINISHED"}


class PE_OT_score(JobOperator, bpy.types.Operator):
    """Score the sensors where they are now"""

    bl_idname = "pe.score"
    bl_label = "Score"
    bl_options = {"REGISTER", "UNDO"}
    job_class = pe.ScoreJob

    def write(self, scene: bpy.types.Scene, outcome: pe.Outcome) -> list[str]:
        """Keep the result."""
        bridge.store_outcome(scene, outcome)
        bridge.keep_score(scene, outcome.study.rig, outcome.after)
        return []

    def message(self, outcome: pe.Outcome) -> str:
        """Return the result in a line."""
        score = outcome.after
        return f"Perception entropy {score.entropy:.4f} nats, coverage {score.coverage:.1%}"


class PE_OT_optimize(JobOperator, bpy.types.Operator):
    """Search for better places for the sensors, and move them there"""

    bl_idname = "pe.optimize"
    bl_label = "Optimize"
    bl_options = {"REGISTER", "UNDO"}
    job_class = pe.OptimizeJob

    def write(self, scene: bpy.types.Scene, outcome: pe.Outcome) -> list[str]:
        """Move the sensors and keep the result; return the names of those that are gone."""
        gone = bridge.place_rig(scene, outcome.study.rig)
        bridge.store_outcome(scene, outcome)
        bridge.keep_search(scene, outcome)
        return gone

    def message(self, outcome: pe.Outcome) -> str:
        """Return the result in a line."""
        before, after = outcome.before.entropy, outcome.after.entropy
        best = "best so far, stopped early" if outcome.stopped else f"{outcome.evaluations} tried"
        return f"Perception entropy {before:.4f} to {after:.4f} nats ({best})"


class PE_OT_cancel(bpy.types.Operator):
    """Stop the search; the best placement so far is kept"""

    bl_idname = "pe.cancel"
    bl_label = "Stop"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return running.current is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        running.current.stop()
        running.current.show(context)
        return {"FINISHED"}


CLASSES = (PE_OT_score, PE_OT_optimize, PE_OT_cancel)
