"""Scores side by side: what differs, what only seems to, and the sentences that say so."""

import dataclasses
import math
from statistics import fmean, stdev

import numpy as np
import pytest

import pe_core as pe
from pe_core.base import dump_json
from pe_core.base.table_reader import finite
from pe_core.scoring.score import Scatter
from pe_core.search import FIGURES
from pe_tools import advice
from pe_tools.advice.score_comparison import difference_errors, sure_factor
from pe_tools.cli.explain_verbs import comparison
from tests.engine import shapes

ENTROPY = ("rig", "", "entropy")
COVERAGE = ("rig", "", "coverage")
NOISE = [
    0.02 / math.sqrt(256 / 15) * np.cos(math.pi * (np.arange(16) + 0.5) * k / 16)
    for k in range(1, 7)
]
"""Residuals of six scores: each sums to 0, its squares to 8 of the factor's, and is orthogonal to
the others. By hand: the error of each difference is sqrt(16 / 15 * 2 * 8) of the factor, 0.02."""
MODEL = shapes.small_lidar(16, 180)
PAIR = [pe.Rig([shapes.lidar_on_roof(MODEL, (x, 0.0, 2.0))]) for x in (0.0, 0.4)]
COMPARED = [ENTROPY, COVERAGE, ("zone", "near", "entropy"), ("class", "car", "coverage")]


def score(entropy, coverage=0.5, own=None, sample="one", stderr=0.03):
    """A score whose residuals are `own` beside those that all scores of the sample share."""
    scatter = None
    if own is not None:
        shared = np.linspace(-0.01, 0.01, 16)
        off = shared + own - np.mean(own)
        scatter = Scatter(sample, {ENTROPY: tuple(off), COVERAGE: tuple(off / 20.0)})
    return pe.Score(
        entropy,
        coverage,
        stderr,
        per_class={},
        per_zone={},
        per_sensor={},
        voxels=4096,
        scatter=scatter,
    )


@pytest.mark.parametrize(
    "studies, degrees, factor",
    [
        (1, 15, 2.1314),
        (2, 15, 2.1314),
        (3, 15, 2.6937),
        (6, 15, 3.4837),
        (2, 31, 2.0395),
        (1, 4, 2.7764),
        (1, 2, 4.271),  # five terms of a series: the table has 4.3027
    ],
)
def test_the_factor_is_student_s_t_shared_by_all_pairs(studies, degrees, factor):
    """Tables of t: two-sided, 5 % divided by 1, 1, 3, 15, 1 and 1 pairs."""
    assert sure_factor(studies, degrees) == pytest.approx(factor, abs=2e-3)


def test_the_error_of_a_difference_is_paired_on_one_sample_and_in_square_on_two():
    a, b, c = (score(2.0, own=own) for own in NOISE[:3])
    other = score(2.0, own=NOISE[3], sample="another")
    found = difference_errors([a, b, other], ENTROPY)
    assert found[0][1] == found[1][0] == pytest.approx(0.02)
    assert found[0][0] == 0.0
    assert found[0][2] == found[1][2] == pytest.approx(math.hypot(0.03, 0.03))
    assert difference_errors([a, score(2.0), c], ENTROPY)[0][1] == pytest.approx(
        math.hypot(0.03, 0.03)
    )
    assert difference_errors([score(2.0, stderr=0.0)] * 2, ENTROPY) == ((0.0, 0.0), (0.0, 0.0))


def test_a_scatter_comes_back_from_its_data():
    kept = score(2.0, own=NOISE[0]).scatter
    assert Scatter.from_dict(kept.to_dict()) == kept


def ranked(entropies, own=True, **more):
    scores = {
        name: score(entropy, own=NOISE[k] if own else None, **more)
        for k, (name, entropy) in enumerate(zip("ABCDEF", entropies, strict=False))
    }
    rows = advice.compare(scores)
    return advice.ranking(list(scores), rows)[0], rows[0]


@pytest.mark.parametrize(
    ("entropies", "own", "more", "best"),
    [
        ((1.63, 1.54), True, {}, (False, True)),
        ((1.54, 1.56), True, {}, (False, False)),
        ((1.54, 1.55, 1.70, 1.71, 1.90, 2.10), True, {}, (True, True, *[False] * 4)),
        # Without what pairs them the error is 0.04, and 2.13 of it 0.09.
        ((1.54, 1.60), False, {}, (False, False)),
        ((1.546, 1.54), False, {"stderr": 0.0}, (False, True)),  # of all voxels
        ((1.544, 1.54), False, {"stderr": 0.0}, (False, False)),
    ],
    ids=["two", "two alike", "six in groups", "not paired", "exact", "too little to count"],
)
def test_who_is_better_and_who_is_alike(entropies, own, more, best):
    assert ranked(entropies, own, **more)[1].best == best


