"""Requirements in the panel: add a preset or an own one, remove, check; look at the worst place."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import bpy
from bpy.props import EnumProperty, IntProperty

from .. import bridge, signals, vehicle_cache
from ..choices import free_name
from ..engine import jobs, pe, requirements, studies, wording
from ..overlay.layer_cache import shown
from ..overlay.requirement_zones import VerdictShape
from . import running_job
from .list_rows import RemoveRow, SelectedRow
from .reports import USER_ERRORS, OperatorResult, report, report_error
from .score_jobs import JobOperator, SceneJob

OWN, ALL = "OWN", "ALL"
LOOK_FROM_M = 9.0
"""Distance of the view from the worst place."""


def _citation(source_name: str, confidence: str) -> str:
    """Return a source as a tooltip; its own text stays English, as it is cited."""
    return f"{source_name} (confidence {confidence})"


PRESETS = (
    (OWN, "Own Requirement", "An adult ahead of the vehicle, to be changed below"),
    *(
        (each.id, f"{each.check}: {each.name}", _citation(each.source, each.confidence))
        for each in studies.requirement_file.presets().values()
    ),
    (ALL, "All Presets", "Each preset that the rig can be held to"),
)


class ShownVerdict(NamedTuple):
    """A verdict as the panel shows it: met, not met (False) or unknown (None), and its margin."""

    met: bool | None
    margin: str
    sentence: str
    preview: bool = False


class PE_OT_add_requirement(bpy.types.Operator):
    """Hold the rig to a requirement: a preset with its source, or one of your own"""

    bl_idname = "pe.add_requirement"
    bl_label = "Add Requirement"
    bl_options = {"REGISTER", "UNDO"}
    bl_property = "preset"

    preset: EnumProperty(items=PRESETS, name="Preset", description="What has to be met")

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        if self.preset == ALL:
            return self.add_all(context)
        name = _add(settings, *_requirement(self.preset))
        settings.requirement_index = len(settings.requirements) - 1
        signals.study_changed.emit()
        report(self, "INFO", f"Added {name}")
        return {"FINISHED"}

    def add_all(self, context: bpy.types.Context) -> OperatorResult:
        """Add each preset that the rig can be held to and that is not in the list yet."""
        settings = context.scene.perception_entropy
        present = {bridge.preset_of(row) for row in settings.requirements}
        wanted = [each for each in studies.requirement_file.presets() if each not in present]
        try:
            study = bridge.study_from_scene(*_read(context))
        except USER_ERRORS as error:
            return report_error(self, error)
        made = dict(_requirement(each) for each in wanted)
        fitting, reasons = _checkable(study, list(made))
        for each in fitting:
            _add(settings, each, made[each])
        signals.study_changed.emit()
        first, *_ = [*reasons.items(), ("", "")]
        more = f"; left out {len(reasons)}, as {first[0]}: {first[1]}" if reasons else ""
        report(self, "INFO", f"Added {len(fitting)} requirements{more}")
        return {"FINISHED"}


class RequirementRow(SelectedRow):
    """What operators on the selected requirement share."""

    ROWS, INDEX, NOUN = "requirements", "requirement_index", "requirement"


class PE_OT_remove_requirement(RequirementRow, RemoveRow, bpy.types.Operator):
    """Remove the requirement that is selected in the list"""

    bl_idname = "pe.remove_requirement"
    bl_label = "Remove Requirement"
    bl_options = {"REGISTER", "UNDO"}


class PE_OT_copy_requirement(RequirementRow, bpy.types.Operator):
    """Add a copy of the selected requirement below it"""

    bl_idname = "pe.copy_requirement"
    bl_label = "Copy Requirement"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        rows, number = settings.requirements, settings.requirement_index
        name, table, enabled = (getattr(rows[number], k) for k in ("name", "table", "enabled"))
        row = rows.add()
        row.name = free_name(name, {each.name for each in rows})
        row.table, row.enabled = table, enabled
        rows.move(len(rows) - 1, number + 1)
        settings.requirement_index = number + 1
        signals.study_changed.emit()
        report(self, "INFO", f"Added {rows[number + 1].name}")
        return {"FINISHED"}


class PE_OT_move_requirement(RequirementRow, bpy.types.Operator):
    """Move the selected requirement in the list: tables and pages have this order"""

    bl_idname = "pe.move_requirement"
    bl_label = "Move Requirement"
    bl_options = {"REGISTER", "UNDO"}

    step: IntProperty(name="Step", description="-1: up; 1: down", default=-1, min=-1, max=1)

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        rows, number = settings.requirements, settings.requirement_index
        target = number + self.step
        if not 0 <= target < len(rows):
            return {"CANCELLED"}
        rows.move(number, target)
        settings.requirement_index = target
        signals.study_changed.emit()
        return {"FINISHED"}


class PE_OT_check_requirements(JobOperator, bpy.types.Operator):
    """Hold the rig to all requirements that are switched on, with mounting errors and margins"""

    bl_idname = "pe.check_requirements"
    bl_label = "Check Requirements"
    bl_options = {"REGISTER", "UNDO"}

    def job_of(self, scene: bpy.types.Scene, study: pe.Study, _taken: bridge.Fingerprint) -> pe.Job:
        """Check all that the rig can be held to; the rows have no verdicts until it found them."""
        if not study.requirements:
            raise pe.InputError("scene", "requirements", "at least one", "none")
        settings = scene.perception_entropy
        self.tables = bridge.requirements_key(settings)
        self.stored = 0
        bridge.store_verdicts(settings, ())
        return jobs.CheckJob(study, fitting=True)

    def progressed(self, running: running_job.RunningJob) -> None:
        """Store the verdicts that were found since the last time."""
        scene = bpy.data.scenes.get(running.scene_name)
        if scene is not None and len(running.job.verdicts) > self.stored:
            self._store(scene, running.job)

    def _store(self, scene: bpy.types.Scene, job: jobs.CheckJob) -> None:
        """Store what was found; a requirement that was changed meanwhile has no verdict."""
        settings, self.stored = scene.perception_entropy, len(job.verdicts)
        same = {name for name, _ in {*self.tables} & {*bridge.requirements_key(settings)}}
        found = [each for each in job.verdicts if each.name in same]
        bridge.store_verdicts(settings, found, job.unchecked)

    def _apply(self, scene: bpy.types.Scene | None, task: SceneJob) -> OperatorResult:
        """Keep the verdicts: after Esc those that were found before it."""
        job = task.job
        if scene is None or job.dropped:
            return {"CANCELLED"}
        self._store(scene, job)
        met = sum(verdict.met for verdict in job.verdicts)
        missed = [verdict.name for verdict in job.verdicts if not verdict.met]
        unchecked = [*job.unchecked, *job.missing]
        more = f"; not met: {', '.join(missed)}" if missed else ""
        more += f"; not checked: {', '.join(unchecked)}" if unchecked else ""
        text = f"{met} of {len(job.verdicts)} requirements are met{more}"
        report(self, "WARNING" if missed or unchecked else "INFO", text)
        return {"FINISHED"}


def _read(context: bpy.types.Context) -> tuple[bpy.types.Scene, bpy.types.Depsgraph, Any]:
    """Return scene, dependency graph and vehicle: the arguments of `study_from_scene`."""
    scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
    return scene, depsgraph, vehicle_cache.shared.read(scene, depsgraph).vehicle


def _checkable(
    study: pe.Study, wanted: Sequence[requirements.Requirement]
) -> tuple[tuple[requirements.Requirement, ...], dict[str, str]]:
    """Return the requirements that a study can be held to, and why not the others, by name."""
    around = study.rig, study.vehicle, study.reference, study.space
    return requirements.checkable(wanted, *around)


def _add(settings: bpy.types.PropertyGroup, made: requirements.Requirement, wanted: str) -> str:
    """Add a row with a requirement; return the name that it got."""
    name = free_name(wanted, {row.name for row in settings.requirements})
    row = settings.requirements.add()
    bridge.write_row(row, made)
    row.name = name
    return name


def own_requirement() -> requirements.Requirement:
    """Return the requirement that an own one starts with: an adult ahead."""
    zone = requirements.Zone(x=("front + 1", "front + 5"), y=("right", "left"), step=0.5)
    return requirements.Requirement("My requirement", zone, (requirements.BODIES["adult"],))


class ShownSource(NamedTuple):
    """What a requirement is after, and its source; both may be empty."""

    check: str
    text: str


def source_of(row: bpy.types.PropertyGroup) -> ShownSource | None:
    """Return what a row's requirement is after; None where the stored table is damaged."""
    table = bridge.full_table(row)
    if not table:
        return None
    return ShownSource(bridge.after_of(row), str(table.get("source", "")))


