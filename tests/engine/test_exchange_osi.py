"""OSI: protobuf's own parser, told to take nothing that the schema has not, reads what is written;
and what its printer writes is read."""

import json
import math

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.exchange import rig_files
from tests.engine.refusals import wrongly_refused

AXLE = pe.Reference(-1.31, 0.33)
BEAMS = pe.Lidar(
    "few beams",
    np.radians([-20, -7, 3]),
    azimuth_count=36,
    max_range=80.0,
    azimuth_offsets=np.radians([0, 2, 0]),
)
NEAR = pe.Lidar("near", np.radians([-10.0]), 8, 30.0)
RIG = pe.Rig(
    [
        pe.Sensor("roof", BEAMS, pe.Pose.from_degrees((-0.43, 0, 1.8), (0.5, -1.25, 12))),
        pe.Sensor("nose", NEAR, pe.Pose.from_degrees((2, 0, 0.5))),
        pe.Sensor("eye", pe.Camera("own", 1920, 1080, math.radians(70.0)), pe.Pose((1, 0, 1))),
    ]
)
WRONG = [
    ("num_of_pixels", {"num_of_pixels": 7}),
    ("sensor_id", {"sensorId": {"value": "x"}}),
    ("sensor_id.value", {"sensor_id": {"value": "x"}}),
    ("sensor_id", {"sensor_id": {"value": 0}}),
    ("directions", {"directions": [{"x": 1e308}], "num_of_pixels": 1}),
    ("directions", {"directions": [{"x": 0.0}], "num_of_pixels": 1}),
    ("field_of_view_vertical", {"field_of_view_vertical": 1e308}),
    ("number_of_rays_horizontal", {"number_of_rays_horizontal": 1e308}),
    ("range", {"range": 1e308}),
    ("directions", {"directions": [{"x": "east"}]}),
    ("mounting_position.position.x", {"mounting_position": {"position": {"x": "far"}}}),
]


@pytest.fixture(scope="module")
def parsed():
    """What protobuf's parser takes a written rig for."""
    json_format = pytest.importorskip("google.protobuf.json_format", reason="of the extra test")
    from tests.engine.osi_schema import configuration

    files, _ = rig_files(RIG, "osi", AXLE)
    text = files["sensor_view_configuration.json"].decode()
    return json_format.Parse(text, configuration()())


def test_protobuf_s_parser_takes_what_is_written(parsed):
    roof, nose = parsed.lidar_sensor_view_configuration
    assert [len(roof.directions), roof.num_of_pixels, nose.num_of_pixels] == [108, 108, 8]
    assert roof.number_of_rays_horizontal * roof.number_of_rays_vertical == roof.num_of_pixels
    beam = roof.directions[7]
    assert np.allclose([beam.x, beam.y, beam.z], BEAMS.directions[7], atol=1e-9)
    assert roof.mounting_position.position.x == pytest.approx(-0.43 + 1.31)
    assert roof.field_of_view_vertical == pytest.approx(math.radians(40.0))
    (eye,) = parsed.camera_sensor_view_configuration
    assert (eye.sensor_id.value, eye.number_of_pixels_horizontal) == (2, 1920)
    assert eye.field_of_view_horizontal == pytest.approx(math.radians(70.0))
    assert parsed.range == 80.0


@pytest.mark.parametrize("schema_names", [False, True], ids=["camelCase", "snake_case"])
def test_what_protobuf_s_printer_writes_is_read(parsed, schema_names, tmp_path):
    """Ids come as text there, and numbers that are 0 may."""
    from google.protobuf import json_format

    text = json_format.MessageToJson(parsed, preserving_proto_field_name=schema_names)
    assert ("sensorId" in text) != schema_names and '"value": "2"' in text
    path = tmp_path / "sensor_view_configuration.json"
    path.write_text(text)
    found = pt.import_rig(path, reference=AXLE)
    assert [s.name for s in found.rig] == ["lidar_0", "lidar_1", "camera_2"]
    assert found.lines == ()
    for ours, theirs in zip(RIG, found.rig, strict=True):
        assert theirs.pose.position == pytest.approx(ours.pose.position, abs=1e-9)
        assert theirs.pose.rpy == pytest.approx(ours.pose.rpy, abs=1e-9)
    assert np.allclose(found.rig["lidar_0"].model.directions, BEAMS.directions, atol=1e-8)
    assert found.rig["camera_2"].model.hfov == pytest.approx(math.radians(70.0))


def test_one_range_is_there_for_all_lidars_and_others_are_reported(tmp_path):
    (path,), lines = pt.export_rig(RIG, "osi", tmp_path / "osi.json", AXLE)
    assert "OSI has one range for all sensors, 80 m; left out: nose 30 m" in lines
    found = pt.import_rig(path, "osi", AXLE)
    assert [s.model.max_range for s in found.rig][:2] == [80.0, 80.0]
    data = json.loads(path.read_text())
    assert all("range" not in row for row in data["lidar_sensor_view_configuration"])
    del data["range"]
    path.write_text(json.dumps(data))
    found = pt.import_rig(path, "osi", AXLE)
    assert "lidar_0, lidar_1: no range in the file; 100 m stands in" in found.lines
    assert found.rig["lidar_0"].model.beam_count == 108, "its beams stay"


def test_what_is_none_of_osi_s_is_refused(tmp_path):
    (path,), _ = pt.export_rig(RIG, "osi", tmp_path / "osi.json", AXLE)
    whole = path.read_text()

    def imported(change):
        data = json.loads(whole)
        data["lidar_sensor_view_configuration"][1].update(change)
        path.write_text(json.dumps(data))
        pt.import_rig(path, "osi", AXLE)

    rows = [(f"lidar_sensor_view_configuration[1].{field}", given) for field, given in WRONG]
    assert wrongly_refused(imported, rows, path) == []
