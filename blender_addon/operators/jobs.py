"""Jobs: one operator, a row a job. The engine's process runs it; without a window it runs at once.

A row says what to make from the scene and what to do with the result. Esc stops a job and gives the
window back at once: the best so far is placed and kept, its score and analysis come when the engine
has them.
"""

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import bpy

from .. import document, signals
from ..caches import result_staleness, vehicle_cache
from ..engine import advice, jobs, pe
from ..live import FinishedScore, live_state
from ..panel_text import typeset
from ..processes import engine_calls
from ..queries import diagnostics
from . import known_rigs, running_job
from .declared import (
    INTERNAL,
    UNDO,
    USER_ERRORS,
    Answer,
    Failed,
    OperatorMixin,
    OperatorResult,
    PollReason,
    Refused,
    Report,
    Stopped,
    declared,
    operator,
    report_answer,
    report_error,
)

DISCARDED = "Discarded: nothing was changed"


class Task(NamedTuple):
    """A job that was read from a scene.

    `finish` writes its result to the scene, `progressed` what it has found so far: it gets the job.
    `outcome` is the job's attribute of the result; None while there is nothing to keep. `rescue`
    keeps what a job had found that ended without a result. `place` keeps and places the best so far
    of a job that was stopped, before its result is there.
    """

    job: Any
    finish: Callable[[bpy.types.Scene, Any], Answer]
    outcome: str = "outcome"
    progressed: Callable[[bpy.types.Scene, Any], None] | None = None
    rescue: Callable[[bpy.types.Scene, Any], None] | None = None
    place: Callable[[bpy.types.Scene, Any], None] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class JobRow:
    """A job that a button starts, or another operator (`begin`)."""

    name: str = ""
    label: str = ""
    about: str = ""
    """Of its own operator: name, what the button says, and tooltip."""
    read: Callable[[bpy.types.Context], Task | None]
    """Reads the scene and makes the task; None where there is nothing to do."""
    unless: PollReason | None = None
    """Says why the job is not possible in a context."""
    show: Callable[[], object] | None = None
    """Called in a window once the job has ended, and where there is nothing to do."""
    unfinished: str = "Stopped before a score was complete: nothing was changed"
    """What is reported of a job that was stopped with nothing to keep."""
    options: frozenset[str] = UNDO
    of_scene: bool = True
    """Whether the result belongs to the scene, and is discarded with it."""
    asked: dict[str, Any] = field(default_factory=dict)
    """What another operator asked for last (`begin`)."""

    def declare(self) -> "JobRow":
        """Make the operator of the row."""
        given = {
            "__doc__": self.about,
            "bl_idname": f"pe.{self.name}",
            "bl_label": self.label,
            "bl_options": set(self.options),
            "row": self,
        }
        declared(type(f"PE_OT_{self.name}", (JobOperator, bpy.types.Operator), given))
        return self

    def finish(self, scene: bpy.types.Scene | None, task: Task, found: Any, job: Any) -> Answer:
        """Write what a job found to the scene; undo takes it back in one step."""
        if found is None:
            raise Stopped(DISCARDED if job.dropped else self.unfinished)
        if not self.of_scene:
            return task.finish(bpy.context.scene, found)
        if scene is None:
            raise Refused("The scene was removed; its result was discarded")
        with document.as_drawn(scene):  # sensors are placed as drawn
            answer = task.finish(scene, found)
            result_staleness.update_result()  # the scene may have changed meanwhile
        return answer


