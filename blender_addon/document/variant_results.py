"""Results of variants: their stored scores and key figures, and the designs of a search."""

import base64
import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from bpy.types import Depsgraph, Scene

from ..engine import advice, jobs, pe
from .fingerprint import Fingerprint
from .prior import prior_from_scene
from .result import FrontRow, ShownFront, score_from_dict, scored_data, store_outcome
from .scene_diagnostics import check_placeable, scene_advice
from .sensor_records import SCORED, SensorRecord, records_of, records_of_scene, rig_of
from .study_table import SCORED_PARTS, document_of
from .time import scenario_signatures
from .variants import Variant, find_or_add_variant, mark_active, study_of_variant

BEFORE = "Before choosing"
MAX_NAME_LENGTH = 60


def same_score(records: Sequence[SensorRecord], others: Sequence[SensorRecord]) -> bool:
    """Whether two lists of sensors have the same score and figures, whatever their free axes."""
    return [each.keys(SCORED) for each in records] == [each.keys(SCORED) for each in others]


def store_variant_scores(scene: Scene, outcome: jobs.Outcome, surroundings: str) -> None:
    """Store the scores of an outcome with every variant of exactly these sensors. `surroundings` is
    the fingerprint of the scene without its sensors when it was scored."""
    beside = outcome.figures or (None, None)
    for study, score, figures in (
        (outcome.start, outcome.before, beside[0]),
        (outcome.study, outcome.after, beside[1]),
    ):
        for row in scene.perception_entropy.variants:
            if _is_rig(row, study.rig, study.returns):
                _write_figures(row, scored_data(score, figures))
                row.signature = surroundings


def _is_rig(variant: Variant, rig: pe.Rig, returns: str) -> bool:
    """Return whether the visible sensors of a variant, with these returns, are this rig."""
    try:
        variant_rig = rig_of(records_of(variant), returns=returns)
    except pe.InputError:  # a sensor that the catalogue does not know, or none
        return False
    return [_scored_values(sensor) for sensor in variant_rig] == [
        _scored_values(sensor) for sensor in rig
    ]


def _scored_values(sensor: pe.Sensor) -> tuple[object, ...]:
    """Return what scores and key figures depend on; the catalogue has each model once."""
    return sensor.name, id(sensor.model), sensor.fusion, sensor.pose, sensor.curve


def keep_search(scene: Scene, start: pe.Study, best: pe.Rig) -> tuple[int, int]:
    """Keep the start of a search and its best rig as variants; return their keys."""
    records = records_of_scene(scene)
    name = f"Optimized, seed {start.search.seed}"
    before = find_or_add_variant(scene, "Before optimize", _moved(records, start.rig)).key
    after = find_or_add_variant(scene, name, _moved(records, best)).key
    return before, after


def store_search(scene: Scene, outcome: jobs.Outcome, surroundings: str) -> tuple[int, int]:
    """Keep the start and the result of a search as variants with their scores; return their
    keys."""
    keys = keep_search(scene, outcome.start, outcome.study.rig)
    store_variant_scores(scene, outcome, surroundings)
    return keys


def keep_rig(scene: Scene, name: str, rig: pe.Rig) -> None:
    """Keep the poses of a rig as a variant without a score."""
    find_or_add_variant(scene, name, _moved(records_of_scene(scene), rig))


def _moved(records: Sequence[SensorRecord], rig: pe.Rig) -> tuple[SensorRecord, ...]:
    """Return records with the poses of a rig."""
    poses = {sensor.name: sensor.pose for sensor in rig}
    return tuple(replace(r, pose=poses.get(r.name, r.pose)) for r in records)


def store_variant_score(variant: Variant, score: pe.Score, surroundings: str) -> None:
    """Store a score with a variant."""
    _write_figures(variant, scored_data(score))
    variant.signature = surroundings


def copy_scene_score(scene: Scene, variant: Variant, now: Fingerprint) -> None:
    """Copy the scene's result to a variant if the result is still valid."""
    settings = scene.perception_entropy
    if settings.has_result and now.text == settings.result_signature:
        _write_figures(variant, json.loads(settings.result_json)["after"])
        variant.signature = now.surroundings


def copy_score(source: Variant, to: Variant) -> None:
    """Copy the score of one variant to another."""
    to.figures_json = source.figures_json
    if source.has_result:
        _write_figures(to, json.loads(source.score_json))
        to.signature = source.signature
        to.stale = source.stale


def _write_figures(variant: Variant, figures: dict) -> None:
    variant.score_json = json.dumps(figures)
    variant.stale = False


def score_of(variant: Variant) -> pe.Score:
    """Return a variant's stored score."""
    return score_from_dict(json.loads(variant.score_json))


def hardware_note(variants: Sequence[Variant]) -> str:
    """Return the note on variants with other models or numbers of sensors; empty for none."""
    rigs = []
    for variant in variants:
        with suppress(pe.InputError):  # a sensor that the catalogue does not know, or none
            rigs.append([sensor.model for sensor in rig_of(records_of(variant))])
    return advice.hardware_note(rigs)


