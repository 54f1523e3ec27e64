"""Known and published rigs: their places, their figures, their page, other vehicles."""

import math
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_core.sensors.camera import BrownConrady
from pe_tools.cli.verbs import main
from pe_tools.exchange import pose_from_quaternion


@pytest.mark.parametrize("rig", catalog.known_rigs().values(), ids=lambda rig: rig.key)
def test_each_has_models_of_the_catalogue_names_of_its_own_and_a_source(rig):
    assert rig.sensors and rig.source and rig.note and rig.origin
    assert len({sensor.name for sensor in rig.sensors}) == len(rig.sensors)
    for sensor in rig.sensors:
        assert catalog.load(sensor.model)
    if rig.size is not None:
        length, width, _ = rig.size
        for sensor in rig.sensors:
            x, y, z = sensor.pose.position
            assert abs(x) < length / 2 + 0.3 and abs(y) < width / 2 + 0.3 and 0.0 < z < 3.0


def test_the_origin_moves_from_the_rear_axle_under_the_centre():
    """nuScenes' LiDAR is 0.9437 m ahead of the rear axle, the Zoe's centre 1.38 m."""
    lidar = catalog.known_rig("nuscenes").sensors[0]
    assert (lidar.name, lidar.model) == ("LIDAR_TOP", "Velodyne HDL-32E")
    assert lidar.pose.position == (-0.4363, 0.0, 1.8402)


def test_angles_are_roll_pitch_yaw_as_here():
    cameras = {each.name: each.pose for each in catalog.known_rig("nuscenes").sensors}
    ahead = cameras["CAM_FRONT_RIGHT"].ground_from_sensor[:, 0]
    assert ahead[0] > 0.5 and ahead[1] < -0.8, "it looks to the front right"
    assert cameras["CAM_FRONT_RIGHT"].rotation_deg == (0.519, 0.782, -56.397)
    assert cameras["CAM_FRONT"].ground_from_sensor[2, 0] < 0.0, "positive pitch is nose down"


def test_a_rig_is_stretched_to_another_box_by_hand():
    """From 4.084 x 1.73 x 1.562 m to twice that: inside doubled, what stands out stays out."""
    rig = catalog.known_rig("nuscenes")
    low, high = (-4.084, -1.73, 0.0), (4.084, 1.73, 3.124)
    lidar, front = rig.on_vehicle(low, high)[:2]
    assert lidar.pose.position == (-0.8726, 0.0, 3.4022)  # 0.2782 m above a roof of 3.124 m
    assert front.pose.position == pytest.approx((2 * 0.3208, 2 * 0.0159, 2 * 1.511), abs=1e-5)
    assert front.pose.rpy == rig.sensors[1].pose.rpy
    same = rig.on_vehicle((-2.042, -0.865, 0.0), (2.042, 0.865, 1.562))
    assert [s.pose for s in same] == [s.pose for s in rig.sensors]


def test_a_published_base_is_lifted_to_the_centre_of_the_scan():
    """By hand: along the housing, which a roll of 50 degrees leans to the right once turned."""
    rig = {each.name: each for each in catalog.known_rig("tier4_xx1").sensors}
    models = [each.model for each in rig.values()]
    assert models.count("Hesai PandarXT-32 / XT32") == 4 and len(models) == 5
    assert rig["hesai_top"].pose.position == (-0.45, 0.0, 2.09)
    roll = math.radians(50.0)
    leaning = (-0.45, 0.564 + 0.0464 * math.sin(roll), 1.7 + 0.0464 * math.cos(roll))
    assert rig["hesai_left"].pose.position == pytest.approx(leaning, abs=1e-5)
    top = {each.name: each for each in catalog.known_rig("autoware").sensors}["velodyne_top"]
    assert top.pose.position[2] == pytest.approx(2.0 + 0.06611, abs=1e-4)


@pytest.mark.parametrize(
    ("model", "above_mm"),
    [
        ("Velodyne VLS-128 Alpha Prime", 66.1),
        ("Hesai OT128 (Pandar128E4X)", 90.0),
        ("Hesai PandarXT-32 / XT32", 46.4),
        ("Hesai QT128C2X", 58.2),
        ("Hesai PandarQT (QT64)", 50.4),
        ("Velodyne HDL-32E", 90.8),
        ("Velodyne VLP-16 Puck", 37.7),
        ("Hesai Pandar40P", 47.0),
        ("Pandar64", 0.0),
        ("Hesai XT32M2X", 0.0),
    ],
)
def test_how_far_a_lidar_scans_above_its_base(model, above_mm):
    """Millimetres of tier4's descriptions, by the catalogue's names; 0 where none says."""
    assert catalog.load(model).kind == "lidar"
    assert round(1000.0 * catalog.scan_above_base(model), 1) == above_mm


