"""Mounting errors and failures: from the scene's settings to a study."""

import math

import pytest

import pe_core as pe
from tests.addon import scenes


@pytest.fixture
def settings(car):
    return car.perception_entropy


def test_a_scene_s_search_scores_placements_as_they_stand_until_told_otherwise(settings):
    assert scenes.study().search.tolerance == pe.Tolerance()
    settings.mounting_errors = True
    assert scenes.study().search.tolerance == pe.Tolerance(0.01, math.radians(0.3))


def test_errors_reach_the_study_as_they_were_typed(settings):
    settings.mounting_errors = settings.worst = settings.failures = True
    settings.tolerance_position, settings.tolerance_angle = 0.003, 0.7
    found = scenes.study().search.tolerance
    assert found == pe.Tolerance(0.003, math.radians(0.7), failures=True, worst=True)


def test_the_worst_of_one_case_is_that_case(settings):
    settings.worst = True
    assert scenes.study().search.tolerance == pe.Tolerance()


def test_a_failure_that_leaves_nothing_is_told_by_the_search_and_hinders_no_score(settings):
    settings.failures = True
    study = scenes.study()
    with pytest.raises(pe.InputError, match="failures: expected a rig of at least two sensors"):
        study.coding()
