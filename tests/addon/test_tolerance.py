"""Mounting errors and failures: from the scene's settings to a study."""

import math

import pytest

import pe_core as pe
import pe_tools as pt
from blender_addon import bridge
from pe_core import search
from pe_tools import advice
from tests.addon import scenes


@pytest.fixture
def settings(car):
    return car.perception_entropy


def test_a_scene_s_search_scores_placements_as_they_stand_until_told_otherwise(settings):
    assert scenes.study().search.tolerance == pe.Tolerance()
    settings.mounting_errors = True
    assert scenes.study().search.tolerance == pe.Tolerance(0.01, math.radians(0.3))


def outcome(rise, loss, warnings=()):
    """Return a search's outcome with a start that stands everything."""
    study = scenes.study()
    score = study.evaluator(1024).score(study.rig)
    failed = None if loss is None else 2.0 + loss
    before = search.RigRobustness(2.0, 2.0, 2.0, 0.0, None if loss is None else 2.0)
    after = search.RigRobustness(2.0, 2.0 + rise, 3.0, 0.01, failed)
    found = search.Robustness(pe.Tolerance(0.01, 0.005), 1024, before, after)
    both = study, study, score, score
    return pt.Outcome("optimize", *both, warnings=warnings, robustness=found)


def test_what_a_search_tells_of_it_is_stored_for_the_panel(settings, car):
    told = advice.fragile(0.25, 0.01, 0.01, 0.005, tolerant=True)
    bridge.store_outcome(car, outcome(0.25, 1.5, told), "signature")
    assert settings.result.robustness("rise") == "+0.000 \N{RIGHTWARDS ARROW} +0.250 nats"
    assert settings.result.robustness("loss") == "+0.000 \N{RIGHTWARDS ARROW} +1.500 nats"
    assert settings.result.fragile == told[0].text
    assert not len(settings.result_warnings)  # none of the vehicle
    bridge.store_outcome(car, outcome(0.01, None), "signature")
    assert settings.result.robustness("rise") and not settings.result.robustness("loss")
    assert not settings.result.fragile


def test_a_score_takes_away_what_a_search_told(settings, car):
    settings.score_samples = 1024
    bridge.store_outcome(car, outcome(0.25, 1.5), "signature")
    study = scenes.study()
    job = pt.ScoreJob(study)
    list(job)
    bridge.store_outcome(car, job.outcome, "signature")
    assert settings.result.robustness("rise") == settings.result.robustness("loss") == ""