ROOT = Path(__file__).parents[2]
FEW = 16_384
SIGMAS = 4.0
"""Passes by chance all but once in 16,000 figures."""


@pytest.fixture(scope="module")
def page():
    """The page's rows by the rigs' keys: (entropy, stderr, coverage) in the open and on it."""
    rows = {}
    for line in (ROOT / "docs" / "known_rigs.md").read_text("utf-8").splitlines():
        found = re.match(r"\| .*\(`(\w+)`\) \|", line)
        if found:
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            figures = [cells[4], cells[5], cells[7], cells[8]]
            rows[found[1]] = [float(w) for cell in figures for w in cell.split(" ± ")]
    return rows


@pytest.fixture(scope="module")
def tool():
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        import known_rigs
    finally:
        sys.path.remove(str(ROOT / "tools"))
    return known_rigs


def test_the_page_has_every_rig(page):
    assert set(page) == set(catalog.known_rigs())


@pytest.mark.parametrize("key", ["kitti", "paper_bus_front"])
def test_its_figures_are_those_of_a_fresh_score(page, tool, key):
    """Other voxels of another number: apart by no more than both standard errors allow."""
    fresh = tool.scored(key, FEW)
    for score, told in ((fresh.open, page[key][:3]), (fresh.on_vehicle, page[key][3:])):
        entropy, stderr, coverage = told
        apart = SIGMAS * (score.stderr**2 + stderr**2) ** 0.5
        assert score.entropy == pytest.approx(entropy, abs=apart)
        assert 100.0 * score.coverage == pytest.approx(coverage, abs=5.0)
        assert apart < 0.1 * entropy, "a band that would tell another rig's figure apart"


@pytest.mark.parametrize("key", catalog.known_rigs())
def test_each_is_a_study_that_reads_back(key, tmp_path, capsys):
    assert main(["rigs", key, "-o", str(tmp_path / "study.toml")]) == 0
    assert "as published" in capsys.readouterr().err
    study = pe.load_study(tmp_path / "study.toml")
    found, rig = study.rig, catalog.known_rig(key)
    assert study.samples == FIRST_SAMPLES, "seconds, not 64 million voxels"
    assert [s.name for s in found] == [s.name for s in rig.sensors]
    for ours, theirs in zip(rig.sensors, found, strict=True):
        assert theirs.model is catalog.load(ours.model)
        assert theirs.pose.position == pytest.approx(ours.pose.position, abs=1e-9)
        assert theirs.pose.rotation_deg == pytest.approx(ours.pose.rotation_deg, abs=1e-9)


def test_the_command_lists_tells_and_stretches(tmp_path, capsys):
    assert main(["rigs"]) == 0
    listed = capsys.readouterr().out
    assert all(key in listed for key in catalog.known_rigs())
    assert main(["rigs", "nuscenes"]) == 0
    assert "Source" not in (said := capsys.readouterr().out) and "source   nuScenes" in said
    mesh = ROOT / "blend_assets" / "bus.npz"
    command = ["rigs", "nuscenes", "-o", str(tmp_path / "study.toml"), "--mesh", str(mesh)]
    assert main(command) == 0
    assert "stretched onto this vehicle's box" in capsys.readouterr().err
    study = pe.load_study(tmp_path / "study.toml")
    top = study.vehicle.bounds[1][2]
    assert study.rig["LIDAR_TOP"].pose.position[2] == pytest.approx(top + 1.8402 - 1.562, abs=1e-4)
    assert main(command) == 1 and "an existing file" in capsys.readouterr().err
    assert main([*command, "--replace", "--as-published"]) == 0
    rig = pe.load_study(tmp_path / "study.toml").rig
    assert rig["LIDAR_TOP"].pose.position == (-0.4363, 0.0, 1.8402)
    assert main(["rigs", "zoe"]) == 1
    assert "rig: expected one of" in capsys.readouterr().err


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