def shown_verdicts(scene: bpy.types.Scene) -> dict[str, ShownVerdict]:
    """Return the verdicts of the requirements that are switched on, by name.

    Those of the 3D view are of the sensors as they stand; without them, the stored ones.
    """
    settings = scene.perception_entropy
    live: dict[str, requirements.Verdict] = {}
    unplaced: dict[str, str] = {}
    for item in shown.items(scene.name, "requirements").values():
        if isinstance(item.shape, VerdictShape):
            live = {verdict.name: verdict for verdict in item.shape.verdicts}
            unplaced = dict(item.shape.unplaced)
    found = {}
    for row in settings.requirements:
        if not row.enabled:
            continue
        verdict = live.get(row.name)
        if row.name in unplaced:
            found[row.name] = ShownVerdict(None, "", f"not checked: {unplaced[row.name]}")
        elif verdict is not None:
            found[row.name] = ShownVerdict(
                verdict.met,
                wording.margin_text(verdict.summary),
                wording.verdict_text(verdict.summary),
                verdict.preview,
            )
        else:
            met = None if row.met < 0 else bool(row.met)
            found[row.name] = ShownVerdict(met, row.margin_text, row.verdict)
    return found


def look_at_worst() -> None:
    """Listener of `requirement_chosen`: 3D views go to the chosen requirement's worst place."""
    context = bpy.context
    settings = context.scene.perception_entropy
    if context.screen is None or settings.requirement_index >= len(settings.requirements):
        return
    row = settings.requirements[settings.requirement_index]
    worst = _worst(context.scene, row)
    if worst is None:
        return
    for area in context.screen.areas:
        if area.type == "VIEW_3D":
            view = area.spaces.active.region_3d
            if view.view_perspective != "CAMERA":
                view.view_location = (*worst, 0.0)
                view.view_distance = LOOK_FROM_M


def _worst(scene: bpy.types.Scene, row: bpy.types.PropertyGroup) -> tuple[float, float] | None:
    for item in shown.items(scene.name, "requirements").values():
        if isinstance(item.shape, VerdictShape):
            for verdict in item.shape.verdicts:
                if verdict.name == row.name:
                    place: tuple[float, float] | None = verdict.worst
                    return place
    return (row.worst[0], row.worst[1]) if row.has_worst else None


def _requirement(choice: str) -> tuple[requirements.Requirement, str]:
    """Return the requirement of an entry of the menu, and the name that it gets."""
    if choice == OWN:
        made = own_requirement()
        return made, made.name
    preset = studies.requirement_file.preset(choice)
    return preset.requirement(), f"{preset.name[:1].upper()}{preset.name[1:]}"


CLASSES = (
    PE_OT_add_requirement,
    PE_OT_remove_requirement,
    PE_OT_copy_requirement,
    PE_OT_move_requirement,
    PE_OT_check_requirements,
)
