"""The comparison of studies: differing sensors, the better rig, hidden sensors, prices."""

import dataclasses

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.catalog import load
from pe_core.search import FIGURES
from pe_tools.page import ReportContext, keyed_contexts
from pe_tools.page.markup import render
from pe_tools.page.sections.comparison import comparison as comparison_section
from pe_tools.page.sections.comparison import sensor_differences
from tests.review.conftest import NAMES, html_of, small_study
from tests.review.dom import parsed

LIDAR, CAMERA = NAMES


def cells(html, caption=""):
    """The texts of the rows of the first table that has this in its caption."""
    table = next(each for each in parsed(html).all("table") if caption in each.text)
    rows = table.one("tbody").all("tr")
    return [[cell.text.strip() for cell in row if cell.tag in ("th", "td")] for row in rows]


def differences(contexts):
    """The sensors of all studies, as HTML."""
    return render("sensor_differences.html", contexts=contexts, **sensor_differences(contexts))


def beside(*rigs, **changes):
    """Studies of these rigs as a page has them; none is scored."""
    study = dataclasses.replace(small_study(), **changes)
    each = [pt.Outcome("score", s, s, before=None, after=None) for s in map(study.with_rig, rigs)]
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
    assert eye[0] == "front & left / 60°" and eye[-1] == "170.00"
    assert turned[-1] == "−175.00 (+15.00)", "the short way round"
    assert other[1:3] == ["C", "Camera 120 deg"] and "<b>Camera 120 deg</b>" in html
    assert html.count("Price") == 0 and sensor_differences(each)["differing"] == [*NAMES]


@pytest.fixture(scope="module")
def comparison(scored, other):
    """The comparison of two studies, as HTML."""
    return html_of(comparison_section, *keyed_contexts([scored, other]))


def test_the_comparison_marks_the_engine_s_winner(scored, other, comparison):
    rows = pt.advice.compare({"a": scored.after, "b": other.after})
    better = min((scored, other), key=lambda one: one.after.entropy)
    winner = (scored, other).index(better)
    assert rows[0].best.index(True) == winner
    elements = list(parsed(comparison))
    heading = FIGURES["entropy"].heading
    begin = next(k for k, each in enumerate(elements) if each.parts[:1] == [heading])
    first = next(each for each in elements[begin:] if "wins" in each.classes)
    assert first.classes == ["wins", f"whose-{'ab'[winner]}-ink"]
    assert first.text.startswith(f"{better.after.entropy:.3f}")
    assert comparison_section(keyed_contexts([scored, other]))["overall"] == rows[0]
