"""A rig with a radar and an ultrasonic sensor goes through the page: pictures and the 3-D view."""

import dataclasses

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_tools import graphics
from pe_tools.page import ReportContext
from pe_tools.page.pictures.sensor_views import field_figure
from pe_tools.page.scene3d import scene_data
from pe_tools.page.sections.visibility import sensor_details
from tests.engine.processes import finished
from tests.review.conftest import html_of, small_study


@pytest.fixture(scope="module")
def parking():
    study = dataclasses.replace(small_study(), samples=1024)
    front = pe.Sensor("front", catalog.load("Continental ARS408-21"), pe.Pose((2.5, 0.0, 0.5)))
    rear = pe.Pose.from_degrees((-2.6, 0.3, 0.5), (0, 0, 180))
    sonar = pe.Sensor("rear", catalog.load("Bosch Ultrasonic 3.1"), rear)
    study = study.with_rig(pe.Rig([*study.rig, front, sonar]))
    return ReportContext("parking", finished(pt.ScoreJob(study)))


def test_a_page_shows_them(parking):
    text = html_of(sensor_details, parking)
    for sensor in list(parking.rig)[-2:]:
        drawing, _ = field_figure(sensor, parking.vehicle)
        assert drawing in text


def test_the_3d_view_has_their_fields_and_the_ground_below(parking):
    for each, kind in zip(
        scene_data(parking)["sensors"][-2:], ("Radar", "Ultrasonic"), strict=True
    ):
        assert each["kind"] == kind and each["drawn_as"] == "view"
        assert each["layers"]["fov"]["lines"]["at"] and each["layers"]["fov"]["faces"]["at"]
        assert each["layers"]["ground"]["lines"]["at"]


def test_occluded_lines_of_a_radar_pass_its_covers(parking):
    """With the whole body a cover nothing occludes a radar; sound still ends on it."""
    radar = pe.Sensor("front", catalog.load("Continental ARS408-21"), pe.Pose((2.0, 0.0, 0.5)))
    sonar = dataclasses.replace(radar, model=catalog.load("Bosch Ultrasonic 3.1"))
    plain = parking.study.vehicle
    covered = dataclasses.replace(plain, covers=dict.fromkeys(plain.part_names, 1.0))
    color = (1.0, 0.5, 0.0, 1.0)
    assert len(graphics.hidden_lines(radar, plain, color).points)
    assert not len(graphics.hidden_lines(radar, covered, color).points)
    assert len(graphics.hidden_lines(sonar, covered, color).points)
