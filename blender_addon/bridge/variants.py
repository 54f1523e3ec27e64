"""Variants of a scene: found, kept, put there, and given the results that are theirs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace

import bpy

from ..choices import free_name
from ..engine import pe
from .advanced import bounds_as_limits
from .fingerprint import Fingerprint
from .records import (
    Record,
    alike,
    free_axes_of,
    records_of,
    records_of_scene,
    rig_of,
    write_records,
)
from .scene import study_of_rig
from .standing import stand
from .versions import figures_of, score_from_dict

Variant = bpy.types.PropertyGroup


def active_variant(scene: bpy.types.Scene) -> Variant | None:
    """Return the variant that was last put into the scene, or saved from it."""
    settings = scene.perception_entropy
    found = (row for row in settings.variants if row.key == settings.variant_key)
    return next(found, None)


def variant_named(scene: bpy.types.Scene, name: str) -> Variant:
    """Return a variant by its name.

    Raises
    ------
    InputError
        When there is none; the line names those there are.
    """
    rows = scene.perception_entropy.variants
    for row in rows:
        if row.name == name:
            return row
    expected = f"one of {', '.join(row.name for row in rows)}" if rows else "a file with variants"
    raise pe.InputError("scene", "variant", expected, repr(name))


def same_variant(scene: bpy.types.Scene, records: Sequence[Record]) -> Variant | None:
    """Return a variant that is this very idea: the active one first."""
    rows = [active_variant(scene), *scene.perception_entropy.variants]
    return next((r for r in rows if r is not None and alike(records_of(r), records)), None)


def add_variant(scene: bpy.types.Scene, name: str, records: Sequence[Record]) -> Variant:
    """Return a new variant of these sensors, at the end of the list."""
    settings = scene.perception_entropy
    key = 1 + max((row.key for row in settings.variants), default=0)
    row = settings.variants.add()
    row.key, row.name = key, name
    write_records(row, records)
    return row


def put_variant(scene: bpy.types.Scene, variant: Variant) -> None:
    """Have a variant stand in the scene, and be the active one.

    Raises
    ------
    InputError
        When a sensor cannot be placed.
    """
    key = variant.key
    records = records_of(variant)
    names = stand(scene, records)
    if any(name != actual for name, actual in names.items()):
        write_records(variant, [_renamed(record, names) for record in records])
    choose_variant(scene, key)


def _renamed(record: Record, names: Mapping[str, str]) -> Record:
    other = names.get(record.mirror_of, record.mirror_of)
    return replace(record, name=names[record.name], mirror_of=other)


def choose_variant(scene: bpy.types.Scene, key: int) -> None:
    """Note which variant stands in the scene, and select its row."""
    settings = scene.perception_entropy
    settings.variant_key, settings.variant_changed = key, False
    keys = [row.key for row in settings.variants]
    settings.variant_index = keys.index(key) if key in keys else 0


def study_of_variant(scene: bpy.types.Scene, variant: Variant, depsgraph: object) -> pe.Study:
    """Return the study of the scene with a variant's sensors in place of its own.

    Raises
    ------
    InputError
        One line that says what is wrong with the scene, or with the variant.
    """
    records = records_of(variant)
    limits = {r.name: bounds_as_limits(r.bounded, r.low, r.high) for r in records}
    limits = {name: own for name, own in limits.items() if own}
    try:
        free = free_axes_of(records)
        return study_of_rig(scene, depsgraph, rig_of(records), free, limits=limits)
    except pe.InputError as error:
        named = f"variant {variant.name!r}"
        raise error.at(named) if error.source == "variant" else error from None


def same_score(some: Sequence[Record], others: Sequence[Record]) -> bool:
    """Whether two lists of sensors have one score: what is free counts for nothing."""
    return [record.scored for record in some] == [record.scored for record in others]


def keep_score(scene: bpy.types.Scene, rig: pe.Rig, score: pe.Score, surroundings: str) -> None:
    """Give a score to every variant of just these sensors; `surroundings` as they were scored."""
    for row in scene.perception_entropy.variants:
        if _is_rig(row, rig):
            write_score(row, score, surroundings)


def _is_rig(variant: Variant, rig: pe.Rig) -> bool:
    """Whether what counts of a variant is this rig."""
    try:
        own = rig_of(records_of(variant))
    except pe.InputError:  # a sensor that the catalogue does not know, or none
        return False
    return [_told_apart(sensor) for sensor in own] == [_told_apart(sensor) for sensor in rig]


def _told_apart(sensor: pe.Sensor) -> tuple[object, ...]:
    """What a score depends on; the catalogue gives one object for each of its sensors."""
    return sensor.name, id(sensor.model), sensor.fusion, sensor.pose, sensor.curve


def keep_search(scene: bpy.types.Scene, outcome: pe.Outcome, surroundings: str) -> int:
    """Keep where a search began and what it found as variants; return the key of the latter.

    The first one is the active one from then on, as the sensors have not been moved yet.
    """
    now = records_of_scene(scene)
    began, found = _moved(now, outcome.start.rig), _moved(now, outcome.study.rig)
    before = kept_variant(scene, "Before optimize", began).key
    name = f"Optimized, seed {outcome.start.search.seed}"
    after = kept_variant(scene, name, found).key
    keep_score(scene, outcome.start.rig, outcome.before, surroundings)
    keep_score(scene, outcome.study.rig, outcome.after, surroundings)
    choose_variant(scene, before)
    return after


def kept_variant(scene: bpy.types.Scene, name: str, records: Sequence[Record]) -> Variant:
    """Return a variant of these sensors: one that there is, or a new one."""
    taken = {row.name for row in scene.perception_entropy.variants}
    known = same_variant(scene, records)
    return known if known is not None else add_variant(scene, free_name(name, taken), records)


def _moved(records: Sequence[Record], rig: pe.Rig) -> tuple[Record, ...]:
    """Records, with the placements of a rig."""
    poses = {sensor.name: sensor.pose for sensor in rig}
    return tuple(replace(each, pose=poses.get(each.name, each.pose)) for each in records)


def write_score(variant: Variant, score: pe.Score, surroundings: str) -> None:
    """Keep a score with a variant."""
    _write_figures(variant, figures_of(score))
    variant.signature = surroundings


def take_scene_s_score(scene: bpy.types.Scene, variant: Variant, now: Fingerprint) -> None:
    """Give a variant the scene's own result, if the scene stands as it was scored."""
    settings = scene.perception_entropy
    if settings.has_result and now.text == settings.result_signature:
        _write_figures(variant, json.loads(settings.result_json)["after"])
        variant.signature = now.surroundings