class JobOperator(OperatorMixin):
    """The operator of jobs."""

    row: ClassVar[JobRow]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = cls.row.unless and cls.row.unless(context)
        if running_job.current is not None:
            reason = "Another score, search or export is running; Esc stops it"
        elif cls.row.of_scene and context.mode != "OBJECT":
            reason = "Vehicles are scored in Object Mode"
        if reason:
            cls.poll_message_set(typeset(reason))
        return reason is None

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        """Run the job to its end, as scripts and Blender without a window do."""
        try:
            task = self.row.read(context)
            if task is None:
                return report_answer(self, None)
            for _ in task.job:
                pass
            found = getattr(task.job, task.outcome)
            return report_answer(self, self.row.finish(context.scene, task, found, task.job))
        except (Refused, *USER_ERRORS) as error:
            return report_error(self, error)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
        """Start the job, which the engine's process runs."""
        if bpy.app.background:
            return self.execute(context)
        try:
            task = self.row.read(context)
        except USER_ERRORS as error:
            return report_error(self, error)
        if task is None:
            return self._show()
        self.task = task
        self.running = running_job.begin(context, task.job, task.outcome)
        self.running.show(context)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        """Show how far the job is; Esc stops it. From then on all events are the window's own."""
        running = self.running
        has_window = running is running_job.current
        if not has_window and running not in running_job.stopped:  # it was ended from outside
            return {"CANCELLED"}
        if has_window and event.type == "ESC" and event.value == "PRESS":
            running.stop()
        elif has_window and event.type == "Z" and (event.ctrl or event.oskey):
            return {"RUNNING_MODAL"}  # undo would take back what the job is about to write
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        scene = bpy.data.scenes.get(running.scene_name)
        if self.task.progressed is not None and scene is not None:
            self.task.progressed(scene, running.seen)
        if running.ended:
            return self._end(context, scene)
        if not has_window:
            return {"PASS_THROUGH"}
        if not running.stopped:
            running.show_soon(context)
            return {"PASS_THROUGH"}
        running_job.release(context)
        if self.task.place is not None and scene is not None:
            with document.as_drawn(scene):
                self.task.place(scene, running.seen)
        return {"RUNNING_MODAL"}

    def _end(self, context: bpy.types.Context, scene: bpy.types.Scene | None) -> OperatorResult:
        """Write the result to the scene."""
        running = self.running
        try:
            lost = running.found is None and not running.seen.dropped
            if lost and scene is not None and self.task.rescue is not None:
                self.task.rescue(scene, running.seen)
            if running.error is not None:
                raise running.error
            report_answer(self, self.row.finish(scene, self.task, running.found, running.seen))
            return self._show()
        except (Refused, *USER_ERRORS) as error:
            return report_error(self, error)
        finally:
            running_job.end(context, running)

    def cancel(self, context: bpy.types.Context) -> None:
        """Called by Blender when the window or the file is closed: no result is kept."""
        running_job.end(context, self.running)

    def _show(self) -> OperatorResult:
        if self.row.show is not None:
            self.row.show()
        return {"FINISHED"}


@declared
class PE_OT_run_job(JobOperator, bpy.types.Operator):
    """Run the job that another operator has asked for"""

    bl_idname = "pe.run_job"
    bl_label = "Run Job"
    bl_options = {"INTERNAL"}
    row = JobRow(read=lambda _context: None, unless=lambda _context: "")  # until one is asked for


Make = Callable[[bpy.types.Scene, pe.Study, document.Fingerprint], Task]


def of_study(make: Make) -> Callable[[bpy.types.Context], Task]:
    """Return what reads the scene as drawn, its states, and its fingerprint at the same time.
    `make` gets scene, study and fingerprint."""

    def read(context: bpy.types.Context) -> Task:
        scene = context.scene
        with document.as_drawn(scene):
            document.read_states(scene)
            depsgraph = context.evaluated_depsgraph_get()
            vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
            sensors = document.sensor_objects(scene)
            study = document.study_from_scene(scene, depsgraph, vehicle, sensors)
            task = make(scene, study, result_staleness.fingerprint(scene, depsgraph, sensors))
            task.job.as_drawn = engine_calls.checker_of_study
            task.job.notes = document.missing_data(scene, sensors)  # what the scene lacks
            return task

    return read


def begin(row: JobRow, **asked: Any) -> OperatorResult:
    """Start a job from another operator, which raises what it reports; `row.asked` is set."""
    row.asked.update(asked)
    if running_job.current is None:  # else the operator says why it is not possible
        PE_OT_run_job.row = row
    try:
        return bpy.ops.pe.run_job("INVOKE_DEFAULT")
    except RuntimeError as error:
        raise Failed(str(error).strip().removeprefix("Error: ")) from None


def cached_score(
    scene: bpy.types.Scene, study: pe.Study, taken: document.Fingerprint
) -> pe.Score | None:
    """Return the score of a study as it was read from a scene, if it was made in this session. None
    for a prior of labelled boxes: their file may have changed since."""
    finished = live_state(scene.name).finished
    if finished is None or finished.signature != taken.text or study.prior.boxes is not None:
        return None
    return finished.score


