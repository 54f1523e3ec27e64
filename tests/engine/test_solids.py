"""Fields of view as solids: closed, as large as a formula says, and where the body leaves them."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.base.errors import InputError
from pe_core.sensors.lidar.field_of_view import beam_patch
from pe_tools.outputs import scene_files, solids
from pe_tools.outputs.solid import free_solid, mounted_view

from .shapes import box, box_car, camera, small_lidar
from .surfaces import is_watertight

RANGE = 20.0
STEP = math.radians(2.0)
POSE = pe.Pose.from_degrees((0.3, -0.2, 1.9), (3.0, 10.0, 50.0))
FISHEYE = pe.Camera("fisheye", 1280, 960, lens=pe.KannalaBrandt(320, 320, 640, 480, fov=3.4))
DOME = pe.Lidar("dome", np.radians(np.linspace(0, 90, 16)), 180, 30.0)
SECTOR = small_lidar(horizontal_fov=(-1.0, 1.0))
ROSETTE = pe.Lidar.from_directions(
    "rosette", [(1, 0.3 * math.cos(a), 0.3 * math.sin(a)) for a in np.linspace(0, 6.28, 400)], 90
)
LINE = pe.Lidar("line", [0.0], 360, 30.0)
MODELS = {"fisheye": FISHEYE, "dome": DOME, "sector": SECTOR, "rosette": ROSETTE, "line": LINE}
MODELS |= {"ring": small_lidar(), "pinhole": camera(90.0).model}
MODELS |= {
    name: pe.catalog.load(name) for name in ("Continental ARS408-21", "Parking module 2.5 m")
}


def view_of(name, vehicle=None, step=STEP):
    sensor = pe.Sensor(name, MODELS[name], POSE)
    return mounted_view(sensor, vehicle, RANGE, step)


def corners(solid):
    """(F, 3, 3), in the single precision that files have."""
    return solid.points.astype(np.float32)[solid.faces]


@pytest.mark.parametrize("name", MODELS)
def test_solids_of_every_kind_of_view_are_closed_and_outwards(name):
    view = view_of(name, box_car())
    whole = solids.whole_solid("whole", view)
    free = free_solid("free", view)
    hidden = solids.hidden_solid("hidden", view)
    found = [whole, free] + ([hidden] if hidden else [])
    assert all(is_watertight(corners(solid)) for solid in found)
    assert all(solids.volume(solid) > 0.0 for solid in found)
    parts = solids.volume(free) + (solids.volume(hidden) if hidden else 0.0)
    assert parts == pytest.approx(
        solids.volume(whole), rel=1e-3
    )  # the hidden one is 1 mm thick at least


def test_a_pole_is_one_point_of_a_field_that_reaches_it():
    """The dome's upper one, and both of a LiDAR that sees all round in each direction."""
    ball = pe.Lidar("ball", np.radians(np.linspace(-90, 90, 7)), 180, 30.0)
    for model, poles in ((DOME, {1.0}), (ball, {-1.0, 1.0})):
        patch = beam_patch(model, math.radians(10.0))
        ends = patch.directions[np.unique(patch.faces)]
        ends = ends[np.abs(ends[:, 2]) > 0.9999]
        assert set(ends[:, 2]) == poles and len(ends) == len(poles)


def test_a_wall_takes_what_lies_behind_it():
    """A wall 5 m ahead, wider than the picture: what is free is a pyramid of that height."""
    wall = pe.Vehicle(box((5.0, -30.0, -30.0), (5.1, 30.0, 30.0)))
    eye = camera(90.0, position=(0, 0, 0))
    view = mounted_view(eye, wall, RANGE, math.radians(1.0))
    free = free_solid("free", view)
    assert solids.volume(free) == pytest.approx(10.0 * 10.0 * 1080 / 1920 * 5.0 / 3.0, rel=1e-3)
    assert solids.hidden_solid("hidden", view).points[:, 0].min() == pytest.approx(5.0, abs=1e-6)


def test_osi_has_the_nominal_field_of_view_in_the_sensors_frame():
    """A pinhole's pyramid on a car whose body does not matter: its corners at the range."""
    json_format = pytest.importorskip("google.protobuf.json_format", reason="of the extra test")
    from tests.engine.osi_schema import configuration

    axle = pe.Reference(-1.3, 0.32)
    eye = camera(90.0, (1.0, 0.5, 1.2), (5.0, 20.0, -130.0), name="eye")
    study = pe.Study(pe.Rig([eye]), box_car(), reference=axle)
    files, lines = scene_files(study, "detection-area", RANGE)
    assert lines == []
    message = configuration("SensorData")()
    json_format.Parse(files["eye_sensor_data.json"], message)
    place = message.mounting_position
    assert (place.position.x, place.position.y, place.position.z) == pytest.approx((2.3, 0.5, 0.88))
    assert place.orientation.pitch == pytest.approx(math.radians(20.0))
    corners = np.array(
        [[(v.x, v.y, v.z) for v in each.vertex] for each in message.virtual_detection_area.polygon]
    )
    far = corners.reshape(-1, 3)
    assert np.linalg.norm(far, axis=1).max() == pytest.approx(RANGE, abs=1e-3)
    assert far[:, 1].max() / far[np.argmax(far[:, 1]), 0] == pytest.approx(1.0, abs=1e-3)
    assert (far[:, 0] >= 0.0).all() and far.shape[1] == 3
    with pytest.raises(InputError, match="rear axle"):
        scene_files(pe.Study(pe.Rig([eye])), "detection-area", RANGE)