def copy_score(source: Variant, to: Variant) -> None:
    """Give a variant the score of another one."""
    to.figures_json, to.figures_of = source.figures_json, source.figures_of
    if source.has_result:
        _write_figures(to, json.loads(source.score_json))
        to.signature, to.stale = source.signature, source.stale


def _write_figures(variant: Variant, figures: dict) -> None:
    variant.entropy, variant.coverage = figures["entropy"], figures["coverage"]
    variant.stderr, variant.voxels = figures["stderr"], figures["voxels"]
    variant.score_json = json.dumps(figures)
    variant.stale, variant.has_result = False, True


def variant_dict(scene: bpy.types.Scene, variant: Variant) -> dict[str, object]:
    """Return what there is to tell of a variant, as plain JSON data; None where not scored."""
    figures = json.loads(variant.score_json) if variant.has_result else {}
    return {
        "name": variant.name,
        "active": variant.key == scene.perception_entropy.variant_key,
        "sensors": [record.name for record in records_of(variant) if record.visible],
        **{key: figures.get(key) for key in ("entropy", "coverage", "stderr", "voxels")},
        "stale": variant.stale,
        "note": variant.note,
    }


def score_of(variant: Variant) -> pe.Score:
    """Return a variant's score as it is kept: all but its sensors' part."""
    return score_from_dict(json.loads(variant.score_json))


def check_variants(scene: bpy.types.Scene, now: Fingerprint) -> None:
    """Set what the list shows: whether the scene is the active one, and whose score is stale."""
    settings, current = scene.perception_entropy, now.surroundings
    active = active_variant(scene)
    changed = active is not None and not _stands(scene, active)
    if changed != settings.variant_changed:
        settings.variant_changed = changed
    for row in settings.variants:
        stale = row.has_result and row.signature != current
        if stale != row.stale:
            row.stale = stale


def _stands(scene: bpy.types.Scene, variant: Variant) -> bool:
    """Whether the scene is a variant; a sensor that is no possible one makes it another."""
    try:
        return alike(records_of_scene(scene), records_of(variant))
    except pe.InputError:
        return False