def store_result(scene: bpy.types.Scene, outcome: jobs.Outcome, signature: str) -> None:
    """Store a result in the scene; keep its score for the views and for the next search."""
    document.store_outcome(scene, outcome, signature)
    live_state(scene.name).finished = FinishedScore(signature, outcome.study, outcome.after)
    diagnostics.explain_score(scene, outcome, signature)
    signals.view_changed.emit()  # there is a ground map of all voxels now


def score_task(_scene: bpy.types.Scene, study: pe.Study, taken: document.Fingerprint) -> Task:
    """Score the sensors, also where a score is cached: the button was pressed."""

    def finish(scene: bpy.types.Scene, outcome: jobs.Outcome) -> str:
        store_result(scene, outcome, taken.text)
        document.store_variant_scores(scene, outcome, taken.surroundings)
        if not bpy.app.background:
            known_rigs.request(scene, study, taken.surroundings)
        seen = advice.percent(outcome.after.coverage, 1)
        return f"Perception entropy {outcome.after.entropy:.3f} nats, coverage {seen}"

    return Task(jobs.ScoreJob(study), finish)


def optimize_task(scene: bpy.types.Scene, study: pe.Study, taken: document.Fingerprint) -> Task:
    """Search, if that is possible; the score of the start is not made again if it is cached."""
    document.check_placeable(scene, study)
    job = jobs.OptimizeJob(study, before=cached_score(scene, study, taken))

    before: document.StoredPlacements = {}
    placed: document.StoredPlacements = {}

    def finish(scene: bpy.types.Scene, outcome: jobs.Outcome) -> Report:
        if placed != (document.transforms(scene) if placed else {}):
            document.store_search(scene, outcome, taken.surroundings)
            return Report(f"{search_line(outcome)}: kept as a variant, as sensors were moved since")
        document.restore_transforms(scene, before)  # its undo step begins where the search began
        gone = store_search(scene, outcome, taken)
        if not gone:
            return Report(search_line(outcome))
        line = f"Sensors that were removed meanwhile are not placed: {', '.join(gone)}"
        return Report(line, level="WARNING")

    def rescue(scene: bpy.types.Scene, job: jobs.OptimizeJob) -> None:
        if job.best is not study:
            document.keep_rig(scene, "Best so far", job.best.rig)

    def place(scene: bpy.types.Scene, job: jobs.OptimizeJob) -> None:
        if job.best.rig == study.rig:
            return
        before.update(document.transforms(scene))
        with contextlib.suppress(pe.InputError):  # what holds a sensor is reported with the result
            keys = document.keep_search(scene, study, job.best.rig)
            place_variant(scene, keys, study.rig, best=job.best.rig)
            push_undo("Optimize")
        placed.update(document.transforms(scene))

    return Task(job, finish, rescue=rescue, place=place)


def place_variant(
    scene: bpy.types.Scene, keys: tuple[int, int], start: pe.Rig, best: pe.Rig
) -> list[str]:
    """Move the sensors from the start of a search to its best, which are kept as variants with
    these keys; return names of removed ones. Undo restores the poses only: the variants have an
    undo step of their own before it."""
    document.mark_active(scene, keys[0])
    push_undo("Optimize: Keep Variant")
    gone = document.place_rig(scene, best, start)
    document.mark_active(scene, keys[1])
    return gone


def store_search(
    scene: bpy.types.Scene, outcome: jobs.Outcome, taken: document.Fingerprint
) -> list[str]:
    """Keep start and best rig as variants with their scores, then move the sensors; return names of
    removed ones."""
    settings = scene.perception_entropy
    goes_on = settings.has_result and settings.result_signature == taken.text
    first = settings.result if goes_on else None
    best = outcome.study.rig
    keys = document.store_search(scene, outcome, taken.surroundings)
    gone = place_variant(scene, keys, outcome.start.rig, best=best)
    store_result(scene, outcome, taken.with_rig(best).text)
    if first is not None and first.kind == "optimize":  # of searches in a row
        document.begin_with(settings, first)
    return gone


def push_undo(name: str) -> None:
    """Make an undo step; a script without a window has no undo."""
    if bpy.ops.ed.undo_push.poll():
        bpy.ops.ed.undo_push(message=name)


