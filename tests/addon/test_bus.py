"""The example shuttle bus, as it is shipped."""

from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core.geometry.poses import rotation_matrix
from tests.addon import scenes

CORNERS_M = [(x, y) for x in (3.03, -3.03) for y in (1.01, -1.01)]
OUTSIDE_THE_SHELL = ("wheel", "plate", "roof_pod")


@pytest.fixture
def study(addon):
    """The bus with its two LiDARs, evaluated on few voxels."""
    return replace(scenes.shipped_study("bus"), samples=16_384)


def around(count=3600):
    """Level directions all around."""
    azimuth = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    return np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)])


def in_view(camera, yaw_deg, pitch_deg, count=15):
    """Directions through a camera's whole picture."""
    right, down = np.meshgrid(*[np.linspace(-1.0, 1.0, count)] * 2)
    width = np.tan(camera.hfov / 2.0)
    height = width * camera.height / camera.width
    rays = np.stack([np.ones_like(right), -right * width, -down * height], axis=-1).reshape(-1, 3)
    turn = rotation_matrix(0.0, np.radians(pitch_deg), np.radians(yaw_deg))
    return rays @ turn.T / np.linalg.norm(rays, axis=1, keepdims=True)


def test_its_size_and_parts(study):
    low, high = study.vehicle.bounds
    assert low == pytest.approx([-3.03, -1.01, 0.0], abs=1e-3)
    assert high == pytest.approx([3.03, 1.01, 2.60], abs=1e-3)
    assert 5_000 < len(study.vehicle.triangles) < 16_000
    assert {"door_front", "roof", "bumper_rear", "wheel_front_left"} <= set(
        study.vehicle.part_names
    )
    assert {"windshield", "rear_window", "door_windows"} <= set(study.vehicle.glass)


def test_body_glass_and_lamps_are_one_closed_shell(study):
    names = study.vehicle.part_names
    skin = [i for i, name in enumerate(names) if not name.startswith(OUTSIDE_THE_SHELL)]
    triangles = study.vehicle.triangles[np.isin(study.vehicle.parts, skin)]
    assert scenes.open_edges(triangles) == 0
    assert scenes.sharpest_fold(triangles) > -0.8
    assert scenes.volume(triangles) > 20.0


@pytest.mark.parametrize("corner", CORNERS_M)
@pytest.mark.parametrize("height", [0.84, 1.16])
def test_a_lidar_at_each_corner_sees_three_quarters_of_the_way_around(study, corner, height):
    hits = study.vehicle.first_hit((*corner, height), around())
    outwards = around() @ np.array([*np.sign(corner), 0.0]) > 0.0
    assert np.isinf(hits.distance).mean() == pytest.approx(0.75, abs=0.02)
    assert np.isinf(hits.distance[outwards]).all()


@pytest.mark.parametrize(
    ("model", "position", "yaw", "pitch", "pane"),
    [
        ("Camera 30 deg", (2.90, 0.0, 1.66), 0.0, 1.4, "windshield"),
        ("Camera 60 deg", (-2.90, 0.0, 1.52), 180.0, 7.2, "rear_window"),
    ],
)
def test_a_camera_behind_the_glass_sees_out_and_a_lidar_does_not(
    study, model, position, yaw, pitch, pane
):
    rays = in_view(pe.catalog.load(model), yaw, pitch)
    assert np.isinf(study.vehicle.first_hit(position, rays, through_glass=True).distance).all()
    hits = study.vehicle.first_hit(position, rays)
    assert set(study.vehicle.parts[hits.face]) == {study.vehicle.part_names.index(pane)}


def test_it_carries_the_two_lidars_of_the_paper(study):
    poses = {s.name: (s.model.name, s.pose.position, s.pose.rotation_deg) for s in study.rig}
    assert poses == {
        "lidar_front_right": ("Pandar40", (3.03, -1.01, 1.16), (0.0, -0.3, 0.0)),
        "lidar_rear_left": ("Pandar40", (-3.03, 1.01, 0.85), (0.0, 3.2, 0.0)),
    }


def test_two_lidars_on_a_diagonal_score_better_than_one(study):
    evaluator = study.evaluator()
    both = evaluator.entropy(study.rig)
    for sensor in study.rig:
        assert both < evaluator.entropy(pe.Rig([sensor])) - 0.3
