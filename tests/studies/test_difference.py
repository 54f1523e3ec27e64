"""What a difference is worth: pairs by hand, curves found again, verdicts, the table."""

import json
import math
import tomllib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pe_core import InputError
from studies.cameras import scores as of_cameras
from studies.cameras.published_rigs import RIGS
from studies.difference import kinds, worth
from studies.difference.__main__ import measured, page_of, table_text, write_table
from studies.difference.pairs import Group, log_loss, pairs_of, probability
from studies.difference.worth import HOLDS, REFUTED, UNDECIDED, DifferenceEffort, Kind

QUICK = DifferenceEffort(resamples=60)


def group(score, *aps, name="one"):
    return Group(name, {"entropy": np.array(score, float)}, np.array(aps, float))


def test_pairs_by_hand():
    found = pairs_of(
        [group([1.0, 3.0, 3.0], [0.2, 0.3, 0.1]), group([0.0, 1.0], [0.5, 0.5])], "entropy"
    )
    assert found.ties == 1 and found.d.tolist() == [1.0, 2.0, 2.0]
    assert found.right.tolist() == [0.5, 1.0, 0.0]
    assert {*zip(found.first.tolist(), found.second.tolist(), strict=True)} == {
        (4, 3),
        (1, 0),
        (2, 0),
    }
    assert found.rigs == 5 and found.share() == 0.5
    both = pairs_of([group([1.0, 2.0], [0.1, 0.2], [0.2, 0.1])], "entropy")
    assert sorted(both.right.tolist()) == [0.0, 1.0] and both.rigs == 2  # a detector each


def test_the_slope_is_that_of_the_likelihood():
    found = pairs_of([group([0.0, 1.0, 2.0, 2.5], [0.1, 0.2, 0.15, 0.3])], "entropy")
    k = found.slope()
    grid = np.linspace(-5.0, 10.0, 3001)
    losses = [log_loss(probability(g, found.d), found.right).sum() for g in grid]
    assert k == pytest.approx(grid[int(np.argmin(losses))], abs=0.006)
    assert pairs_of([group([0.0, 2.0], [0.1, 0.2])], "entropy").slope() == math.inf
    assert pairs_of([group([0.0, 2.0], [0.2, 0.1])], "entropy").slope() == -math.inf
    assert math.isnan(found.slope(np.zeros(len(found.d))))
    weights = np.where(found.right == 1.0, 2.0, 1.0)
    assert found.slope(weights) > k


def test_probabilities_of_infinite_slopes_and_losses_are_finite():
    d = np.array([0.1, 10.0])
    assert probability(math.inf, d).tolist() == [1.0, 1.0]
    assert probability(-math.inf, d).tolist() == [0.0, 0.0]
    assert probability(0.0, d).tolist() == [0.5, 0.5]
    assert log_loss(np.array([1.0]), np.array([0.0]))[0] == pytest.approx(-math.log(0.001))


def made_up(slope, rigs=16, groups=2, seed=3):
    """Rigs whose AP follows the score with noise; a slope of 0: not at all."""
    rng = np.random.default_rng(seed)
    made = []
    for number in range(groups):
        score = rng.normal(size=rigs)
        ap = 0.5 + 0.05 * (slope * score + rng.normal(size=rigs))
        rows = dict.fromkeys(("entropy", "traffic_ap", "coverage"), score)
        made.append(Group(f"group {number}", rows, ap[None, :]))
    return Kind("lidars_fixed", "LiDARs, one vehicle", "made up", made)


def test_a_score_that_goes_with_ap_enters_the_table_and_another_does_not():
    good = worth.worth_of(made_up(2.0), "entropy", QUICK)
    assert good["verdicts"] == {"1": HOLDS, "2": HOLDS, "3": HOLDS} and good["in_table"]
    low, high = good["interval"]
    assert 0.0 < low < good["k"] < high and good["largest"] > 2.0
    none = worth.worth_of(made_up(0.0), "entropy", QUICK)
    assert none["verdicts"]["1"] == UNDECIDED and not none["in_table"]
    wrong = worth.worth_of(made_up(-2.0), "entropy", QUICK)
    assert wrong["verdicts"]["1"] == REFUTED and not wrong["in_table"]
    few = worth.worth_of(made_up(2.0, rigs=8), "entropy", QUICK)
    assert few["verdicts"]["1"] == HOLDS and not few["in_table"]


def test_a_rig_is_judged_by_the_pairs_of_others():
    """The last rig is against all others: its pairs are wrong, and their folds do not know it."""
    ap = [*np.linspace(0.1, 0.8, 8), 0.05]
    found = pairs_of([group(range(9), ap)], "entropy")
    judged = worth.left_out(found)
    of_last = found.has(8)
    assert judged.p[of_last].min() > 0.5  # one of two folds: all others are right, so P is 1
    alone = pairs_of([group(range(8), ap[:8])], "entropy")
    assert alone.slope() == math.inf
    assert judged.curve > worth.left_out(alone).curve


