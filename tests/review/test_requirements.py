"""Requirements on the page: a row each, a plan with what passes and fails, bodies in pictures."""

import dataclasses
import re

import numpy as np
import pytest

import pe_tools as pt
from pe_core.scoring import requirements
from pe_tools.page import ReportContext
from pe_tools.page.document import STYLES
from pe_tools.page.pictures.reference_figures import worst_bodies
from pe_tools.page.pictures.sight_plans import MET_RGBA, NOT_MET_RGBA, requirement_plan
from pe_tools.page.sections.visibility import requirement_verdicts
from pe_tools.wording import margin_text
from tests.review.conftest import NAMES, html_of, outcome_of, small_study
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
    return ReportContext("held", outcome_of(pt.ScoreJob(study)))


@pytest.fixture(scope="module")
def html(context):
    return html_of(requirement_verdicts, context)


def test_each_requirement_has_its_row_and_plan_with_the_verdict_of_the_engine(context, html):
    verdicts = context.outcome.verdicts
    assert [v.met for v in verdicts] == [True, False, False]
    rows = re.findall(r'<th scope="row">\d ([^<]*)</th><td><span class="tag ([^"]*)"', html)
    assert rows == [
        ("an adult &lt;b&gt;ahead&lt;/b&gt;", "met"),
        ("the ground beside", "not-met"),
        ("two kinds behind", "not-met"),
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


def test_samples_are_not_painted_beyond_an_edge_that_runs_across_them(context):
    """A triangle of 8 m2 at a step of 1 m: the painted pixels are those of the triangle."""
    corners = (("front + 2", -2.0), ("front + 6", 0.0), ("front + 2", 2.0))
    zone = requirements.Zone(polygon=corners, step=1.0)
    held = dataclasses.replace(BEHIND, zone=zone)
    checker = requirements.RequirementChecker([held], context.vehicle)
    (verdict,) = checker.check(context.rig)
    pixels = pixels_of(requirement_plan(verdict, context.vehicle, "alt"))
    rear, front = (corner[0] for corner in context.vehicle.bounds)
    length = front - rear + 6.0 + 2.0
    meters = length / pixels.shape[1]
    assert (pixels[..., 3] > 0).sum() * meters**2 == pytest.approx(8.0, rel=0.03)


def test_a_plan_holds_all_of_its_margin_line(context):
    """The dashed line of a zone that could grow far is inside the frame on all sides."""
    verdict = context.outcome.verdicts[0]
    assert verdict.met and verdict.margin > 1.5
    drawing = str(requirement_plan(verdict, context.vehicle, "alt"))
    (dashed,) = re.findall(r'<path d="([^"]*)"[^>]*stroke-dasharray', drawing)
    points = np.array(re.findall(r"(-?[\d.]+)[ ,](-?[\d.]+)", dashed), float)
    frame = re.search(r'<rect[^>]*class="axis"[^>]*>', drawing)[0]
    x, y, width, height = (
        float(re.search(rf' {key}="([\d.]+)"', frame)[1]) for key in ("x", "y", "width", "height")
    )
    low, high = points.min(axis=0), points.max(axis=0)
    assert (low > [x, y]).all() and (high < [x + width, y + height]).all()
    assert np.allclose(points[0], points[-1], atol=2.0), "one closed line"


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


def test_colours_are_those_of_the_tags():
    css = (STYLES / "parts.css").read_text("utf-8")
    for rgba, name in ((MET_RGBA, "met"), (NOT_MET_RGBA, "not-met")):
        found = re.search(rf"\.tag\.{name} {{ background: (#\w+)", css)
        assert found[1] == "#" + "".join(f"{value:02x}" for value in rgba[:3])
