"""Dimensions, bill of materials, assumptions, and the plan of blind ground."""

import dataclasses
import xml.etree.ElementTree as ET
from pathlib import Path

import pe_core as pe
import pe_tools as pt
from pe_core.catalog import load
from pe_tools.page import ReportContext, keyed_contexts
from pe_tools.page.pictures.dimension_drawing import side_view, top_view
from pe_tools.page.sections.comparison import bill_of_materials
from pe_tools.page.sections.traceability import (
    CURVE_SOURCES,
    PRIOR_SOURCES,
    VALIDITY,
    VALIDITY_PAGE,
    assumptions,
)
from pe_tools.page.sections.visibility import dimensions
from tests.review.conftest import NAMES, html_of, small_study
from tests.review.test_comparison import beside, cells, rig

ROOT = Path(__file__).resolve().parents[2]
CAR = small_study().vehicle  # 4.4 x 1.8 x 1.5 m, its floor 0.2 m over the ground


def texts(svg):
    return [element.text for element in ET.fromstring(svg).iter("text")]


def test_both_views_have_the_vehicle_s_size_and_the_sensors_in_their_places():
    """By hand: LiDAR at (0, 0, 1.8), camera at (2.3, 0.2, 1.2)."""
    sensors = small_study().rig
    side, top = side_view(sensors, CAR, "side"), top_view(sensors, CAR, "top")
    assert set(texts(side)) == {"4.40 m", "1.50", "1", "2"}
    assert set(texts(top)) == {"4.40 m", "1.80", "1", "2"}
    lidar, camera = (
        [float(e.get(k)) for k in ("cx", "cy")] for e in ET.fromstring(side).iter("circle")
    )
    assert camera[0] > lidar[0] and camera[1] > lidar[1]


def test_the_section_measures_from_ground_front_axle_and_middle():
    axle = pe.Reference(-1.5, 0.35, 2.8)
    (one,) = beside(rig(), reference=axle)
    html = html_of(dimensions, one)
    assert cells(html)[1] == ["2 front &amp; left / 60°", "1.200", "−0.100", "3.800", "0.200 left"]
    assert "0.350 m" in html and "2.800 m" in html
    (bare,) = beside(rig(), vehicle=None)
    assert dimensions(bare) is None


CHOICE = pe.Choice([pe.Option(load("Camera 60 deg"), 1200.0)], sensors=[NAMES[1]])


def test_the_bill_counts_and_says_what_has_no_price():
    priced = pe.Selection([CHOICE], currency="EUR")
    (one,) = beside(rig(), selection=priced)
    html = html_of(bill_of_materials, one)
    assert cells(html) == [
        ["small LiDAR", "LiDAR", "&lt;/script&gt;&lt;b&gt;roof", "1", "no price", "no price"],
        ["Camera 60 deg", "Camera", "front &amp; left / 60°", "1", "1,200 EUR", "1,200 EUR"],
        ["All sensors", "", "", "2", "", "at least 1,200 EUR"],
    ]
    assert bill_of_materials((one,))["no_price"] == ["small LiDAR"]
    each = beside(rig(), rig(without=[NAMES[0]]), selection=priced)
    assert cells(html_of(bill_of_materials, *each)) == [
        ["small LiDAR", "no price", "1", "–"],
        ["Camera 60 deg", "1,200 EUR", "1", "1"],
        ["Count", "", "2", "1"],
        ["Sum", "", "at least 1,200 EUR", "1,200 EUR"],
    ]


def test_the_page_says_what_it_rests_on_and_what_it_does_not_say(scored):
    values = assumptions((scored,))
    assert [row[-1] for row in values["curves"]] == list(CURVE_SOURCES.values())
    assert values["prior_source"] == PRIOR_SOURCES["road"]
    limits = html_of(assumptions, scored).count("<li>")
    own = pe.PerceptionModel(lidar=pe.ApCurve(0.2, 0.5))
    study = dataclasses.replace(small_study(), model=own, vehicle=None)
    score = scored.after
    (other,) = keyed_contexts(
        [ReportContext("own", pt.Outcome("score", study, study, score, score))]
    )
    lidar = assumptions((other,))["curves"][0]
    assert lidar[1:3] == ["0.200", "0.500"] and lidar[-1] not in CURVE_SOURCES.values()
    assert html_of(assumptions, other).count("<li>") == limits + 1, "without a vehicle"


def test_the_verdict_on_validity_is_that_of_its_page():
    text = " ".join((ROOT / VALIDITY_PAGE).read_text("utf-8").split())
    assert VALIDITY in text and "16 placements in two papers" in text
    assert "detectors find more at a better score" in text and "a blind sector" in text  # OWN_STUDY
