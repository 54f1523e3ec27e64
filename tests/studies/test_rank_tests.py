"""Our own study's statistics against known values, and verdicts that only a whole design has."""

import itertools
import math

import numpy as np
import pytest

from studies.detectors.analysis import HOLDS, OPEN, REFUTED, UNDECIDED, analysis, step_title
from studies.detectors.page import ANSWERS
from studies.detectors.placements import placements
from studies.detectors.plan import FIXED, full_plan, rings_of
from studies.detectors.runs import runs
from studies.detectors.scores import PRIMARY
from studies.pages import sentence
from studies.ranks import (
    PlacementSamples,
    interval,
    ordered_share,
    partial_rho,
    permutation_p,
    rho_within,
)

RULE = full_plan().statistics.but(permutations=9_999, resamples=500)


def samples_of(aps, groups=None):
    aps = np.atleast_2d(np.asarray(aps, float))
    aps = aps.T if aps.shape[0] == 1 else aps
    groups = np.zeros(len(aps), int) if groups is None else np.asarray(groups)
    return PlacementSamples(aps, groups, np.arange(len(aps)))


def test_rho_of_a_textbook():
    """IQ and hours of television of ten people: rho = -29/165."""
    iq = np.array([106, 100, 86, 101, 99, 103, 97, 113, 112, 110.0])
    hours = np.array([7, 27, 2, 50, 28, 29, 20, 12, 6, 17.0])
    assert rho_within(iq, hours, [np.arange(10)]) == pytest.approx(-29 / 165)


def test_vehicles_are_groups_of_their_own():
    """Within each vehicle the order is reversed; pooled, the correlation would be positive."""
    score = np.array([3, 2, 1, 13, 12, 11.0])
    ap = np.array([1, 2, 3, 11, 12, 13.0])
    samples = samples_of(ap, [0, 0, 0, 1, 1, 1])
    assert rho_within(score, samples.ap, samples.members) == pytest.approx(-1.0)
    assert rho_within(score, samples.ap, [np.arange(6)]) > 0.5


def test_p_is_that_of_all_permutations():
    rng = np.random.default_rng(1)
    score, ap = rng.normal(size=(2, 6))
    samples = samples_of(ap)
    rho = abs(rho_within(score, ap, samples.members))
    exact = np.mean(
        [
            abs(rho_within(score, ap[list(order)], samples.members)) >= rho - 1e-9
            for order in itertools.permutations(range(6))
        ]
    )
    spread = math.sqrt(exact * (1 - exact) / RULE.permutations)
    assert permutation_p(score, samples, RULE, 1) == pytest.approx(exact, abs=4 * spread + 1e-3)
    assert permutation_p(np.arange(9.0), samples_of(np.arange(9.0)), RULE, 1) < 0.001


def test_partial_rho_by_hand():
    """What follows from height alone says nothing more; what height hides is found."""
    rng = np.random.default_rng(2)
    height, own = rng.normal(size=(2, 400))
    members = [np.arange(400)]
    from_height = height + 0.3 * rng.normal(size=400)
    ap = height + own
    assert abs(partial_rho(from_height, ap, height, members)) < 0.15
    assert partial_rho(height + own + 0.01, ap, height, members) == pytest.approx(1.0)
    r = {
        k: rho_within(x, y, members)
        for k, x, y in (("xy", own, ap), ("xz", own, height), ("yz", ap, height))
    }
    expected = (r["xy"] - r["xz"] * r["yz"]) / math.sqrt((1 - r["xz"] ** 2) * (1 - r["yz"] ** 2))
    assert partial_rho(own, ap, height, members) == pytest.approx(expected)


def test_intervals_hold_the_true_rho_about_as_often_as_they_say():
    """Spearman's rho of a normal pair with correlation r is 6/pi asin(r/2)."""
    rng = np.random.default_rng(3)
    r = 0.6
    count = 40
    tries = 60
    truth = 6 / math.pi * math.asin(r / 2)
    held = 0
    for _ in range(tries):
        x, e = rng.normal(size=(2, count))
        samples = samples_of(r * x + math.sqrt(1 - r * r) * e)
        low, high = interval(
            samples, RULE, 1, lambda s, x=x: rho_within(x[s.index], s.ap, [np.arange(count)])
        )
        held += low <= truth <= high
    assert 0.85 * tries <= held <= tries


def test_pairs_of_different_hardware_by_hand():
    ap = np.array([0.1, 0.2, 0.3, 0.9])
    hardware = np.array(["a", "a", "b", "b"])
    vehicle = np.zeros(4)
    # pairs: (2,0) (2,1) (3,0) (3,1); the score has the first one wrong and the second tied
    score = np.array([5.0, 4.0, 4.0, 9.0])
    assert ordered_share(score, ap, hardware, vehicle, tie=0.02) == pytest.approx(2.5 / 4)
    assert ordered_share(score, ap, hardware, vehicle, tie=0.15) == pytest.approx(2.0 / 3)
    assert math.isnan(ordered_share(score, ap, hardware, np.arange(4), tie=0.02))


