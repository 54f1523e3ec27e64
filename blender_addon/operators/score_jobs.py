"""Score, optimize and choose sensors: one job, stepped by a timer in a window, or run at once.

Scripts and Blender without a window run the job to its end.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import bpy
from bpy.props import IntProperty

from .. import (
    bridge,
    diagnostics,
    requirement_checkers,
    result_staleness,
    sensor_cache,
    signals,
    vehicle_cache,
)
from ..engine import advice, app, pe
from ..language import shown
from ..live import FinishedScore, live_state
from . import running_job
from .reports import USER_ERRORS, OperatorMixin, OperatorResult, report, report_error


def cached_score(
    scene: bpy.types.Scene, study: pe.Study, taken: bridge.Fingerprint
) -> pe.Score | None:
    """Return the score of a study as it was read from a scene, if it was made in this session.

    None for a prior of labelled boxes: their file may have changed since.
    """
    finished = live_state(scene.name).finished
    if finished is None or finished.signature != taken.text or study.prior.boxes is not None:
        return None
    return finished.score


def cache_score(scene: bpy.types.Scene, outcome: pe.Outcome, signature: str) -> None:
    """Keep a job's score, for the views and for the next search."""
    finished = FinishedScore(signature, outcome.study, outcome.after)
    live_state(scene.name).finished = finished
    signals.view_changed.emit()


class SceneJob(NamedTuple):
    """A job, and the fingerprint of the scene that it was read from.

    The job is a `pe.Job`, or has what one has; outcomes are of different types.
    """

    job: Any
    taken: bridge.Fingerprint | None


def is_undo(event: bpy.types.Event) -> bool:
    """Whether the keys of undo or redo were pressed, which Blender ignores while a job runs."""
    return event.type == "Z" and event.value == "PRESS" and (event.ctrl or event.oskey)


class JobOperator(OperatorMixin):
    """What operators with a job share; a subclass makes the job and its message."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if running_job.current is not None:
            cls.poll_message_set(shown("Another score or search is running; Esc stops it"))
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Vehicles are scored in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        """Run the job to its end, as scripts and Blender without a window do."""
        try:
            task = self._task(context)
            for _ in task.job:
                pass
            return self._apply(context.scene, task)
        except USER_ERRORS as error:
            return report_error(self, error)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
        """Start the job; the window's timer steps it."""
        if bpy.app.background:
            return self.execute(context)
        try:
            task = self._task(context)
        except USER_ERRORS as error:
            return report_error(self, error)
        running_job.begin(context, task.job).show(context)
        self.taken = task.taken
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        """Step the job; Esc stops it, Esc once more discards all changes."""
        job, more = running_job.current, False
        if job is None:  # it was ended from outside
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS" and not event.is_repeat:
            job.stop()
            job.show(context)
            return {"RUNNING_MODAL"}
        if is_undo(event):
            job.refuse_undo(context)
            report(self, "INFO", running_job.NO_UNDO)
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            more = job.step()
            if not more:
                scene = bpy.data.scenes.get(job.scene_name)
                return self._apply(scene, SceneJob(job.job, self.taken))
            self.progressed(job)
            job.show_soon(context)
            return {"PASS_THROUGH"}
        except USER_ERRORS as error:
            return report_error(self, error)
        finally:
            if not more:
                running_job.end(context)

    def progressed(self, running: running_job.RunningJob) -> None:
        """Show what a job has found so far, where that is more than its progress."""

    def cancel(self, context: bpy.types.Context) -> None:
        """Called by Blender when the window or the file is closed: nothing is kept."""
        running_job.end(context)

    def _task(self, context: bpy.types.Context) -> SceneJob:
        """Read the scene as drawn, its states, and its fingerprint at the same time."""
        with bridge.as_drawn(context.scene):
            bridge.read_states(context.scene)
            return self._read(context)

    def _read(self, context: bpy.types.Context) -> SceneJob:
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
        sensors = bridge.sensor_objects(scene)
        study = bridge.study_from_scene(scene, depsgraph, vehicle, sensors)
        taken = result_staleness.fingerprint(scene, depsgraph, sensors)
        job = self.job_of(scene, study, taken)
        job.as_drawn = requirement_checkers.shared.of_study
        job.notes = bridge.missing_data(scene, sensors)  # what the scene lacks
        return SceneJob(job, taken)

    def _apply(self, scene: bpy.types.Scene | None, task: SceneJob) -> OperatorResult:
        """Write placements and result to the scene; undo takes both back in one step."""
        outcome = task.job.outcome
        if outcome is None:
            when = "Discarded" if task.job.dropped else "Stopped before a score was complete"
            report(self, "INFO", f"{when}: nothing was changed")
            return {"CANCELLED"}
        if scene is None:
            report(self, "WARNING", "The scene was removed; its result was discarded")
            return {"CANCELLED"}
        with bridge.as_drawn(scene):  # sensors are placed as drawn
            gone = self.write(scene, outcome, task.taken)
            result_staleness.update_result()  # the scene may have changed meanwhile
        if gone:
            report(
                self,
                "WARNING",
                f"Sensors that were removed meanwhile are not placed: {', '.join(gone)}",
            )
        else:
            report(self, "INFO", self.message(outcome))
        return {"FINISHED"}