def search_line(outcome: jobs.Outcome) -> str:
    """Return the result of a search in a line."""
    before = outcome.before.entropy
    after = outcome.after.entropy
    best = "best so far, stopped early" if outcome.stopped else f"{outcome.evaluations} tried"
    if outcome.in_traffic is not None:
        first, last = (each.ap for each in outcome.in_traffic)
        nats = f"perception entropy {before:.3f} to {after:.3f} nats"
        return f"Expected AP in traffic {first:.3f} to {last:.3f}, {nats} ({best})"
    change = outcome.change_text.replace("+-", "±")
    return f"Perception entropy {before:.3f} to {after:.3f} nats ({change}; {best})"


def front_task(scene: bpy.types.Scene, study: pe.Study, taken: document.Fingerprint) -> Task:
    """Search for a front, if there is something to choose; keep it as variants."""
    document.check_choosable(scene, study)

    def finish(scene: bpy.types.Scene, found: jobs.TradeOff) -> str:
        document.store_front(scene, found, taken.surroundings)
        signals.view_changed.emit()
        early = ", stopped early" if found.stopped else ""
        return f"{len(found.front)} designs on the Pareto front, kept as variants{early}"

    return Task(jobs.FrontJob(study), finish, "trade_off")


def check_task(scene: bpy.types.Scene, study: pe.Study, taken: document.Fingerprint) -> Task:
    """Check all requirements that the rig can be held to; verdicts are stored as they are found.
    After Esc those that were found before it are kept; a requirement that was changed meanwhile has
    no verdict."""
    if not study.requirements and not study.scenarios:
        raise pe.InputError("scene", "requirements", "at least one, or a scenario", "none")
    tables = {*document.requirements_key(scene.perception_entropy)}
    signatures = document.scenario_signatures(scene.perception_entropy, taken.text)
    document.store_verdicts(scene.perception_entropy, ())
    known = (0, 0)

    def store(scene: bpy.types.Scene, found: jobs.CheckJob | jobs.Checked) -> None:
        settings = scene.perception_entropy
        same = {name for name, _ in tables & {*document.requirements_key(settings)}}
        kept = [each for each in found.verdicts if each.name in same]
        document.store_verdicts(settings, kept, found.unchecked)
        document.store_driven(settings, found.driven, signatures)

    def progressed(scene: bpy.types.Scene, job: jobs.CheckJob) -> None:
        nonlocal known
        if known != (now := (len(job.verdicts), job.margins)):
            known = now
            store(scene, job)

    def finish(scene: bpy.types.Scene, found: jobs.Checked) -> Report:
        store(scene, found)
        missed = [verdict.name for verdict in found.verdicts if not verdict.met]
        missed += [driven.scenario.name for driven in found.driven if not driven.is_met]
        unchecked = [*found.unchecked, *found.missing]
        more = f"; not met: {', '.join(missed)}" if missed else ""
        more += f"; not checked: {', '.join(unchecked)}" if unchecked else ""
        of = len(found.verdicts) + len(found.driven)
        text = f"{of - len(missed)} of {of} requirements and scenarios are met{more}"
        return Report(text, level="WARNING" if missed or unchecked else "INFO")

    return Task(jobs.CheckJob(study, fitting=True), finish, "checked", progressed)


SCORE = JobRow(
    name="score",
    label="Score",
    about="Score the sensors at their present poses",
    read=of_study(score_task),
).declare()
OPTIMIZE = JobRow(
    name="optimize",
    label="Optimize",
    about="Search for better poses of the sensors, and move them there",
    read=of_study(optimize_task),
).declare()
FRONT = JobRow(
    name="choose_sensors",
    label="Choose Sensors",
    about="Find the Pareto front of price and entropy or of the chosen objectives; "
    "kept as variants",
    read=of_study(front_task),
    unfinished="Stopped before a design was complete: nothing was changed",
).declare()
CHECK = JobRow(
    name="check_requirements",
    label="Check Requirements",
    about="Hold the rig to all requirements that are switched on, with mounting errors and margins",
    read=of_study(check_task),
).declare()


@operator("Stop", unless=lambda _: "" if running_job.current is None else None, options=INTERNAL)
def cancel(context: bpy.types.Context) -> None:
    """Stop the search, keep the best placement so far: its score and analysis follow"""
    if running_job.current is not None:
        running_job.current.stop()