def made_up(plan, missing=0):
    """Results in which AP follows the primary score; the last `missing` runs are not done."""
    chosen = {p.name: k for k, p in enumerate(placements(plan))}
    rng = np.random.default_rng(7)

    def ap(name):
        return 0.2 + 0.004 * chosen[name] + 0.001 * float(rng.uniform())

    done = {}
    for run in runs(plan)[: len(runs(plan)) - missing]:
        tested = {n: {"ap": ap(n), "trained_with": n.startswith("mixed")} for n in chosen}
        found = ap(run.placement.name if run.placement else "fixed-sedan-01")
        by_ring = {ring: {"car": found, "truck": found} for ring in rings_of(plan)}
        done[run.name] = (
            {"ap": found, "by_ring": by_ring} if run.placement else {"placements": tested}
        )
    part = {"entropy": 1.0, "ap": 0.5}
    scores = {
        name: {
            "road": {"entropy": -float(k), "coverage": 0.5},
            "uniform": -float(k % 7),
            "alone": part,
            "traffic": {"entropy": 1.0, "ap": float(-k)},
            "beams": 100,
        }
        for name, k in chosen.items()
    }
    return done, scores


def test_verdicts_follow_from_whole_designs_alone():
    plan = full_plan().but(statistics=RULE.but(permutations=499, resamples=60))
    whole = analysis(plan, *made_up(plan))
    verdicts = [row["verdict"] for row in whole["statements"]]
    assert verdicts[:3] == [HOLDS, HOLDS, HOLDS] and verdicts[5] == REFUTED
    assert whole["designs"][FIXED]["scores"][PRIMARY]["rho"] == pytest.approx(1.0)
    assert "holm" not in whole["designs"][FIXED]["scores"][PRIMARY]
    assert whole["runs"] == {"done": len(runs(plan)), "planned": len(runs(plan))}
    steps = len([r for r in runs(plan) if r.name.startswith(("town", "plain"))])
    part = analysis(plan, *made_up(plan, missing=steps + 2))  # of the rigs across hardware
    assert [row["verdict"] for row in part["statements"]] == [*verdicts[:4], OPEN, OPEN]
    part = analysis(plan, *made_up(plan, missing=steps + 10))
    assert {row["verdict"] for row in part["statements"]} == {OPEN}
    assert part["designs"][FIXED]["scores"][PRIMARY]["rho"] > 0.9  # so far


def test_a_step_decides_nothing_and_marks_the_statements_whose_sign_it_changes():
    plan = full_plan().but(statistics=RULE.but(permutations=99, resamples=60))
    done, scores = made_up(plan)
    plain = analysis(plan, done, scores)
    for name, result in done.items():
        if name.startswith("town-grid-fixed"):
            result["ap"] = 1.0 - result["ap"]
    turned = analysis(plan, done, scores)
    title = "town world, grid detector, fixed"
    assert [row["sign_changes"] for row in plain["statements"]] == [[]] * 6
    assert [row["sign_changes"] for row in turned["statements"]] == [[title]] * 4 + [[]] * 2
    for whole, other in zip(plain["statements"], turned["statements"], strict=True):
        assert {**whole, "sign_changes": []} == {**other, "sign_changes": []}
    step = next(s for s in turned["steps"] if step_title(s) == title)
    assert step["order"]["rho"] == pytest.approx(-1.0) and step["placements"] == 12
    row = step["scores"][PRIMARY]
    assert row["rho"] == pytest.approx(-1.0) and row["plain"]["rho"] == pytest.approx(1.0)
    told = sentence(ANSWERS, "verdict_of", turned["statements"][0])
    assert told == f"holds; sign changes: {title}"


@pytest.mark.parametrize(("sign", "verdict"), [(0.0, UNDECIDED), (-1.0, REFUTED)])
def test_a_sign_that_is_left_open_refutes_nothing(sign, verdict):
    """The better half has its AP at random, or against the score."""
    plan = full_plan().but(statistics=RULE.but(permutations=99, resamples=150))
    done, scores = made_up(plan)
    best = max(found["ap"] for name, found in done.items() if name.startswith("fixed"))
    rng = np.random.default_rng(11)
    for name, found in done.items():
        if name.startswith("fixed") and int(name.split("-")[2]) > 8:
            found["ap"] = best + 0.3 + sign * 0.01 * int(name.split("-")[2])
            found["ap"] += 0.001 * float(rng.uniform())
    row = analysis(plan, done, scores)["statements"][2]
    assert row["verdict"] == verdict
    assert (row["figures"]["interval"][1] < 0.0) is (verdict == REFUTED)