def worth_of_differences(scene: Scene, variants: Sequence[Variant]) -> dict[str, advice.Worth]:
    """Return what differences between scored variants are worth, by score; none where no pairs of
    rigs were like these."""
    settings = scene.perception_entropy
    try:
        document = document_of(settings, *SCORED_PARTS)
        by = SimpleNamespace(
            space=document.space,
            prior=prior_from_scene(scene),
            model=document.perception,
            targets=document.targets,
        )
        rigs = [rig_of(records_of(row), returns=settings.returns) for row in variants]
    except pe.InputError:  # a sensor that the catalogue does not know, or none
        return {}
    return advice.worth_rows(by, rigs, one_vehicle=True)


def check_choosable(scene: Scene, study: pe.Study) -> None:
    """Check that a scene has sensors to choose, and that they can be placed. `InputError` when no
    sensor has models to choose from, no design keeps to the limits, or something else holds a
    sensor that is to be moved."""
    if not jobs.has_front(study):
        expected = "a sensor with models to choose from (panel Sensor Choices)"
        raise pe.InputError("scene", "choices", expected, "none")
    try:
        jobs.FrontJob(study)
    except pe.InputError as error:
        raise error.within("scene") from None
    if any(study.search.free.values()) or study.search.mounting.on:
        check_placeable(scene, study)


def store_front(scene: Scene, trade_off: jobs.TradeOff, surroundings: str) -> None:
    """Store each design of a Pareto front as a variant, and the scene's sensors as another one."""
    records = records_of_scene(scene)
    settings = scene.perception_entropy
    before = find_or_add_variant(scene, BEFORE, records).key
    rows = []
    for design in trade_off.front:
        variant = find_or_add_variant(
            scene, design.name[:MAX_NAME_LENGTH], _designed(records, design)
        )
        if design.score is not None:
            store_variant_score(variant, design.score, surroundings)
        variant.note = variant.note or _note(design, settings.currency)
        met = f" ({design.met_text})" if design.met_text else ""
        figures = ", ".join(f"{n} {v:.4g}" for n, v in design.figures.items())
        rows.append(FrontRow(f"{design.name}{met}", variant.key, figures.replace("_", " ")))
    note = f"; {trade_off.requirements_note}" if trade_off.requirements_note else ""
    front = ShownFront(tuple(rows), f"{trade_off.told}{note}", trade_off.hardware_note)
    settings.front_json = front.to_json()
    mark_active(scene, before)


def _designed(now: Sequence[SensorRecord], design: jobs.Design) -> tuple[SensorRecord, ...]:
    """Return the scene's sensors with the models of a design, without those it leaves out."""
    taken: Mapping[str, pe.Sensor] = {sensor.name: sensor for sensor in design.study.rig}
    gone = {name for name, model in design.models.items() if model is None}
    return tuple(
        _with_choice(record, taken[record.name]) if record.name in taken else record
        for record in now
        if record.name not in gone
    )


def _with_choice(record: SensorRecord, sensor: pe.Sensor) -> SensorRecord:
    model = sensor.model.name
    fusion = sensor.fusion or ""
    return replace(record, model=model, fusion=fusion, pose=sensor.pose, curve=sensor.curve)


def _note(design: jobs.Design, currency: str) -> str:
    return f"{design.price:,.10g} {currency}".strip()


def figures_signature(scene: Scene, now: Fingerprint) -> str:
    """Return what key figures of a variant depend on besides its sensors."""
    scenarios = scenario_signatures(scene.perception_entropy, now.surroundings)
    return " ".join(scenarios.values()) or now.surroundings


def write_figures(
    variant: Variant, figures: advice.KeyFigures, picture: bytes, signature: str
) -> None:
    """Store key figures with a variant, and its picture, a PNG file."""
    shown = {"figures": figures.to_dict(), "picture": base64.b64encode(picture).decode()}
    variant.figures_json = json.dumps({"of": signature, **shown})


def figures_of(variant: Variant, signature: str) -> advice.KeyFigures | None:
    """Return a variant's key figures; None if none with this signature are stored."""
    kept = json.loads(variant.figures_json or "{}")
    return advice.KeyFigures.from_dict(kept["figures"]) if kept.get("of") == signature else None


def picture_of(variant: Variant) -> str:
    """Return a variant's picture in base 64; empty if none is stored."""
    return str(json.loads(variant.figures_json or "{}").get("picture", ""))


def restore_result(
    scene: Scene, variant: Variant, now: Fingerprint, depsgraph: Depsgraph
) -> jobs.Outcome | None:
    """Show the stored score of the variant that was applied to the scene.

    Returns
    -------
    Outcome or None
        None where no score is stored, or the scene has changed since.
    """
    if not variant.has_result or variant.signature != now.surroundings:
        return None
    study = study_of_variant(scene, variant, depsgraph)
    outcome = stored_outcome(scene, study, json.loads(variant.score_json))
    if outcome is not None:
        store_outcome(scene, outcome, now.text)
    return outcome


def stored_outcome(scene: Scene, study: pe.Study, figures: dict[str, Any]) -> jobs.Outcome | None:
    """Return the outcome of a stored score; None where it is of sensors of other names."""
    score = score_from_dict(figures)
    if set(score.per_sensor) != {sensor.name for sensor in study.rig}:
        return None
    known = figures.get("figures")
    warnings = scene_advice(scene)
    beside = None if known is None else (advice.KeyFigures.from_dict(known),) * 2
    return jobs.Outcome(
        "score", study, study, score, after=score, warnings=warnings, figures=beside
    )
