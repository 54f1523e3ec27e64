"""Calibrations of data sets as studies: PandaSet's form, quaternions, K, D, a table a channel."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.camera import BrownConrady
from pe_tools.exchange import pose_from_quaternion

SIZE = (1920, 1080)
CALIBRATION = {
    "front_camera": {
        "translation": (0.0012, -0.0391, -0.0440),
        "rotation": (0.0162, 0.0031, 0.7115, -0.7025),
        "K": [1970.0, 0.0, 970.0, 0.0, 1970.1, 483.3, 0.0, 0.0, 1.0],
        "D": [-0.5894, 0.66, 0.0011, -0.001, -1.0088],
        "fov_deg": 71.0,
    },
    "back_camera": {
        "translation": (-0.0004, -0.2168, -1.0553),
        "rotation": (0.7138, 0.7004, -0.0016, -0.0005),
        "K": [933.4, 0.0, 896.4, 0.0, 934.6, 507.3, 0.0, 0.0, 1.0],
        "D": [-0.1619, 0.0113, -0.00028, -7.9e-05, 0.0067],
    },
}
"""Of the form of pandaset-devkit's static_extrinsic_calibration.yaml, its names; rotations are
(w, x, y, z) and, with the translations, take the LiDAR's frame to the camera's optical one."""
LIDAR_AT = pe.Pose((-0.1, 0.0, 1.97), (0.0, 0.0, math.pi / 2.0))
"""Its x axis is to the left, its y axis to the rear."""
ELEVATIONS = [round(15.0 - 0.37 * k - 0.01 * (k % 3), 3) for k in range(64)]
OFFSETS = [round(0.5 * ((k * 7) % 5 - 2) - 0.042, 3) for k in range(64)]
"""A table a channel: elevation and azimuth offset [deg], none like another."""


def sensor_of(name, row):
    fx, _, cx, _, fy, cy, *_ = row["K"]
    fov = math.radians(row["fov_deg"]) if "fov_deg" in row else None
    lens = BrownConrady(fx, fy, cx, cy, fov, *row["D"])
    camera = pe.Camera(f"own {name}", *SIZE, lens=lens)
    pose = pose_from_quaternion(
        row["rotation"], row["translation"], optical=True, inverse=True, within=LIDAR_AT
    )
    return pe.Sensor(name, camera, pose)


@pytest.fixture
def rig():
    elevations, offsets = np.radians(ELEVATIONS), np.radians(OFFSETS)
    lidar = pe.Lidar("own lidar", elevations, 1800, 200.0, offsets)
    eyes = [sensor_of(name, row) for name, row in CALIBRATION.items()]
    return pe.Rig([pe.Sensor("main_lidar", lidar, LIDAR_AT), *eyes])


def test_every_figure_is_in_the_study_and_comes_back(rig, tmp_path):
    """To the bit where a file holds them as they are; poses go through degrees."""
    pe.save_study(pe.Study(rig), tmp_path / "study.toml")
    again = pe.load_study(tmp_path / "study.toml").rig
    assert [s.name for s in again] == [s.name for s in rig]
    for ours, theirs in zip(rig, again, strict=True):
        assert theirs.pose.position == pytest.approx(ours.pose.position, abs=1e-12)
        turned = theirs.pose.ground_from_sensor - ours.pose.ground_from_sensor
        assert np.abs(turned).max() < 1e-12
    for name, row in CALIBRATION.items():
        lens = again[name].model.projection
        assert [lens.fx, lens.fy, lens.cx, lens.cy] == [row["K"][k] for k in (0, 4, 2, 5)]
        assert [lens.k1, lens.k2, lens.p1, lens.p2, lens.k3] == row["D"]
        assert lens.fov == (math.radians(row["fov_deg"]) if "fov_deg" in row else None)
        assert (again[name].model.width, again[name].model.height) == SIZE
    lidar, own = again["main_lidar"].model, rig["main_lidar"].model
    assert np.abs(lidar.directions - own.directions).max() < 1e-12
    assert np.degrees(lidar.elevations) == pytest.approx(ELEVATIONS, abs=1e-9)


def test_cameras_look_where_their_names_say(rig):
    ahead = {s.name: s.pose.ground_from_sensor[:, 0] for s in rig}
    assert ahead["front_camera"][0] > 0.99 and ahead["back_camera"][0] < -0.99
    up = [s.pose.ground_from_sensor[2, 2] for s in rig]
    assert min(up) > 0.99, "none stands on its head"
    assert rig["back_camera"].pose.position[0] == pytest.approx(-0.1 - 1.06, abs=0.05)


def test_a_study_of_it_is_read_to_the_same_study(rig, tmp_path):
    pe.save_study(pe.Study(rig), tmp_path / "a.toml")
    pe.save_study(pe.load_study(tmp_path / "a.toml"), tmp_path / "b.toml")
    assert (tmp_path / "a.toml").read_bytes() == (tmp_path / "b.toml").read_bytes()


def test_a_pose_of_a_quaternion_by_hand():
    """A quarter turn to the left; and a camera that looks along the parent's y, 2 m ahead."""
    half = math.sqrt(0.5)
    pose = pose_from_quaternion((half, 0.0, 0.0, half), (1.0, 2.0, 3.0))
    assert pose.position == (1.0, 2.0, 3.0)
    assert pose.rotation_deg == pytest.approx((0.0, 0.0, 90.0))
    # Optical z along the parent's y, optical x along its x: a turn by -90 deg about x.
    seen = pose_from_quaternion((half, -half, 0.0, 0.0), (0.0, 2.0, 0.0), optical=True)
    assert seen.ground_from_sensor[:, 0] == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)
    assert seen.ground_from_sensor[:, 2] == pytest.approx((0.0, 0.0, 1.0), abs=1e-12)
    # The same said the other way round: the parent as the camera has it.
    back = pose_from_quaternion(
        (half, half, 0.0, 0.0), (0.0, 0.0, -2.0), optical=True, inverse=True
    )
    assert back.position == pytest.approx(seen.position, abs=1e-12)
    assert np.abs(back.ground_from_sensor - seen.ground_from_sensor).max() < 1e-12


def test_what_is_no_quaternion_is_refused():
    with pytest.raises(pe.InputError, match="rotation: expected a quaternion of length 1"):
        pose_from_quaternion((0.0, 0.0, 0.0, 0.1), (0.0, 0.0, 0.0))
    with pytest.raises(pe.InputError, match="rotation"):
        pose_from_quaternion((1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
