"""The comparison of studies: differing sensors, the better rig, hidden sensors, prices."""

import dataclasses
import re

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.catalog import load
from pe_tools.page import ReportContext, keyed_contexts
from pe_tools.page.markup import escaped, price_text, render
from pe_tools.page.sections.comparison import comparison as comparison_section
from pe_tools.page.sections.comparison import price_of, sensor_differences
from pe_tools.page.sections.score import overview
from tests.review.conftest import NAMES, html_of, outcome_of, small_study

LIDAR, CAMERA = NAMES


def cells(html):
    """The texts of a table's rows."""
    body = html.partition("<tbody>")[2].partition("</tbody>")[0]
    texts = (
        re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.S)
        for row in re.findall(r"<tr>(.*?)</tr>", body, re.S)
    )
    return [[re.sub(r"<[^>]*>", "", text).strip() for text in row] for row in texts]


def differences(contexts):
    """The sensors of all studies, as HTML."""
    return render("sensor_differences.html", contexts=contexts, **sensor_differences(contexts))


def beside(*rigs, **changes):
    """Studies of these rigs as a page has them; none is scored."""
    study = dataclasses.replace(small_study(), **changes)
    each = [pt.Outcome("score", s, s, None, None) for s in map(study.with_rig, rigs)]
    return keyed_contexts(
        [ReportContext(name, one) for name, one in zip("ABCDEF", each, strict=False)]
    )


def rig(*, x=0.0, yaw=170.0, camera="Camera 60 deg", without=()):
    found = small_study(x).rig
    eye = dataclasses.replace(
        found[CAMERA], model=load(camera), pose=pe.Pose.from_degrees((2.3, 0.2, 1.2), (0, 0, yaw))
    )
    return pe.Rig([s for s in (found[LIDAR], eye) if s.name not in without])


def test_a_row_a_sensor_with_what_differs():
    each = beside(rig(), rig(x=-1.5, yaw=-175.0), rig(camera="Camera 120 deg"))
    html = differences(each)
    lidar, moved, eye, turned, other = cells(html)
    assert lidar[1:] == ["A C", "small LiDAR", "0.000", "0.000", "1.800", *["0.00"] * 3]
    assert moved[3] == "−1.500 (−1.500)" and moved[1] == "B"
    assert eye[0] == "front &amp; left / 60°" and eye[-1] == "170.00"
    assert turned[-1] == "−175.00 (+15.00)", "the short way round"
    assert other[1:3] == ["C", "Camera 120 deg"] and "<b>Camera 120 deg</b>" in html
    assert html.count("Price") == 0 and sensor_differences(each)["differing"] == [*NAMES]


def test_prices_are_those_of_the_study_s_choices():
    options = [pe.Option(load(name), price) for name, price in PRICES.items()]
    choice = pe.Choice(options, sensors=[CAMERA])
    each = beside(
        rig(), rig(camera="Camera 120 deg"), selection=pe.Selection([choice], currency="EUR")
    )
    html = differences(each)
    assert [row[3] for row in cells(html)] == ["", "1,200 EUR", "99.50 EUR"]
    values = sensor_differences(each)
    assert values["has_prices"] and values["lacks_prices"]
    assert price_of(each[0].study, each[0].rig[LIDAR]) is None and price_text(5.0, "") == "5"


PRICES = {"Camera 60 deg": 1200.0, "Camera 120 deg": 99.5}


@pytest.fixture(scope="module")
def comparison(scored, other):
    """The comparison of two studies, as HTML."""
    return html_of(comparison_section, *keyed_contexts([scored, other]))


def test_the_comparison_marks_the_engine_s_winner(scored, other, comparison):
    rows = pt.advice.compare({"a": scored.after, "b": other.after})
    better = min((scored, other), key=lambda one: one.after.entropy)
    winner = (scored, other).index(better)
    assert rows[0].best.index(True) == winner
    first = re.search(r'class="wins whose-(\w)-ink">([^<]*)<', comparison)
    assert first.groups() == ("ab"[winner], f"{better.after.entropy:.2f}")
    assert comparison_section(keyed_contexts([scored, other]))["overall"] == rows[0]


def test_a_camera_in_the_body_is_named_in_the_summary(scored):
    inside = dataclasses.replace(small_study().rig[CAMERA], pose=pe.Pose((0.0, 0.0, 0.9)))
    study = small_study().with_rig(pe.Rig([small_study().rig[LIDAR], inside]))
    one = ReportContext("inside", outcome_of(pt.ScoreJob(study)))
    (line,) = overview((one,))["hidden"]
    assert line.startswith(f"<b>{escaped(CAMERA)}</b>") and line in html_of(overview, one)
    assert not overview((scored,))["hidden"]
    lines = comparison_section(keyed_contexts([scored, one]))["lines"]
    assert sum(f"{line}." in each for each in lines) == 1