def test_verdicts_by_hand():
    assert worth.foretells(0.5, 0.6) == HOLDS and worth.foretells(0.65, 0.6) == UNDECIDED
    assert worth.foretells(0.7, 0.8) == REFUTED
    third = {"share": 0.8, "p": 0.7}
    assert worth.calibrated([third]) == HOLDS
    assert worth.calibrated([third, {"share": 0.5, "p": 0.65}]) == UNDECIDED
    assert worth.calibrated([third, {"share": 0.4, "p": 0.65}]) == REFUTED
    good = {"1": HOLDS, "2": HOLDS, "3": UNDECIDED}
    assert worth.enters(good, 12) and not worth.enters(good, 11)
    assert not worth.enters({**good, "3": REFUTED}, 12)
    assert not worth.enters({**good, "2": UNDECIDED}, 12)


def test_intervals_draw_whole_rigs():
    """A detector that is counted twice is no further sample."""
    kind = made_up(1.0)
    twice = [Group(g.name, g.scores, np.concatenate([g.aps, g.aps])) for g in kind.groups]
    once = worth.slope_interval(pairs_of(kind.groups, "entropy"), QUICK)
    assert worth.slope_interval(pairs_of(twice, "entropy"), QUICK) == pytest.approx(once)


def test_the_page_and_the_table_have_what_was_found(tmp_path):
    found = measured([made_up(2.0), made_up(0.0)], QUICK)  # of one name: the second stays
    assert not tomllib.loads(table_text(found)).get("difference")
    found = measured([made_up(2.0)], QUICK)
    rows = tomllib.loads(table_text(found))["difference"]
    assert [row["score"] for row in rows] == ["entropy", "traffic_ap", "coverage"]
    assert rows[0]["rigs"] == 32 and rows[0]["k_low"] < rows[0]["k"] < rows[0]["k_high"]
    write_table(tmp_path / "table.toml", found)
    write_table(tmp_path / "table.toml", found)
    (tmp_path / "other.toml").write_text("a = 1\n", "utf-8")
    with pytest.raises(InputError):
        write_table(tmp_path / "other.toml", found)
    assert page_of(found).count("| LiDARs, one vehicle |") == 9


def test_camera_rigs_are_paired_by_detector():
    rng = np.random.default_rng(2)
    names = (of_cameras.ENTROPY, of_cameras.EXPECTED_AP, of_cameras.COVERAGE)
    values = rng.random((len(RIGS), 3))
    scores = {
        rig: {"car": dict(zip(names, row, strict=True))}
        for rig, row in zip(RIGS, values.tolist(), strict=True)
    }
    aps = {name: {"car": rng.random(len(RIGS))} for name in ("one", "two")}
    cameras = [SimpleNamespace(rig=range(number)) for number in (6, 4, 9)]
    rigs = SimpleNamespace(digest="a", by_detector=aps, rigs=cameras)
    kind = kinds.camera_kind(rigs, {"data": "a", "scores": scores})
    assert (kind.of_class, kind.within, kind.sensors) == ("car", 50.0, (4, 9))
    found = measured([made_up(2.0), replace(kind, groups=made_up(2.0).groups)], QUICK)
    rows = tomllib.loads(table_text(found))["difference"]
    assert [row.get("of_class") for row in rows] == 3 * [None] + 3 * ["car"]
    assert "beside the AP of class *car*" in page_of(found)
    assert kind.smallest == 14 and len(pairs_of(kind.groups, "entropy").d) == 2 * 91
    with pytest.raises(InputError):
        kinds.camera_kind(rigs, {"data": "b", "scores": scores})


@pytest.mark.thorough
def test_stored_results_have_the_rigs_of_the_plan():
    own = kinds.own_kinds()
    assert [sum(g.size for g in kind.groups) for kind in own] == [32, 48, 96]
    assert all(len(kind.groups) == 2 for kind in own)
    assert [group.size for group in kinds.published_kind().groups] == [8, 8]


def test_stored_conclusions_follow_from_their_figures():
    path = kinds.VALIDITY / "difference" / "results.json"
    if not path.exists():
        pytest.skip("no results yet")
    for kind in json.loads(path.read_text("utf-8"))["kinds"].values():
        for row in kind["scores"].values():
            loss = row["log_loss"]
            assert row["verdicts"]["2"] == worth.foretells(loss["curve"], loss["constant"])
            assert row["verdicts"]["3"] == worth.calibrated(row["thirds"])
            assert row["in_table"] == worth.enters(row["verdicts"], kind["smallest"])
