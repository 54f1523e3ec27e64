"""What a difference in score is worth: the table's rows, beside which differences they stand."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

import pe_core as pe
from pe_core.scoring import NO_DIFFERENCE, is_noise
from pe_core.scoring.targets import TargetRule
from pe_tools.advice import ComparedRow, differences, worth_lines, worth_rows
from pe_tools.advice.differences import KINDS, Worth, worth_text, worths
from tests.engine import shapes

RESULTS = Path(__file__).parents[2] / "docs/validity/difference/results.json"
ROW = Worth(
    kind="lidars_fixed",
    score="entropy",
    k=2.0,
    k_low=1.0,
    k_high=4.0,
    largest=1.0,
    rigs=32,
    pairs=240,
    source="made up",
)
MODEL = shapes.small_lidar(16, 180)
WITHIN = pe.PerceptionSpace((-50, 50), (-50, 50), (0, 5))
IN_TRAFFIC = TargetRule("objects", True)


def rig_at(x, model=MODEL, **more):
    return pe.Rig([pe.Sensor("roof", model, pe.Pose((x, 0.0, 2.0)), **more)])


def study(**changes):
    return pe.Study(rig=rig_at(0.0), **changes)


def test_of_ten_by_hand_and_not_beyond_the_largest():
    assert ROW.of_ten(0.5) == (7, 6, 9)  # 0.731, 0.622, 0.881
    assert ROW.of_ten(-0.5) == ROW.of_ten(0.5)
    assert ROW.of_ten(0.0) == (5, 5, 5)
    assert ROW.of_ten(50.0) == ROW.of_ten(1.0) == (9, 7, 10)
    text = worth_text(ROW, 0.5)
    assert all(part in text for part in ("7 of 10", "6 to 9", "entropy", "LiDARs"))


def test_the_table_has_the_rows_of_the_study():
    saved = json.loads(RESULTS.read_text("utf-8"))["kinds"]
    expected = {
        (name, score): (
            (row["k"], *row["interval"], row["largest"], row["rigs"], row["pairs"]),
            (kind.get("of_class", ""), kind.get("within", 0.0), *kind.get("sensors", (0, 0))),
        )
        for name, kind in saved.items()
        for score, row in kind["scores"].items()
        if row["in_table"]
    }
    found = {
        (w.kind, w.score): (
            (w.k, w.k_low, w.k_high, w.largest, w.rigs, w.pairs),
            (w.of_class, w.within, *w.sensors),
        )
        for w in worths()
    }
    assert found == expected
    known = {kind for labels in KINDS.values() for kind in labels}
    assert {worth.kind for worth in worths()} <= known


@pytest.mark.parametrize(
    ("changes", "rigs", "one_vehicle"),
    [
        ({"prior": pe.Prior.highway()}, [rig_at(0.0), rig_at(1.0)], True),
        ({"targets": TargetRule("objects")}, [rig_at(0.0), rig_at(1.0)], True),
        ({"model": pe.PerceptionModel("literal")}, [rig_at(0.0), rig_at(1.0)], True),
        ({"space": pe.PerceptionSpace((-20, 20))}, [rig_at(0.0), rig_at(1.0)], True),
        ({}, [rig_at(0.0), rig_at(1.0)], False),
        ({}, [rig_at(0.0), rig_at(1.0, shapes.small_lidar(32, 180))], True),
        ({}, [rig_at(0.0), rig_at(1.0, fusion="other")], True),
        ({}, [rig_at(0.0), rig_at(1.0, curve=pe.ApCurve(0.1, 0.1))], True),
        ({}, [rig_at(0.0), rig_at(0.0, pe.Camera("camera", 640, 480, 1.0))], True),
    ],
    ids=["prior", "objects", "fusion", "space", "vehicle", "models", "group", "curve", "kinds"],
)
def test_nothing_is_said_where_no_pairs_were_alike(changes, rigs, one_vehicle):
    assert worth_rows(study(), [rig_at(0.0), rig_at(1.0)], one_vehicle=True)
    assert worth_rows(study(**changes), rigs, one_vehicle=one_vehicle) == {}


def cameras(*fields, count=6):
    """A rig for each field, of so many cameras."""
    rigs = []
    for field in fields:
        model = pe.Camera("camera", 640, 480, field)
        rigs.append(
            pe.Rig([pe.Sensor(f"camera {k}", model, pe.Pose((k, 0.0, 2.0))) for k in range(count)])
        )
    return rigs


def test_rigs_of_cameras_have_their_row_where_cars_within_50_m_are_scored_in_traffic():
    """Whatever their models; the pairs were scored so, and nothing else is said to be."""
    by = study(space=WITHIN, targets=IN_TRAFFIC)
    found = worth_rows(by, cameras(1.0, 1.5), one_vehicle=False)
    assert set(found) == {"traffic_ap"} and found["traffic_ap"].kind == "cameras"
    assert found["traffic_ap"].beside == ("class", "car", "ap")
    assert "cars within 50 m" in worth_text(found["traffic_ap"], 0.02)
    for count, said in ((3, False), (4, True), (10, True), (11, False)):
        rigs = [*cameras(1.0), *cameras(1.5, count=count)]
        assert bool(worth_rows(by, rigs, one_vehicle=False)) is said


def row_of(values, error, measure="entropy", group="rig"):
    errors = tuple(tuple(0.0 if i == j else error for j in range(3)) for i in range(3))
    return ComparedRow(group, "", measure, values, errors=errors, factor=2.13)


def test_a_line_for_each_difference_from_the_best_that_is_shown():
    row = row_of((2.0, 1.5, 1.51), 0.02)
    lines = worth_lines(["a", "b", "c"], [row], {"entropy": ROW})
    assert len(lines) == 1 and lines[0].startswith("b before a: 7 of 10")
    assert worth_lines(["a", "b", "c"], [row], {}) == ()
    assert worth_lines(["a", "b", "c"], [row_of((2.0, 1.5, 1.5), 0.5)], {"entropy": ROW}) == ()
    part = ComparedRow("zone", "near", "entropy", row.values, errors=row.errors)
    assert worth_lines(["a", "b", "c"], [part], {"entropy": ROW}) == ()
    ap = row_of((0.5, 0.6, 0.7), 0.001, "ap", "in traffic")
    traffic = replace(ROW, score="traffic_ap")
    assert len(worth_lines(["a", "b", "c"], [ap], {"traffic_ap": traffic})) == 2


def test_within_two_standard_errors_no_difference_is_shown():
    assert is_noise(0.02, 0.01) and not is_noise(0.021, 0.01) and not is_noise(0.1, 0.0)
    row = row_of((2.0, 2.039, 2.041), 0.02)
    assert row.change_text(1) == NO_DIFFERENCE and row.change_text(2) == "+0.041 +- 0.020"
    assert (row.sense(1), row.sense(2)) == (0, 1)  # a loss counts from there on
    assert row_of((2.0, 2.0, math.nan), 0.02).change_text(1) == "+0.000"
    assert row_of((2.0, 2.5, 2.5), 0.0).change_text(1) == "+0.500"  # on all voxels
    assert differences.FILE.is_file()
