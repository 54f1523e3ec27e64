"""Operators of variants: save, update, switch, show as a ghost; and their list."""

import contextlib
from collections.abc import Callable
from typing import Any

import bpy
from bpy.props import IntProperty

from .. import document, signals
from ..caches import result_staleness
from ..choices import BEFORE_MOVE, free_name
from ..engine import pe
from ..queries import diagnostics
from .declared import INTERNAL, UNDO, operator
from .rows import row_list

UNSAVED = "Unsaved"
KEY = IntProperty(
    name="Key", description="Key of the variant; 0: the selected one", options={"HIDDEN"}
)
VariantFunction = Callable[[bpy.types.Scene, Any], str | None]


def unless_variants(context: bpy.types.Context) -> str | None:
    """Return that there is no variant; None where there is one."""
    return None if context.scene.perception_entropy.variants else "There is no variant yet"


def _unless_active(context: bpy.types.Context) -> str | None:
    active = document.active_variant(context.scene)
    return "No variant was put here: save this as a new one" if active is None else None


def of_variant(
    label: str,
    unless: Callable[[bpy.types.Context], str | None] | None = unless_variants,
    options: frozenset[str] = UNDO,
    of_sensors: bool = False,
) -> Callable[[VariantFunction], type[bpy.types.Operator]]:
    """Return what makes an operator of a function of the scene and the chosen variant's row. One
    that is `of_sensors` reads or places the scene's sensors: as drawn, in whatever state."""

    def make(function: VariantFunction) -> type[bpy.types.Operator]:
        def act(context: bpy.types.Context, key: int) -> str | None:
            scene = context.scene
            settings = context.scene.perception_entropy
            rows = list(settings.variants)
            wanted = [row for row in rows if row.key == key] or rows[settings.variant_index :][:1]
            with document.as_drawn(scene) if of_sensors else contextlib.nullcontext():
                return function(scene, wanted[0] if wanted else None)

        act.__name__ = function.__name__
        act.__doc__ = function.__doc__
        return operator(
            label,
            mode="Variants are for Object Mode",
            unless=unless,
            signal=signals.study_changed,
            options=options,
            key=KEY,
        )(act)

    return make


@of_variant("Save Variant", unless=None, of_sensors=True)
def save_variant(scene: bpy.types.Scene, _variant: object) -> str:
    """Save the present sensors as a new variant"""
    return f"Saved {save_scene(scene, 'Variant').name}"


@of_variant("Update Variant", unless=_unless_active, of_sensors=True)
def update_variant(scene: bpy.types.Scene, _variant: object) -> str:
    """Overwrite the active variant with the present sensors"""
    row: Any = document.active_variant(scene)  # there is one, or the operator is not possible
    records = document.records_of_scene(scene)
    if not document.same_score(document.records_of(row), records):
        row.score_json = row.figures_json = ""
    document.write_records(row, records)
    document.mark_active(scene, row.key)
    return f"Updated {row.name}"


@of_variant("Switch to Variant", of_sensors=True)
def switch_variant(scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> str:
    """Replace the scene's sensors by those of this variant.

    If the present sensors are no variant yet, they are saved as one: nothing is lost"""
    key = variant.key
    before = document.records_of_scene(scene)
    kept = keep_unsaved(scene, before)
    variant = next(row for row in scene.perception_entropy.variants if row.key == key)
    switch(scene, variant, before)
    return f"Switched to {variant.name}{f'; what was here is kept as {kept}' if kept else ''}"


def copy_variant(context: bpy.types.Context, source: bpy.types.PropertyGroup) -> str:
    """Add a copy of a variant with its score; return its name."""
    scene = context.scene
    key = source.key
    made = document.add_variant(scene, _free(scene, source.name), document.records_of(source))
    original = next(row for row in scene.perception_entropy.variants if row.key == key)
    document.copy_score(original, made)
    return str(made.name)


def forget_variant(scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> None:
    """Remove what refers to a variant that is about to be removed. The scene's sensors stay."""
    settings = scene.perception_entropy
    if variant.key == settings.view.ghost_key:
        settings.view.ghost_key = 0
    if variant.key == settings.live.against:
        settings.live.against = BEFORE_MOVE
    if variant.key == settings.variant_key:
        settings.variant_key = 0
        settings.variant_changed = False


row_list(
    "variants",
    "variant",
    copy=copy_variant,
    removing=forget_variant,
    loss=". The sensors in the scene stay",
)


@of_variant("Show Ghost", options=INTERNAL)
def ghost_variant(scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> None:
    """Show or hide this variant's sensors in the 3D view beside the present ones"""
    view = scene.perception_entropy.view
    view.ghost_key = 0 if view.ghost_key == variant.key else variant.key


def save_scene(scene: bpy.types.Scene, name: str) -> bpy.types.PropertyGroup:
    """Store the scene's sensors as a new variant and make it the active one."""
    row = document.add_variant(scene, _free(scene, name), document.records_of_scene(scene))
    document.copy_scene_score(scene, row, result_staleness.fingerprint(scene))
    document.mark_active(scene, row.key)
    return row


def keep_unsaved(scene: bpy.types.Scene, records: tuple[document.SensorRecord, ...]) -> str:
    """Store the scene's sensors as a variant unless they are one; return the new name or ""."""
    if not records or document.matching_variant(scene, records) is not None:
        return ""
    return save_scene(scene, UNSAVED).name


def switch(
    scene: bpy.types.Scene,
    variant: bpy.types.PropertyGroup,
    before: tuple[document.SensorRecord, ...],
) -> None:
    """Apply a variant and show its result; restore the sensors where it cannot be applied."""
    try:
        document.activate_variant(scene, variant)
    except pe.InputError:
        document.apply_records(scene, before)
        raise
    show_own_result(scene, variant)


def show_own_result(scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> None:
    """Show the score of the applied variant; a result of other sensors is marked stale."""
    settings = scene.perception_entropy
    now = result_staleness.fingerprint(scene)
    settings.result_stale = settings.has_result and settings.result_signature != now.text
    if settings.has_result and not settings.result_stale:
        return
    with contextlib.suppress(pe.InputError):  # a score says what is wrong
        depsgraph = document.view_layer_of(scene).depsgraph
        outcome = document.restore_result(scene, variant, now, depsgraph)
        if outcome is not None:
            diagnostics.explain_score(scene, outcome, now.text)


def _free(scene: bpy.types.Scene, name: str) -> str:
    return free_name(name, {row.name for row in scene.perception_entropy.variants})


def stand_as_variant(
    scene: bpy.types.Scene,
    title: str,
    records: tuple[document.SensorRecord, ...],
    note: str,
    before: tuple[document.SensorRecord, ...],
) -> str:
    """Store the present sensors, and apply other sensors as a new variant; return its name.
    `InputError` when they cannot stand here; there is no such variant then."""
    keep_unsaved(scene, before)
    rows = scene.perception_entropy.variants
    row = document.add_variant(scene, _free(scene, title), records)
    row.note = note
    key = row.key
    name = row.name
    try:
        switch(scene, row, before)
    except pe.InputError:
        rows.remove([each.key for each in rows].index(key))
        raise
    return name
