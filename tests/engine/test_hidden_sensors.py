"""Sensors that see nothing, or are mostly occluded, are named first wherever a score is told."""

import dataclasses

import pytest

import pe_core as pe
from pe_tools import advice
from pe_tools.cli.terminal import summary
from tests.engine import shapes

INSIDE, SIDE = "camera in the boot", "side"


def sensor_score(coverage, stopped=0, beams=1000):
    return pe.SensorScore(4.0, coverage, 0.1, beams, stopped, {"body": stopped} if stopped else {})


RIG = pe.Rig([shapes.lidar_on_roof(), dataclasses.replace(shapes.camera(60.0), name=INSIDE)])


@pytest.mark.parametrize(
    "stopped, coverage, warned, stderr, lines",
    [
        (0, 0.5, (), 0.0, ()),
        (500, 0.5, (), 0.0, ()),  # half is the limit
        (
            *(860, 0.02, (), 0.0),
            ("camera in the boot (86% of its picture occluded) is mostly occluded",),
        ),
        (
            *(1000, 0.0, ("inside",), 0.0),
            ("camera in the boot (inside the body, 100% of its picture occluded) sees nothing",),
        ),
        (
            *(1000, 0.0, (), 0.02),
            ("camera in the boot (100% of its picture occluded) sees nothing, or next to it",),
        ),
        (
            *(0, 0.0, (), 0.0),
            ("camera in the boot (no object is expected where it looks) sees nothing",),
        ),
    ],
    ids=["well", "half", "mostly", "inside", "sampled", "away"],
)
def test_what_is_reported_of_it(stopped, coverage, warned, stderr, lines):
    own = {"roof": sensor_score(0.6), INSIDE: sensor_score(coverage, stopped)}
    score = pe.Score(2.0, 0.6, stderr, {}, {}, own, 9)
    warnings = [pe.Advice(INSIDE, code) for code in warned]
    assert advice.hidden_words(advice.hidden_sensors(RIG, score, warnings)) == lines
    assert advice.words(score, RIG, warnings=warnings)[: len(lines)] == lines
    assert not advice.words(score)[0].startswith("camera")


def test_several_are_one_line_a_kind_and_the_dead_come_first():
    names = ["a", "b", "c"]
    rig = pe.Rig([dataclasses.replace(shapes.camera(60.0), name=name) for name in names])
    own = {
        "a": sensor_score(0.1, 700),
        "b": sensor_score(0.0, 1000),
        "c": sensor_score(0.0, 1000),
    }
    found = advice.hidden_sensors(rig, pe.Score(2.0, 0.1, 0.0, {}, {}, own, 9))
    assert [each.name for each in found] == ["b", "c", "a"]
    assert advice.hidden_words(found) == (
        "b (100% of its picture occluded) and c (100% of its picture occluded) see nothing",
        "a (70% of its picture occluded) is mostly occluded",
    )


def test_a_camera_inside_the_body_is_named_by_the_summary():
    inside = dataclasses.replace(shapes.camera(60.0, (0.0, 0.0, 0.9)), name=INSIDE)
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(8, 90)), inside])
    study = pe.Study(rig, shapes.box_car(), shapes.small_space(1.0))
    job = pe.ScoreJob(study)
    for _ in job:
        pass
    line = f"ATTENTION: {INSIDE} (inside the body, 100% of its picture occluded) sees nothing"
    assert line in summary(job.outcome).splitlines()
