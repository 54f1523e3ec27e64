"""Assumptions, and the plan of blind ground."""

import dataclasses
from pathlib import Path

import pe_core as pe
import pe_tools as pt
from pe_core.motion import scenarios
from pe_tools.page import ReportContext, keyed_contexts
from pe_tools.page.sections.traceability import (
    CURVE_SOURCES,
    PRIOR_SOURCES,
    VALIDITY,
    VALIDITY_PAGE,
    assumptions,
)
from pe_tools.page.sections.visibility import drive_by
from tests.engine.processes import finished
from tests.review.conftest import html_of, small_study

ROOT = Path(__file__).resolve().parents[2]
CAR = small_study().vehicle  # 4.4 x 1.8 x 1.5 m, its floor 0.2 m over the ground


def test_the_page_says_what_it_rests_on_and_what_it_does_not_say(scored):
    values = assumptions((scored,))
    assert [row[-1] for row in values["curves"]] == list(CURVE_SOURCES.values())
    assert values["prior_source"] == PRIOR_SOURCES["road"]
    limits = html_of(assumptions, scored).count("<li>")
    own = pe.PerceptionModel(lidar=pe.ApCurve(0.2, 0.5))
    study = dataclasses.replace(small_study(), model=own, vehicle=None)
    score = scored.after
    (other,) = keyed_contexts(
        [ReportContext("own", pt.Outcome("score", study, study, score, after=score))]
    )
    lidar = assumptions((other,))["curves"][0]
    assert lidar[1:3] == ["0.200", "0.500"] and lidar[-1] not in CURVE_SOURCES.values()
    assert html_of(assumptions, other).count("<li>") == limits + 1, "without a vehicle"


def test_the_verdict_on_validity_is_that_of_its_page():
    text = " ".join((ROOT / VALIDITY_PAGE).read_text("utf-8").split())
    assert VALIDITY in text and "16 placements in two papers" in text
    assert "detectors find more at a better score" in text and "a blind sector" in text  # OWN_STUDY


def test_scenarios_say_of_how_many_frames_a_track_is_confirmed():
    study = dataclasses.replace(small_study(), scenarios=(scenarios()["crossing_child"],))
    html = html_of(drive_by, ReportContext("car", finished(pt.ScoreJob(study))))
    assert "3 of the last 5 frames" in html
