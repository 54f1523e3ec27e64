"""The 3-D view's data: exact positions, triangles by part, colours, and a limited size."""

import base64
import hashlib
import json

import numpy as np
import pytest

import pe_core as pe
from pe_tools import graphics
from pe_tools.page.scene3d import SCRIPTS, THREE, packed_points, scene_data, scripts, vehicle_data

THREE_SHA256 = "3e322f986588f7ebb331c039f732ec0f5284e86a643f09eade7be1cd4eba5fd8"
"""Of what tools/vendor_three.sh makes of the versions that it names."""


def numbers(text, kind):
    return np.frombuffer(base64.b64decode(text), f"<{kind}")


def points(data):
    """(N, 3) places, as the page's script makes them."""
    return np.array(data["low"]) + numbers(data["at"], "u2").reshape(-1, 3) * data["step"]


@pytest.fixture(scope="module")
def data(scored):
    return scene_data(scored)


def test_places_come_back_within_half_a_step():
    some = np.random.default_rng(1).uniform((-3, 2, 0), (5, 3, 1), (500, 3))
    packed = packed_points(some)
    assert packed["step"] == pytest.approx(np.ptp(some[:, 0]) / 65535)
    np.testing.assert_allclose(points(packed), some, atol=0.51 * packed["step"], rtol=0.0)


def test_the_vehicle_has_all_triangles_by_part(scored):
    vehicle = pe.Vehicle(
        scored.vehicle.triangles,
        np.array([1, 0] * 6),
        ("body", "Windshield", "nothing"),
        glass=("Windshield",),
    )
    found = vehicle_data(vehicle, (vehicle, 0.0))
    drawn = points(found)[numbers(found["triangles"], "u2")].reshape(-1, 3, 3)
    expected = np.concatenate([vehicle.triangles[1::2], vehicle.triangles[::2]])
    np.testing.assert_allclose(drawn, expected, atol=1e-4)
    assert found["parts"] == [
        {"name": "body", "look": "body", "first": 0, "count": 6},
        {"name": "Windshield", "look": "glass", "first": 6, "count": 6},
    ]
    assert len(points(found)) == 8, "corners that meet are one"


def test_sensors_stand_where_they_do_with_their_layers(data, scored):
    for sensor, found in zip(scored.rig, data["sensors"], strict=True):
        assert found["name"] == sensor.name and found["at"] == list(sensor.pose.position)
        np.testing.assert_array_equal(found["axes"], sensor.pose.ground_from_sensor)
    lidar, camera = data["sensors"]
    assert lidar["field"] is None and camera["field"][0] == pytest.approx(60.0)
    assert lidar["drawn_as"] == "beams" and camera["drawn_as"] == "view"
    assert lidar["housing"] is None, "a model that nobody has measured"
    start = points(lidar["layers"]["fov"]["lines"])[::4]
    np.testing.assert_allclose(start, np.tile(lidar["at"], (len(start), 1)), atol=1e-3)
    ground = points(lidar["layers"]["ground"]["lines"])
    np.testing.assert_allclose(ground[:, 2], 0.0, atol=1e-3)


def test_maps_are_those_of_the_engine(data, scored):
    seen = scored.sight.ground(scored.rig, step=1.0)
    for found, name in zip(data["maps"], graphics.QUANTITIES, strict=False):
        sheet = graphics.ground_map(seen, name, 1.0).sheet
        image = numbers(found["colors"], "u1").reshape(sheet.image.shape)
        np.testing.assert_allclose(image / 255.0, sheet.image, atol=0.002)
        assert found["low"] == [-14.0, -12.0] and found["high"] == [14.0, 12.0]


def test_a_camera_s_own_vehicle_is_drawn_where_it_sees_it(scored):
    """From behind the car, looking ahead: all that is stopped ends on its rear face, x = -2.2."""
    behind = pe.Sensor("eye", scored.rig.sensors[1].model, pe.Pose((-6.0, 0.0, 0.9)))
    lines = graphics.hidden_lines(behind, scored.vehicle, graphics.PAPER.occluded)
    ends = lines.points[1::2]
    np.testing.assert_allclose(ends[:, 0], -2.2, atol=1e-5)
    assert np.abs(ends[:, 1]).max() <= 0.9 and len(ends) > 20
    assert not len(graphics.hidden_lines(behind, None, graphics.PAPER.occluded).points)


def test_it_is_small_and_a_whole_program(scored):
    assert len(json.dumps(scene_data(scored))) < 5e5 and sum(map(len, scripts())) < 1e6
    files = {path.stem for path in THREE.parent.parent.glob("*.js")}
    assert files == set(SCRIPTS)


def test_three_js_is_as_it_was_made():
    assert hashlib.sha256(THREE.read_bytes()).hexdigest() == THREE_SHA256
    assert "MIT" in (THREE.parent / "LICENSE").read_text("utf-8")