class PE_OT_score(JobOperator, bpy.types.Operator):
    """Score the sensors at their present poses"""

    bl_idname = "pe.score"
    bl_label = "Score"
    bl_options = {"REGISTER", "UNDO"}

    def job_of(self, scene: bpy.types.Scene, study: pe.Study, _taken: bridge.Fingerprint) -> pe.Job:
        """Score it, also where a score is cached: the button was pressed."""
        return pe.ScoreJob(study)

    def write(
        self, scene: bpy.types.Scene, outcome: pe.Outcome, taken: bridge.Fingerprint
    ) -> list[str]:
        """Store the result."""
        store_result(scene, outcome, taken.text)
        bridge.store_variant_scores(scene, outcome.study.rig, outcome.after, taken.surroundings)
        return []

    def message(self, outcome: pe.Outcome) -> str:
        """Return the result in a line."""
        score = outcome.after
        return f"Perception entropy {score.entropy:.4f} nats, coverage {score.coverage:.1%}"


class PE_OT_optimize(JobOperator, bpy.types.Operator):
    """Search for better poses of the sensors, and move them there"""

    bl_idname = "pe.optimize"
    bl_label = "Optimize"
    bl_options = {"REGISTER", "UNDO"}

    def job_of(self, scene: bpy.types.Scene, study: pe.Study, taken: bridge.Fingerprint) -> pe.Job:
        """Search, if that is possible; the score of the start is not made again if it is cached."""
        bridge.check_placeable(scene, study)
        return pe.OptimizeJob(study, before=cached_score(scene, study, taken))

    def write(
        self, scene: bpy.types.Scene, outcome: pe.Outcome, taken: bridge.Fingerprint
    ) -> list[str]:
        """Keep the best rig as a variant, then move the sensors; return names of removed ones.

        Undo restores the poses only: the variant has an undo step of its own before it.
        """
        settings = scene.perception_entropy
        result_key = bridge.store_search(scene, outcome, taken.surroundings)
        if bpy.ops.ed.undo_push.poll():  # a script without a window has no undo
            bpy.ops.ed.undo_push(message="Optimize: Keep Variant")
        goes_on = settings.has_result and settings.result_signature == taken.text
        first = (
            (settings.result_before, settings.result_coverage_before, settings.result_blind[0])
            if goes_on and settings.result_kind == "optimize"
            else None
        )
        gone = bridge.place_rig(scene, outcome.study.rig, outcome.start.rig)
        store_result(scene, outcome, taken.with_rig(outcome.study.rig).text)
        if first is not None:  # of searches in a row: where the first began
            before, settings.result_coverage_before, settings.result_blind[0] = first
            settings.result_before = before
        bridge.mark_active(scene, result_key)
        return gone

    def message(self, outcome: pe.Outcome) -> str:
        """Return the result in a line."""
        before, after = outcome.before.entropy, outcome.after.entropy
        best = "best so far, stopped early" if outcome.stopped else f"{outcome.evaluations} tried"
        if outcome.in_traffic is not None:
            first, last = (each.ap for each in outcome.in_traffic)
            nats = f"perception entropy {before:.4f} to {after:.4f} nats"
            return f"Expected AP in traffic {first:.4f} to {last:.4f}, {nats} ({best})"
        return f"Perception entropy {before:.4f} to {after:.4f} nats ({best})"


