"""Score and optimize: one job, stepped by a timer in a window, or run to its end in a script."""

from __future__ import annotations

from typing import NamedTuple

import bpy

from .. import body, bridge, changes, explaining, roster, stale
from ..engine import pe
from . import running
from .known import known_score, remember
from .reports import REFUSALS, refuse, tell


class SceneJob(NamedTuple):
    """A job, and what its scene was when it was read."""

    job: pe.Job
    taken: bridge.Fingerprint


def is_undo(event: bpy.types.Event) -> bool:
    """Whether keys for undo or redo were pressed, which Blender ignores while a job runs."""
    return event.type == "Z" and event.value == "PRESS" and (event.ctrl or event.oskey)


class JobOperator:
    """What score and optimize share; a subclass makes the job and says what to report."""

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
            task = self._task(context)
            for _ in task.job:
                pass
            return self._apply(context.scene, task)
        except REFUSALS as error:
            return refuse(self, error)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Start, and let the window's timer do the rest."""
        if bpy.app.background:
            return self.execute(context)
        try:
            task = self._task(context)
        except REFUSALS as error:
            return refuse(self, error)
        running.begin(context, task.job)
        self.taken = task.taken
        context.window_manager.modal_handler_add(self)
        running.current.show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Give the job a turn; Esc asks it to stop, and once more to leave all as it was."""
        job, more = running.current, False
        if job is None:  # it was ended from outside
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS" and not event.is_repeat:
            job.stop()
            job.show(context)
            return {"RUNNING_MODAL"}
        if is_undo(event):
            job.refuse_undo(context)
            tell(self, "INFO", running.NO_UNDO)
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            more = job.step()
            if not more:
                scene = bpy.data.scenes.get(job.scene_name)
                return self._apply(scene, SceneJob(job.job, self.taken))
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

    def _task(self, context: bpy.types.Context) -> SceneJob:
        """Read the scene, and what tells it from others, at one time."""
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        vehicle = body.shared.read(scene, depsgraph).vehicle
        sensors = bridge.sensor_objects(scene)
        study = bridge.study_from_scene(scene, depsgraph, vehicle, sensors)
        taken = stale.fingerprint(scene, depsgraph, sensors)
        job = self.job_of(scene, study, taken)
        job.notes = bridge.missing_pieces(scene, sensors)  # what the scene lacks
        return SceneJob(job, taken)

    def _apply(self, scene: bpy.types.Scene | None, task: SceneJob) -> set[str]:
        """Write placements and result to the scene; undo takes both back in one step."""
        outcome = task.job.outcome
        if outcome is None:
            when = "Left as it was" if task.job.dropped else "Stopped before a score was complete"
            tell(self, "INFO", f"{when}: nothing was changed")
            return {"CANCELLED"}
        if scene is None:
            tell(self, "WARNING", "The scene is gone; its result was dropped")
            return {"CANCELLED"}
        gone = self.write(scene, outcome, task.taken)
        stale.check()  # it may have changed while it was worked on
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

    def job_of(self, scene: bpy.types.Scene, study: pe.Study, _taken: bridge.Fingerprint) -> pe.Job:
        """Score it, whatever is known: who presses the button wants it done."""
        return pe.ScoreJob(study)

    def write(
        self, scene: bpy.types.Scene, outcome: pe.Outcome, taken: bridge.Fingerprint
    ) -> list[str]:
        """Keep the result."""
        keep(scene, outcome, taken.text)
        bridge.keep_score(scene, outcome.study.rig, outcome.after, taken.surroundings)
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

    def job_of(self, scene: bpy.types.Scene, study: pe.Study, taken: bridge.Fingerprint) -> pe.Job:
        """Search, unless that is of no use; the start's score is not made again if it is known."""
        bridge.check_placeable(scene, study)
        return pe.OptimizeJob(study, before=known_score(scene, study, taken))

    def write(
        self, scene: bpy.types.Scene, outcome: pe.Outcome, taken: bridge.Fingerprint
    ) -> list[str]:
        """Keep what was found as a variant, then move the sensors; return names of lost ones.

        Undo takes back the move alone: the variant has an undo step of its own before it.
        """
        settings = scene.perception_entropy
        found = bridge.keep_search(scene, outcome, taken.surroundings)
        if bpy.ops.ed.undo_push.poll():  # a script without a window has no undo
            bpy.ops.ed.undo_push(message="Optimize: Keep Variant")
        goes_on = settings.has_result and settings.result_signature == taken.text
        first = settings.result_before if goes_on else outcome.before.entropy
        gone = bridge.place_rig(scene, outcome.study.rig, outcome.start.rig)
        keep(scene, outcome, taken.with_rig(outcome.study.rig).text)
        settings.result_before = first  # of searches in a row: where the first began
        bridge.choose_variant(scene, found)
        return gone

    def message(self, outcome: pe.Outcome) -> str:
        """Return the result in a line."""
        before, after = outcome.before.entropy, outcome.after.entropy
        best = "best so far, stopped early" if outcome.stopped else f"{outcome.evaluations} tried"
        return f"Perception entropy {before:.4f} to {after:.4f} nats ({best})"


def keep(scene: bpy.types.Scene, outcome: pe.Outcome, signature: str) -> None:
    """Keep a result in the scene, and its arrays for this session."""
    bridge.store_outcome(scene, outcome, signature, roster.sensors(scene))
    remember(scene, outcome, signature)
    explaining.look_round(scene, outcome, signature)
    changes.picture.tell()  # there is a ground map of all voxels now


class PE_OT_cancel(bpy.types.Operator):
    """Stop the search; the best placement so far is kept. Pressed again: all is left as it was"""

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
