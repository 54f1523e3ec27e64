"""Variants of a scene: find, store and apply them, and convert them to studies."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

from bpy.types import Depsgraph, PropertyGroup, Scene

from ..choices import free_name
from ..engine import pe
from .apply_variant import apply_records
from .fingerprint import Fingerprint
from .scene_study import study_of
from .sensor_records import SensorRecord, records_of, records_of_scene, same_sensors, write_records

Variant: TypeAlias = PropertyGroup


def active_variant(scene: Scene) -> Variant | None:
    """Return the variant that was last applied to the scene, or saved from it."""
    settings = scene.perception_entropy
    matches = (row for row in settings.variants if row.key == settings.variant_key)
    return next(matches, None)


def variant_named(scene: Scene, name: str) -> Variant:
    """Return a variant by its name. `InputError` when there is no such variant; the message names
    the existing ones."""
    rows = scene.perception_entropy.variants
    for row in rows:
        if row.name == name:
            return row
    expected = f"one of {', '.join(row.name for row in rows)}" if rows else "a file with variants"
    raise pe.InputError("scene", "variant", expected, repr(name))


def matching_variant(scene: Scene, records: Sequence[SensorRecord]) -> Variant | None:
    """Return a variant with exactly these sensors, the active one first; None without."""
    rows = [active_variant(scene), *scene.perception_entropy.variants]
    return next((r for r in rows if r is not None and same_sensors(records_of(r), records)), None)


def add_variant(scene: Scene, name: str, records: Sequence[SensorRecord]) -> Variant:
    """Return a new variant of these sensors, at the end of the list."""
    settings = scene.perception_entropy
    key = 1 + max((row.key for row in settings.variants), default=0)
    row = settings.variants.add()
    row.key = key
    row.name = name
    write_records(row, records)
    return row


def activate_variant(scene: Scene, variant: Variant) -> None:
    """Apply a variant to the scene, and make it the active one. `InputError` when a sensor cannot
    be placed."""
    key = variant.key
    records = records_of(variant)
    names = apply_records(scene, records)
    if any(name != actual for name, actual in names.items()):
        write_records(variant, [_renamed(record, names) for record in records])
    mark_active(scene, key)


def _renamed(record: SensorRecord, names: Mapping[str, str]) -> SensorRecord:
    other = names.get(record.mirror_of, record.mirror_of)
    return replace(record, name=names[record.name], mirror_of=other)


def mark_active(scene: Scene, key: int) -> None:
    """Store the key of the active variant, and select its row in the list."""
    settings = scene.perception_entropy
    settings.variant_key = key
    settings.variant_changed = False
    keys = [row.key for row in settings.variants]
    settings.variant_index = keys.index(key) if key in keys else 0


def study_of_variant(scene: Scene, variant: Variant, depsgraph: Depsgraph) -> pe.Study:
    """Return the study that the scene would have if the variant were applied to it. `InputError`
    with one line that says what is wrong."""
    try:
        return study_of(scene, depsgraph, records_of(variant), source="variant")
    except pe.InputError as error:
        named = f"variant {variant.name!r}"
        raise error.at(named) if error.source == "variant" else error from None


def find_or_add_variant(scene: Scene, name: str, records: Sequence[SensorRecord]) -> Variant:
    """Return the variant with these sensors; a new one where there is none."""
    taken = {row.name for row in scene.perception_entropy.variants}
    existing = matching_variant(scene, records)
    return existing if existing is not None else add_variant(scene, free_name(name, taken), records)


def variant_dict(scene: Scene, variant: Variant) -> dict[str, object]:
    """Return a variant's summary as plain JSON data; figures are None where it was not scored."""
    figures = json.loads(variant.score_json) if variant.has_result else {}
    return {
        "name": variant.name,
        "active": variant.key == scene.perception_entropy.variant_key,
        "sensors": [record.name for record in records_of(variant) if record.visible],
        **{key: figures.get(key) for key in ("entropy", "coverage", "stderr", "voxels")},
        "stale": variant.stale,
        "note": variant.note,
    }


def check_variants(scene: Scene, now: Fingerprint) -> None:
    """Update the list of variants: whether the scene differs from the active one, stale scores."""
    settings = scene.perception_entropy
    current = now.surroundings
    active = active_variant(scene)
    changed = active is not None and not _is_applied(scene, active)
    if changed != settings.variant_changed:
        settings.variant_changed = changed
    for row in settings.variants:
        stale = row.has_result and row.signature != current
        if stale != row.stale:
            row.stale = stale


def _is_applied(scene: Scene, variant: Variant) -> bool:
    """Whether the scene equals a variant; False for a variant with an invalid sensor."""
    try:
        return same_sensors(records_of_scene(scene), records_of(variant))
    except pe.InputError:
        return False
