"""A summary is the whole rig's part of a sampled score, to the bit."""

from dataclasses import fields

import pytest

import pe_core as pe
from tests.engine.test_preview import CAR, SPACE, rig_at

SAMPLES = 4096


def evaluator(samples=SAMPLES):
    return pe.Evaluator(SPACE, pe.Prior.road(), CAR, samples=samples)


@pytest.mark.parametrize("preview", [False, True])
def test_a_summary_and_a_score_agree(preview):
    rig = rig_at((0.0, 0.0, 1.9))
    summary, score = (
        evaluator().summary(rig, preview=preview),
        evaluator().score(rig, preview=preview),
    )
    names = {field.name for field in fields(summary)} - {"ap"}
    assert names == {field.name for field in fields(score)} - {
        "per_sensor",
        "ground_map",
        "objects",
        "scatter",
    }
    assert {name: getattr(summary, name) for name in names} == {
        name: getattr(score, name) for name in names
    }
    assert summary.preview == preview and summary.ap is None


def test_a_summary_at_objects_has_the_ap_of_the_score():
    rule = pe.TargetRule("objects", traffic=True, scenes=8)
    evaluator = pe.ObjectEvaluator(SPACE, pe.Prior.road(), CAR, targets=rule)
    rig = rig_at((0.0, 0.0, 1.9))
    assert evaluator.summary(rig).ap == evaluator.score(rig).objects.ap


def test_an_exact_summary_after_previews_is_that_of_a_new_evaluator():
    kept = evaluator()
    for x in (0.0, 0.1, 0.2):
        kept.summary(rig_at((x, 0.0, 1.9)), preview=True)
    rig = rig_at((0.2, 0.0, 1.9))
    assert kept.summary(rig) == evaluator().summary(rig)


def test_the_grid_has_one_as_well():
    on_grid, rig = evaluator(samples=0), rig_at((0.0, 0.0, 1.9))
    summary, score = on_grid.summary(rig), on_grid.score(rig, preview=True)
    assert summary.preview == score.preview is False
    assert (summary.entropy, summary.per_zone) == (score.entropy, score.per_zone)