def test_paired_errors_are_the_scatter_of_differences_on_other_samples():
    """60 samples of 2048 voxels, two rigs on each: what is told is what differences scatter by.

    Half of it would be too low, twice too high; and the rigs' own errors are some times as large.
    """
    space = shapes.small_space()
    prior = pe.Prior.road()
    told, found, alone = ({figure: [] for figure in COMPARED} for _ in range(3))
    for shift in np.random.default_rng(5).random((60, 3)):
        evaluator = pe.Evaluator(space, prior, samples=2048, shift=tuple(shift))
        scores = [evaluator.score(rig) for rig in PAIR]
        assert scores[0].scatter.sample == scores[1].scatter.sample
        for figure in COMPARED:
            told[figure].append(difference_errors(scores, figure)[0][1])
            found[figure].append(_value(scores[1], figure) - _value(scores[0], figure))
            alone[figure].append(scores[0].scatter.error(figure))
    for figure in COMPARED:
        ratio = math.sqrt(fmean(e * e for e in told[figure])) / stdev(found[figure])
        assert 0.8 < ratio < 2.0, (figure, ratio)
    assert fmean(told[ENTROPY]) < 0.7 * math.sqrt(2.0) * fmean(alone[ENTROPY])


def _value(score, figure):
    group, name, measure = figure
    parts = {"rig": {"": score}, "zone": score.per_zone, "class": score.per_class}
    return getattr(parts[group][name], measure)


def test_a_gain_counts_when_it_is_clear_and_a_loss_from_two_errors_on():
    """The error of a difference is 0.02: 2.13 times that is clear."""
    entropies = (2.0, 1.959, 2.041, 1.9, 2.039)
    scores = [score(h, own=NOISE[k]) for k, h in enumerate(entropies)]
    for first, second in (0, 1), (0, 2), (0, 3), (0, 4):
        row = advice.compare({"a": scores[first], "b": scores[second]})[0]
        assert row.sense(0) == 0
        assert row.sense(1) == {1: 0, 2: 1, 3: -1, 4: 0}[second]


def test_errors_of_objects_that_are_not_paired_are_their_own():
    """Of two samples: AP of all classes, AP and entropy of one, by the errors that a score has."""
    rule = pe.TargetRule("objects", scenes=24)
    prior = pe.Prior.road()
    evaluator = pe.ObjectEvaluator(shapes.small_space(), prior, targets=rule)
    one = dataclasses.replace(evaluator.score(PAIR[0]), scatter=None)
    car = one.objects.per_class["car"]
    for figure, error in (
        (("rig", "", "ap"), one.objects.ap_stderr),
        (("class", "car", "ap"), car.ap_stderr),
        (("class", "car", "entropy"), car.stderr),
    ):
        assert difference_errors([one, one], figure)[0][1] == pytest.approx(math.sqrt(2.0) * error)


@pytest.mark.parametrize(
    ("margins", "senses", "cells"),
    [
        ((0.2, None), [0, 1], ["0.2*", "none"]),
        ((None, -3.0), [0, -1], ["none", "-3.0*"]),
        ((None, None), [0, 0], ["none", "none"]),
        ((0.2, "no such scenario"), [0, 0], ["0.2", "-"]),
    ],
)
def test_a_scenario_that_is_never_confirmed_is_the_worst_there_is(margins, senses, cells):
    scenarios = [{} if own == "no such scenario" else {"child": own} for own in margins]
    by_rig = {
        name: advice.KeyFigures(None, (), 0.5, 10.0, margins=own)
        for name, own in zip("ab", scenarios, strict=True)
    }
    (row,) = (r for r in advice.compare_figures(by_rig) if r.measure == "scenario_margin")
    assert [row.sense(0), row.sense(1)] == senses
    (line,) = (line for line in comparison(["a", "b"], [row]) if line.startswith("  child"))
    assert line.split()[1:] == cells
    assert row.spread == (math.inf if row.sense(1) else 0.0)
    assert row.share(1) == 0.0 <= row.share(0)
    dump_json(finite(row.to_dict()))


@pytest.mark.parametrize("measure", list(FIGURES))
def test_what_is_told_alike_is_neither_better_nor_worse(measure):
    """Reach 37.9 and 37.1 m are both told as 37 m: a colour beside them is no news."""
    step = 10.0 ** -FIGURES[measure].decimals / FIGURES[measure].scale
    exact = ((0.0, 0.0), (0.0, 0.0))
    alike = 0
    for by in (0.1, 0.3, 0.9, 2.5):
        row = advice.ComparedRow("rig", "", measure, (40.2 * step, (40.2 + by) * step), exact)
        if row.text(0) == row.text(1):
            alike += 1
            assert row.sense(1) == 0 and row.spread == 0.0 and row.best == (False, False)
    assert 0 < alike < 4
