"""Known rigs: published places in the ground frame, and carried onto another vehicle."""

import math

import pytest

from pe_core import InputError, catalog
from pe_core.scene import Pose


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


def test_without_a_size_nothing_is_stretched():
    rig = catalog.known_rig("tier4_xx1")
    assert rig.size is None
    assert rig.on_vehicle((-9.0, -9.0, 0.0), (9.0, 9.0, 9.0)) == rig.sensors


def test_an_unknown_one_is_reported():
    with pytest.raises(InputError, match=r"rig: expected one of .*nuscenes.*, found 'zoe'"):
        catalog.known_rig("zoe")


def test_poses_are_poses():
    assert all(isinstance(s.pose, Pose) for s in catalog.known_rig("kitti").sensors)
