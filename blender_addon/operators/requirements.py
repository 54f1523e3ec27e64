"""Requirements in the panel: add a preset or an own one, remove, order."""

from functools import lru_cache
from typing import NamedTuple

import bpy

from .. import document
from ..caches import vehicle_cache
from ..engine import requirements, studies, wording
from ..overlay.layer_cache import shown_of
from ..overlay.requirement_zones import VerdictShape
from .rows import new_row, row_list

OWN = "OWN"
ALL = "ALL"
PRESETS = (
    (OWN, "Own Requirement", "An adult ahead of the vehicle, to be changed below"),
    *(
        (each.id, f"{each.check}: {each.name}", f"{each.source} (confidence {each.confidence})")
        for each in studies.requirement_file.presets().values()
    ),
    (ALL, "All Presets", "Each preset that the rig can be held to"),
)


class ShownVerdict(NamedTuple):
    """A verdict as the panel shows it: met, not met (False) or unknown (None), and its margin."""

    met: bool | None
    margin: str
    sentence: str


def add_requirement(context: bpy.types.Context, preset: str) -> str:
    """Hold the rig to a requirement: a preset with its source, or one of your own"""
    scene = context.scene
    if preset != ALL:
        return f"Added {_add(scene, *_requirement(preset))}"
    settings = scene.perception_entropy
    present = {document.preset_of(row) for row in settings.requirements}
    presets = studies.requirement_file.presets()
    made = dict(_requirement(each) for each in presets if each not in present)
    depsgraph = context.evaluated_depsgraph_get()
    chosen = settings.requirement_index
    vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
    study = document.study_from_scene(scene, depsgraph, vehicle)
    fitting, reasons = requirements.checkable(
        list(made), study.rig, study.vehicle, study.reference, space=study.space
    )
    for each in fitting:
        _add(scene, each, made[each])
    settings.requirement_index = chosen
    first, *_ = [*reasons.items(), ("", "")]
    more = f"; left out {len(reasons)}, as {first[0]}: {first[1]}" if reasons else ""
    return f"Added {len(fitting)} requirements{more}"


def _add(scene: bpy.types.Scene, made: requirements.Requirement, wanted: str) -> str:
    """Add a row with a requirement; return the name that it got."""
    row = new_row(scene, "requirements", wanted)
    name = row.name
    document.write_row(row, made)
    row.name = name
    return name


def copy_requirement(context: bpy.types.Context, source: bpy.types.PropertyGroup) -> str:
    """Add a requirement with the table of another one; return its name."""
    name = source.name
    table = source.table
    is_used = source.enabled
    row = new_row(context.scene, "requirements", name)
    row.table = table
    row.enabled = is_used
    return str(row.name)


row_list(
    "requirements",
    "requirement",
    add=add_requirement,
    kinds=PRESETS,
    copy=copy_requirement,
    is_ordered=True,
)


def shown_verdicts(scene: bpy.types.Scene) -> dict[str, ShownVerdict]:
    """Return the verdicts of the requirements that are switched on, by name. Those of the 3D view
    are of the sensors as they stand; without them, the stored ones."""
    settings = scene.perception_entropy
    live: dict[str, requirements.VerdictSummary] = {}
    unplaced: dict[str, str] = {}
    for item in shown_of(scene.name, "requirements").values():
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
            found[row.name] = in_words(verdict)
        else:
            found[row.name] = _stored(row)
    return found


def _stored(row: bpy.types.PropertyGroup) -> ShownVerdict:
    """Return a row's stored verdict in words."""
    stored = document.stored_verdict(row)
    if stored is None or isinstance(stored, str):
        return ShownVerdict(None, "", f"not checked: {stored}" if stored else "")
    return in_words(stored)


@lru_cache(maxsize=128)
def in_words(verdict: requirements.VerdictSummary) -> ShownVerdict:
    """Return a verdict in words: all are drawn at each redraw."""
    return ShownVerdict(verdict.met, wording.margin_text(verdict), wording.verdict_text(verdict))


def _requirement(choice: str) -> tuple[requirements.Requirement, str]:
    """Return the requirement of an entry of the menu, and the name that it gets."""
    if choice == OWN:  # it begins with an adult ahead
        zone = requirements.Zone(x=("front + 1", "front + 5"), y=("right", "left"), step=0.5)
        adult = requirements.BODIES["adult"]
        return requirements.Requirement("My requirement", zone, (adult,)), "My requirement"
    preset = studies.requirement_file.preset(choice)
    return preset.requirement(), f"{preset.name[:1].upper()}{preset.name[1:]}"
