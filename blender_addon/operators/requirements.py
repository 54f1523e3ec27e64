"""Requirements in the panel: add a preset or an own one, remove, check; look at the worst place."""

from __future__ import annotations

from typing import NamedTuple

import bpy
from bpy.props import EnumProperty

from .. import bridge, signals, vehicle_cache
from ..engine import pe, requirements, studies
from ..overlay.layer_cache import shown
from ..overlay.requirement_zones import VerdictShape
from .reports import USER_ERRORS, OperatorResult, report, report_error

OWN = "OWN"
LOOK_FROM_M = 9.0
"""Distance of the view from the worst place."""
PRESETS = (
    (OWN, "Own Requirement", "An adult ahead of the vehicle, to be changed below"),
    *(
        (each.id, f"{each.check}: {each.name}", f"{each.source} (confidence {each.confidence})")
        for each in studies.requirement_file.presets().values()
    ),
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
        made, wanted = _requirement(self.preset)
        name = _free_name(wanted, {row.name for row in settings.requirements})
        row = settings.requirements.add()
        bridge.write_row(row, made)
        row.name = name
        settings.requirement_index = len(settings.requirements) - 1
        signals.study_changed.emit()
        report(self, "INFO", f"Added {name}")
        return {"FINISHED"}


class PE_OT_remove_requirement(bpy.types.Operator):
    """Remove the requirement that is selected in the list"""

    bl_idname = "pe.remove_requirement"
    bl_label = "Remove Requirement"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        settings = context.scene.perception_entropy
        if settings.requirement_index >= len(settings.requirements):
            cls.poll_message_set("No requirement is selected")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        index = settings.requirement_index
        name = settings.requirements[index].name
        settings.requirements.remove(index)
        settings.requirement_index = max(0, min(index, len(settings.requirements) - 1))
        signals.study_changed.emit()
        report(self, "INFO", f"Removed {name}")
        return {"FINISHED"}


class PE_OT_check_requirements(bpy.types.Operator):
    """Hold the rig to all requirements that are switched on, with mounting errors and margins"""

    bl_idname = "pe.check_requirements"
    bl_label = "Check Requirements"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        try:
            vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
            study = bridge.study_from_scene(scene, depsgraph, vehicle)
            if not study.requirements:
                raise pe.InputError("scene", "requirements", "at least one", "none")
            verdicts = study.verdicts()
        except USER_ERRORS as error:
            return report_error(self, error)
        bridge.store_verdicts(scene.perception_entropy, verdicts)
        met = sum(verdict.met for verdict in verdicts)
        missed = [verdict.name for verdict in verdicts if not verdict.met]
        more = f"; not met: {', '.join(missed)}" if missed else ""
        text = f"{met} of {len(verdicts)} requirements are met{more}"
        report(self, "WARNING" if missed else "INFO", text)
        return {"FINISHED"}


def own_requirement() -> requirements.Requirement:
    """Return the requirement that an own one starts with: an adult ahead."""
    zone = requirements.Zone(x=("front + 1", "front + 5"), y=("right", "left"), step=0.5)
    return requirements.Requirement("My requirement", zone, (requirements.BODIES["adult"],))


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
            text = verdict.margin_text if verdict.margin_text or verdict.preview else ""
            found[row.name] = ShownVerdict(verdict.met, text, verdict.text, verdict.preview)
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


def _free_name(name: str, taken: set[str]) -> str:
    """Return a name that no row has yet."""
    number, free = 2, name
    while free in taken:
        number, free = number + 1, f"{name} {number}"
    return free


CLASSES = (PE_OT_add_requirement, PE_OT_remove_requirement, PE_OT_check_requirements)
