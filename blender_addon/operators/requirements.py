"""Requirements in the panel: add a preset or an own one, remove, order; look at the worst place."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, NamedTuple

import bpy
from bpy.props import EnumProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from .. import bridge, signals, vehicle_cache
from ..engine import pe, requirements, studies, wording
from ..overlay.layer_cache import shown
from ..overlay.requirement_zones import VerdictShape
from ..properties import requirement_fields
from .declared import OperatorResult, RowList, chosen_file, operator

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


ROWS = RowList("requirements", "requirement_index", "requirement")
ROWS.operators(
    remove="Remove the requirement that is selected in the list",
    copy="Add a copy of the selected requirement below it",
    copied=("table", "enabled"),
    move="Move the selected requirement in the list: tables and pages have this order",
)


def _search(self: Any, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
    context.window_manager.invoke_search_popup(self)
    return {"RUNNING_MODAL"}


@operator(
    "Add Requirement",
    signal=signals.study_changed,
    bl_property="preset",
    invoke=_search,
    preset=EnumProperty(items=PRESETS, name="Preset", description="What has to be met"),
)
def add_requirement(context: bpy.types.Context, preset: str) -> str:
    """Hold the rig to a requirement: a preset with its source, or one of your own"""
    scene = context.scene
    if preset != ALL:
        return f"Added {_add(scene, *_requirement(preset))}"
    settings = scene.perception_entropy
    present = {bridge.preset_of(row) for row in settings.requirements}
    presets = studies.requirement_file.presets()
    made = dict(_requirement(each) for each in presets if each not in present)
    depsgraph, chosen = context.evaluated_depsgraph_get(), settings.requirement_index
    vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
    study = bridge.study_from_scene(scene, depsgraph, vehicle)
    around = study.rig, study.vehicle, study.reference, study.space
    fitting, reasons = requirements.checkable(list(made), *around)
    for each in fitting:
        _add(scene, each, made[each])
    settings.requirement_index = chosen
    first, *_ = [*reasons.items(), ("", "")]
    more = f"; left out {len(reasons)}, as {first[0]}: {first[1]}" if reasons else ""
    return f"Added {len(fitting)} requirements{more}"


@operator(
    "Open Body Mesh",
    unless=ROWS.unless_selected,
    signal=signals.study_changed,
    bases=(ImportHelper,),
    filter_glob=StringProperty(default="*.glb;*.stl;*.obj;*.ply;*.npz", options={"HIDDEN"}),
)
def open_body_mesh(context: bpy.types.Context, filepath: str) -> str:
    """Choose the file of a closed mesh as the test body of the selected requirement"""
    settings = context.scene.perception_entropy
    row = settings.requirements[settings.requirement_index]
    if row.body != requirement_fields.OWN:
        row.body = requirement_fields.OWN
    file, folder = chosen_file(filepath), Path(bpy.data.filepath).parent
    # Relative to the Blender file's folder, so that both can be moved.
    is_beside = bpy.data.filepath and file.is_relative_to(folder)
    row.body_mesh = f"//{file.relative_to(folder).as_posix()}" if is_beside else os.fspath(file)
    if row.problem:
        raise pe.InputError("scene", "mesh", "a file that can be a test body", row.problem)
    return f"{row.name}: the body is {row.body_mesh}"


def _add(scene: bpy.types.Scene, made: requirements.Requirement, wanted: str) -> str:
    """Add a row with a requirement; return the name that it got."""
    row = ROWS.add(scene, wanted)
    name = row.name
    bridge.write_row(row, made)
    row.name = name
    return name


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
            found[row.name] = _stored(row)
    return found


def _stored(row: bpy.types.PropertyGroup) -> ShownVerdict:
    """Return a row's stored verdict in words."""
    stored = bridge.stored_verdict(row)
    if stored is None or isinstance(stored, str):
        return ShownVerdict(None, "", f"not checked: {stored}" if stored else "")
    return ShownVerdict(stored.met, wording.margin_text(stored), wording.verdict_text(stored))


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
    stored = bridge.stored_verdict(row)
    return None if stored is None or isinstance(stored, str) else stored.worst


def _requirement(choice: str) -> tuple[requirements.Requirement, str]:
    """Return the requirement of an entry of the menu, and the name that it gets."""
    if choice == OWN:  # it begins with an adult ahead
        zone = requirements.Zone(x=("front + 1", "front + 5"), y=("right", "left"), step=0.5)
        adult = requirements.BODIES["adult"]
        return requirements.Requirement("My requirement", zone, (adult,)), "My requirement"
    preset = studies.requirement_file.preset(choice)
    return preset.requirement(), f"{preset.name[:1].upper()}{preset.name[1:]}"
