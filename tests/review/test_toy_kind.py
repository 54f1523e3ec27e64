"""The kind of sensor in `tests/engine/toy_kind` goes through the page, without and with a row."""

import dataclasses

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import scene
from pe_core import sensors as kinds
from pe_tools.page import ReportContext, page_bytes
from pe_tools.page.pictures.sensor_views import SENSOR_VIEWS, SensorView
from pe_tools.page.pictures.vehicle_picture import housing_of
from pe_tools.page.scene3d import scene_data
from pe_tools.page.sections.visibility import sensor_details
from tests.engine.processes import finished
from tests.engine.toy_kind import RING, Ring
from tests.review.conftest import html_of, small_study
from tests.review.dom import parsed

HOUSING = scene.Housing("box", (0.02, 0.2, 0.02), (0.0, 0.0, 0.0))


@pytest.fixture(scope="module")
def bumper():
    """A study with a LiDAR, a camera and a toy ring, scored."""
    kinds.register(RING)
    study = dataclasses.replace(small_study(), samples=1024)
    ring = pe.Sensor("bumper", Ring("park pilot", 4.0), pe.Pose((2.3, 0.0, 0.5)))
    study = study.with_rig(pe.Rig([*study.rig, ring]))
    yield ReportContext("parking", finished(pt.ScoreJob(study)))
    kinds.unregister("toyring")


def test_a_page_shows_a_rig_with_the_kind(bumper):
    text = page_bytes([bumper]).decode()
    page = parsed(text)
    assert "Toy Ring" in [cell.text for cell in page.all("th")]
    assert "range           4 m" in [each.text for each in page.all("pre")]
    for sensor, score in bumper.after.per_sensor.items():
        assert score.coverage > 0.0, sensor


def test_the_3d_view_shows_it_as_a_ring_without_image(bumper):
    ring = scene_data(bumper)["sensors"][-1]
    assert (ring["name"], ring["kind"]) == ("bumper", "Toy Ring")
    assert ring["field"] is None and ring["layers"]["fov"]["lines"]["at"]


def test_a_row_gives_the_kind_a_figure_a_housing_and_an_image(bumper, monkeypatch):
    def drawn(sensor, vehicle):
        return [f"{sensor.model.range_m:g} m"], f"around {vehicle is not None}"

    view = SensorView(drawn, HOUSING, lambda model: (120.0, 10.0 * model.range_m))
    monkeypatch.setitem(SENSOR_VIEWS, "toyring", view)
    html = html_of(sensor_details, bumper)
    assert "<pre>4 m</pre><figcaption>around True</figcaption>" in html
    assert housing_of(bumper.rig["bumper"]) is HOUSING
    assert scene_data(bumper)["sensors"][-1]["field"] == [120.0, 40.0]
