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

ROOT = Path(__file__).parents[2]
FEW = 16_384
SIGMAS = 4.0
"""Passes by chance all but once in 16,000 figures."""
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


def test_a_rig_is_stretched_to_another_box_by_hand():
    """From 4.084 x 1.73 x 1.562 m to twice that: inside doubled, what stands out stays out."""
    rig = catalog.known_rig("nuscenes")
    low = (-4.084, -1.73, 0.0)
    high = (4.084, 1.73, 3.124)
    lidar, front = rig.on_vehicle(low, high)[:2]
    assert lidar.pose.position == (-0.8726, 0.0, 3.4022)  # 0.2782 m above a roof of 3.124 m
    assert front.pose.position == pytest.approx((2 * 0.3208, 2 * 0.0159, 2 * 1.511), abs=1e-5)
    assert front.pose.rpy == rig.sensors[1].pose.rpy
    same = rig.on_vehicle((-2.042, -0.865, 0.0), (2.042, 0.865, 1.562))
    assert [s.pose for s in same] == [s.pose for s in rig.sensors]


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
    assert main(["new", "--rig", key, "-o", str(tmp_path / "study.toml")]) == 0
    assert "as published" in capsys.readouterr().err
    study = pe.load_study(tmp_path / "study.toml")
    found = study.rig
    rig = catalog.known_rig(key)
    assert study.samples == FIRST_SAMPLES, "seconds, not 64 million voxels"
    assert [s.name for s in found] == [s.name for s in rig.sensors]
    for ours, theirs in zip(rig.sensors, found, strict=True):
        assert theirs.model is catalog.load(ours.model)
        assert theirs.pose.position == pytest.approx(ours.pose.position, abs=1e-9)
        assert theirs.pose.rotation_deg == pytest.approx(ours.pose.rotation_deg, abs=1e-9)


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
    elevations = np.radians(ELEVATIONS)
    offsets = np.radians(OFFSETS)
    lidar = pe.Lidar(
        "own lidar", elevations, azimuth_count=1800, max_range=200.0, azimuth_offsets=offsets
    )
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
    lidar = again["main_lidar"].model
    own = rig["main_lidar"].model
    assert np.abs(lidar.directions - own.directions).max() < 1e-12
    assert np.degrees(lidar.elevations) == pytest.approx(ELEVATIONS, abs=1e-9)


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
