"""Operators of variants: save, update, switch, duplicate, delete, show as a ghost."""

from __future__ import annotations

import contextlib

import bpy
from bpy.props import IntProperty

from .. import bridge, diagnostics, result_staleness, signals
from ..choices import BEFORE_MOVE, free_name
from ..engine import pe
from ..language import shown
from .list_rows import remove_row
from .reports import USER_ERRORS, OperatorMixin, OperatorResult, report, report_error

UNSAVED = "Unsaved"


class VariantOperator(OperatorMixin):
    """Base of these operators: the variant by its key, or the selected one.

    One that is `of_sensors` reads or places the scene's sensors: as drawn, in whatever state.
    """

    bl_options = {"REGISTER", "UNDO"}
    least = 1
    of_sensors = False

    key: IntProperty(
        name="Key", description="Key of the variant; 0: the selected one", options={"HIDDEN"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Variants are for Object Mode"))
            return False
        if len(context.scene.perception_entropy.variants) < cls.least:
            cls.poll_message_set(shown("There is no variant yet"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        rows = list(settings.variants)
        wanted = [row for row in rows if row.key == self.key] or rows[settings.variant_index :][:1]
        try:
            drawn = bridge.as_drawn(context.scene) if self.of_sensors else contextlib.nullcontext()
            with drawn:
                self.act(context.scene, wanted[0] if wanted else None)
        except USER_ERRORS as error:
            return report_error(self, error)
        signals.study_changed.emit()
        return {"FINISHED"}


class PE_OT_save_variant(VariantOperator, bpy.types.Operator):
    """Save the present sensors as a new variant"""

    bl_idname = "pe.save_variant"
    bl_label = "Save Variant"
    least = 0
    of_sensors = True

    def act(self, scene: bpy.types.Scene, _variant: object) -> None:
        """Add the scene's sensors to the list."""
        row = save_scene(scene, "Variant")
        report(self, "INFO", f"Saved {row.name}")


class PE_OT_update_variant(VariantOperator, bpy.types.Operator):
    """Overwrite the active variant with the present sensors"""

    bl_idname = "pe.update_variant"
    bl_label = "Update Variant"
    of_sensors = True

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if bridge.active_variant(context.scene) is None:
            cls.poll_message_set(shown("No variant was put here: save this as a new one"))
            return False
        return super().poll(context)

    def act(self, scene: bpy.types.Scene, _variant: object) -> None:
        """Overwrite the active variant; its score is removed if the sensors differ."""
        row = bridge.active_variant(scene)
        if row is None:
            return
        records = bridge.records_of_scene(scene)
        if not bridge.same_score(bridge.records_of(row), records):
            row.has_result, row.figures_json = False, ""
        bridge.write_records(row, records)
        bridge.mark_active(scene, row.key)
        report(self, "INFO", f"Updated {row.name}")


class PE_OT_switch_variant(VariantOperator, bpy.types.Operator):
    """Replace the scene's sensors by those of this variant.

    If the present sensors are no variant yet, they are saved as one: nothing is lost"""

    bl_idname = "pe.switch_variant"
    bl_label = "Switch to Variant"
    of_sensors = True

    def act(self, scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> None:
        """Store the present sensors if they are no variant, then apply the variant."""
        key, before = variant.key, bridge.records_of_scene(scene)
        kept = keep_unsaved(scene, before)
        variant = next(row for row in scene.perception_entropy.variants if row.key == key)
        switch(scene, variant, before)
        aside = f"; what was here is kept as {kept}" if kept else ""
        report(self, "INFO", f"Switched to {variant.name}{aside}")


class PE_OT_duplicate_variant(VariantOperator, bpy.types.Operator):
    """Add a copy of the selected variant"""

    bl_idname = "pe.duplicate_variant"
    bl_label = "Duplicate Variant"

    def act(self, scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> None:
        """Copy sensors and score; the active variant stays active."""
        source, name = variant.key, variant.name
        copy = bridge.add_variant(scene, _free(scene, name), bridge.records_of(variant))
        settings = scene.perception_entropy
        original = next(row for row in settings.variants if row.key == source)
        bridge.copy_score(original, copy)
        settings.variant_index = len(settings.variants) - 1
        report(self, "INFO", f"{name} is copied as {copy.name}")


class PE_OT_delete_variant(VariantOperator, bpy.types.Operator):
    """Delete the selected variant. The sensors in the scene stay"""

    bl_idname = "pe.delete_variant"
    bl_label = "Delete Variant"

    def act(self, scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> None:
        """Remove the variant's row from the list."""
        settings = scene.perception_entropy
        number = [row.key for row in settings.variants].index(variant.key)
        if variant.key == settings.view.ghost_key:
            settings.view.ghost_key = 0
        if variant.key == settings.live.against:
            settings.live.against = BEFORE_MOVE
        if variant.key == settings.variant_key:
            settings.variant_key, settings.variant_changed = 0, False
        name = remove_row(settings, "variants", "variant_index", number)
        report(self, "INFO", f"Deleted {name}")


class PE_OT_ghost_variant(VariantOperator, bpy.types.Operator):
    """Show or hide this variant's sensors in the 3D view beside the present ones"""

    bl_idname = "pe.ghost_variant"
    bl_label = "Show Ghost"
    bl_options = {"INTERNAL"}

    def act(self, scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> None:
        """Switch the ghost of one variant on or off."""
        view = scene.perception_entropy.view
        view.ghost_key = 0 if view.ghost_key == variant.key else variant.key


def save_scene(scene: bpy.types.Scene, name: str) -> bpy.types.PropertyGroup:
    """Store the scene's sensors as a new variant and make it the active one."""
    row = bridge.add_variant(scene, _free(scene, name), bridge.records_of_scene(scene))
    bridge.copy_scene_score(scene, row, result_staleness.fingerprint(scene))
    bridge.mark_active(scene, row.key)
    return row


def keep_unsaved(scene: bpy.types.Scene, records: tuple[bridge.SensorRecord, ...]) -> str:
    """Store the scene's sensors as a variant unless they are one; return the new name or ""."""
    if not records or bridge.matching_variant(scene, records) is not None:
        return ""
    return save_scene(scene, UNSAVED).name


def switch(
    scene: bpy.types.Scene,
    variant: bpy.types.PropertyGroup,
    before: tuple[bridge.SensorRecord, ...],
) -> None:
    """Apply a variant and show its result; restore the sensors where it cannot be applied."""
    try:
        bridge.activate_variant(scene, variant)
    except pe.InputError:
        bridge.apply_records(scene, before)
        raise
    show_own_result(scene, variant)


def show_own_result(scene: bpy.types.Scene, variant: bpy.types.PropertyGroup) -> None:
    """Show the score of the applied variant; a result of other sensors is marked stale."""
    settings, now = scene.perception_entropy, result_staleness.fingerprint(scene)
    settings.result_stale = settings.has_result and settings.result_signature != now.text
    if settings.has_result and not settings.result_stale:
        return
    with contextlib.suppress(pe.InputError):  # a score says what is wrong
        depsgraph = bridge.view_layer_of(scene).depsgraph
        outcome = bridge.restore_result(scene, variant, now, depsgraph)
        if outcome is not None:
            diagnostics.explain_score(scene, outcome, now.text)


def _free(scene: bpy.types.Scene, name: str) -> str:
    return free_name(name, {row.name for row in scene.perception_entropy.variants})


def stand_as_variant(
    scene: bpy.types.Scene,
    title: str,
    records: tuple[bridge.SensorRecord, ...],
    note: str,
    before: tuple[bridge.SensorRecord, ...],
) -> str:
    """Store the present sensors, and apply other sensors as a new variant; return its name.

    Raises
    ------
    InputError
        When they cannot stand here; there is no such variant then.
    """
    keep_unsaved(scene, before)
    rows = scene.perception_entropy.variants
    row = bridge.add_variant(scene, free_name(title, {row.name for row in rows}), records)
    row.note = note
    key, name = row.key, row.name
    try:
        switch(scene, row, before)
    except pe.InputError:
        rows.remove([each.key for each in rows].index(key))
        raise
    return name


CLASSES = (
    PE_OT_save_variant,
    PE_OT_update_variant,
    PE_OT_switch_variant,
    PE_OT_duplicate_variant,
    PE_OT_delete_variant,
    PE_OT_ghost_variant,
)