def costs_nothing(settings: bpy.types.PropertyGroup) -> bool:
    """Whether the last search made nothing worse."""
    return advice.costs_nothing(settings.result_cost)


def store_result(scene: bpy.types.Scene, outcome: pe.Outcome, signature: str) -> None:
    """Store a result in the scene, and its arrays for this session."""
    bridge.store_outcome(scene, outcome, signature, sensor_cache.sensors(scene))
    cache_score(scene, outcome, signature)
    diagnostics.explain_score(scene, outcome, signature)
    signals.view_changed.emit()  # there is a ground map of all voxels now


class PE_OT_cancel(bpy.types.Operator):
    """Stop the search, keep the best placement so far. Pressed again: all changes are discarded"""

    bl_idname = "pe.cancel"
    bl_label = "Stop"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return running_job.current is not None

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        job = running_job.current
        if job is not None:
            job.stop()
            job.show(context)
        return {"FINISHED"}


class OptionOperator(OperatorMixin):
    """What operators on the active sensor's models share."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        if obj is None or not obj.perception_entropy.is_sensor:
            cls.poll_message_set(shown("Select a sensor"))
            return False
        return True


class PE_OT_add_option(OptionOperator, bpy.types.Operator):
    """Add a model to the choices for this sensor: first its own model, then others"""

    bl_idname = "pe.add_option"
    bl_label = "Add Model"

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.active_object.perception_entropy
        first = not settings.options
        option = settings.options.add()
        option.model = settings.model if first else ""
        return {"FINISHED"}


class PE_OT_remove_option(OptionOperator, bpy.types.Operator):
    """Remove this model from the choices"""

    bl_idname = "pe.remove_option"
    bl_label = "Remove Model"

    index: IntProperty(name="Index", description="Position of the model in the list", min=0)

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        options = context.active_object.perception_entropy.options
        if self.index >= len(options):
            report(self, "WARNING", "This model was already removed")
            return {"CANCELLED"}
        options.remove(self.index)
        return {"FINISHED"}


class PE_OT_choose_sensors(JobOperator, bpy.types.Operator):
    """Find the Pareto front of price and entropy or of the chosen objectives; kept as variants"""

    bl_idname = "pe.choose_sensors"
    bl_label = "Choose Sensors"
    bl_options = {"REGISTER", "UNDO"}

    def job_of(self, scene: bpy.types.Scene, study: pe.Study, _taken: bridge.Fingerprint) -> pe.Job:
        """Search, if there is something to choose."""
        bridge.check_choosable(scene, study)
        return app.front_job(study)

    def _apply(self, scene: bpy.types.Scene | None, task: SceneJob) -> OperatorResult:
        """Keep the Pareto front as variants; undo removes them in one step."""
        trade_off = task.job.trade_off
        if trade_off is None or scene is None or task.taken is None:
            report(self, "INFO", "Stopped before a design was complete: nothing was changed")
            return {"CANCELLED"}
        bridge.store_front(scene, trade_off, task.taken.surroundings)
        result_staleness.update_result()
        signals.view_changed.emit()
        early = ", stopped early" if trade_off.stopped else ""
        count = len(trade_off.front)
        report(self, "INFO", f"{count} designs on the Pareto front, kept as variants{early}")
        return {"FINISHED"}


CLASSES = (
    PE_OT_score,
    PE_OT_optimize,
    PE_OT_cancel,
    PE_OT_add_option,
    PE_OT_remove_option,
    PE_OT_choose_sensors,
)
