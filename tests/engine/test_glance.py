"""A glance is the whole rig's part of a sampled score, to the bit."""

from dataclasses import fields

import pytest

import pe_core as pe
from tests.engine.test_draft import CAR, SPACE, rig_at

SAMPLES = 4096


def evaluator(samples=SAMPLES):
    return pe.Evaluator(SPACE, pe.Prior.road(), CAR, samples=samples)


@pytest.mark.parametrize("draft", [False, True])
def test_a_glance_and_a_score_agree(draft):
    rig = rig_at((0.0, 0.0, 1.9))
    glance, score = evaluator().glance(rig, draft=draft), evaluator().score(rig, draft=draft)
    names = {field.name for field in fields(glance)} - {"ap"}
    assert names == {field.name for field in fields(score)} - {
        "per_sensor",
        "ground_map",
        "objects",
        "scatter",
    }
    assert {name: getattr(glance, name) for name in names} == {
        name: getattr(score, name) for name in names
    }
    assert glance.draft == draft and glance.ap is None


def test_a_glance_at_objects_has_the_ap_of_the_score():
    rule = pe.TargetRule("objects", traffic=True, scenes=8)
    judge = pe.ObjectEvaluator(SPACE, pe.Prior.road(), CAR, targets=rule)
    rig = rig_at((0.0, 0.0, 1.9))
    assert judge.glance(rig).ap == judge.score(rig).objects.ap


def test_an_exact_glance_after_drafts_is_that_of_a_new_evaluator():
    kept = evaluator()
    for x in (0.0, 0.1, 0.2):
        kept.glance(rig_at((x, 0.0, 1.9)), draft=True)
    rig = rig_at((0.2, 0.0, 1.9))
    assert kept.glance(rig) == evaluator().glance(rig)


def test_the_grid_has_none():
    with pytest.raises(pe.InputError, match="glance: expected a sampled score"):
        evaluator(samples=0).glance(rig_at((0.0, 0.0, 1.9)))
