"""Requirements on the page: a row each, a plan with what passes and fails, bodies in pictures."""

import dataclasses

import numpy as np
import pytest

import pe_tools as pt
from pe_core.scoring import requirements
from pe_tools.page import ReportContext
from pe_tools.page.pictures.reference_figures import worst_bodies
from pe_tools.page.pictures.sight_plans import MET_RGBA, NOT_MET_RGBA, requirement_plan
from pe_tools.page.sections.visibility import requirement_verdicts
from pe_tools.wording import margin_text
from tests.engine.processes import finished
from tests.review.conftest import NAMES, html_of, small_study
from tests.review.dom import parsed, tagged_rows
from tests.review.test_maps import pixels_of

AHEAD = requirements.Requirement(
    "an adult <b>ahead</b>",
    requirements.Zone(x=("front + 3", "front + 6"), y=(-1.0, 1.0), step=0.5),
    (requirements.BODIES["adult"],),
)
BESIDE = requirements.Requirement(
    "the ground beside",
    requirements.Zone(x=(-1.0, 1.0), y=("left + 0.1", "left + 1")),
    (),
    requirements.Criterion(blind_m2=0.0, blind_height=0.5),
)
BEHIND = requirements.Requirement(
    "two kinds behind",
    requirements.Zone(x=("rear + 1", "rear + 2"), y=(-1.0, 1.0), step=0.5),
    (requirements.BODIES["child"],),
    requirements.Criterion(kinds=2),
)


@pytest.fixture(scope="module")
def context():
    """The small study, held to three requirements."""
    study = dataclasses.replace(small_study(), requirements=(AHEAD, BESIDE, BEHIND))
    return ReportContext("held", finished(pt.ScoreJob(study)))


@pytest.fixture(scope="module")
def html(context):
    return html_of(requirement_verdicts, context)


def test_each_requirement_has_its_row_and_plan_with_the_verdict_of_the_engine(context, html):
    verdicts = context.outcome.verdicts
    assert [v.met for v in verdicts] == [True, False, False]
    assert tagged_rows(parsed(html)) == [
        ("an adult <b>ahead</b>", ["tag", "met"]),
        ("the ground beside", ["tag", "not-met"]),
        ("two kinds behind", ["tag", "not-met"]),
    ]
    assert "<b>1 of 3 requirements are met.</b>" in html
    assert html.count('<svg class="drawn"') >= 3
    for verdict in verdicts:
        shown = margin_text(verdict.summary).replace("m2", "m²").split(" blind")[0]
        assert shown.removeprefix("blind ") in html


def test_a_study_without_requirements_has_no_section(scored, page):
    assert html_of(requirement_verdicts, scored) == ""
    assert 'id="requirements"' not in page


@pytest.mark.parametrize("number, color", [(0, MET_RGBA), (2, NOT_MET_RGBA)])
def test_a_plan_is_filled_by_the_verdict_where_the_zone_is(context, number, color):
    """All samples of either zone have one verdict; elsewhere the plan is empty."""
    verdict = context.outcome.verdicts[number]
    pixels = pixels_of(requirement_plan(verdict, context.vehicle, "alt"))
    filled = pixels[..., 3] > 0
    others = {MET_RGBA, NOT_MET_RGBA} - {color}
    assert (pixels == color).all(axis=-1).any()
    assert not any((pixels == other).all(axis=-1).any() for other in others)
    rows, columns = np.nonzero(filled)
    ahead = columns.mean() > pixels.shape[1] / 2
    assert ahead == (number == 0)
    shown = filled.mean() * pixels.shape[0] * pixels.shape[1]
    assert shown == pytest.approx(np.ptp(rows) * np.ptp(columns), rel=0.1), "one rectangle"


def test_blind_ground_is_drawn_where_the_engine_has_it(context):
    verdict = context.outcome.verdicts[1]
    pixels = pixels_of(requirement_plan(verdict, context.vehicle, "alt"))
    assert (pixels == NOT_MET_RGBA).all(axis=-1).any()
    assert verdict.ground.blind.any() and f"{verdict.blind_m2:.2f}" in html_of(
        requirement_verdicts, context
    )


def test_bodies_have_the_points_that_the_engine_counts(context):
    """The body at the worst place, measured by the plain kernels of objects, once more."""
    ahead, behind = worst_bodies(context.outcome.verdicts, context.rig, context.vehicle)
    assert (ahead.number, behind.number) == (1, 3)
    assert ahead.counts[NAMES[1]] > 100.0 and behind.counts[NAMES[1]] == 0.0
