"""A variant's stored score as the scene's own result, once the variant stands in the scene."""

from __future__ import annotations

import json
from dataclasses import replace

import bpy

from ..engine import pe
from .fingerprint import Fingerprint
from .oddities import scene_advice
from .outcome import store_outcome
from .variants import Variant, study_of_variant
from .versions import score_from_dict


def restore_result(
    scene: bpy.types.Scene, variant: Variant, now: Fingerprint, depsgraph: object
) -> pe.Outcome | None:
    """Have the scene show the score that is stored with the variant that stands there.

    Returns
    -------
    Outcome or None
        None where there is none, or where it is not of the scene as it stands.
    """
    if not variant.has_result or variant.signature != now.surroundings:
        return None
    study = study_of_variant(scene, variant, depsgraph)
    score = whole_score_of(variant)
    if set(score.per_sensor) != {sensor.name for sensor in study.rig}:
        return None  # an object has another name than the sensor that was scored
    told = scene_advice(scene)
    outcome = pe.Outcome("score", study, study, score, score, warnings=told)
    store_outcome(scene, outcome, now.text)
    return outcome


def whole_score_of(variant: Variant) -> pe.Score:
    """Return a variant's score as it is stored, its sensors' part included."""
    figures = json.loads(variant.score_json)
    own = {name: pe.SensorScore(**each) for name, each in figures["per_sensor"].items()}
    return replace(score_from_dict(figures), per_sensor=own)
