"""The picture of a LiDAR's ranges, held to first hits beam by beam and to a scene by hand."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.sensors import range_picture
from pe_tools.graphics import range_colors

WALL = pe.Vehicle(
    np.array(
        [  # a wall across, 2 m ahead, 4 m wide, from the ground up to 3 m
            [[2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 2.0, 3.0]],
            [[2.0, -2.0, 0.0], [2.0, 2.0, 3.0], [2.0, -2.0, 3.0]],
        ]
    )
)


def lidar(elevations_deg, azimuths=4, max_range=50.0, fov=(-180, 180)):
    table = {"kind": "lidar", "elevations_deg": elevations_deg, "azimuth_count": azimuths}
    return catalog.from_table(
        "toy", table | {"max_range_m": max_range, "horizontal_fov_deg": list(fov)}
    )


def test_by_hand():
    """1 m above the ground: down 45 degrees it is sqrt 2 away, or 2 sqrt 2 to a wall 2 m ahead."""
    sensor = pe.Sensor("toy", lidar([-45, 0]), pe.Pose((0.0, 0.0, 1.0)))
    picture = range_picture(sensor, WALL)
    assert np.degrees(picture.elevations) == pytest.approx([0, -45])
    assert np.degrees(picture.azimuths) == pytest.approx([180, 90, 0, -90])
    level, down = picture.distance
    assert level == pytest.approx([math.inf, math.inf, 2.0, math.inf])
    assert down == pytest.approx([math.sqrt(2)] * 4)  # the ground comes before the wall
    assert picture.occluded.tolist() == [[False, False, True, False], [False] * 4]


def test_beyond_its_range_is_nothing():
    sensor = pe.Sensor("toy", lidar([-45, 0], max_range=1.4), pe.Pose((0.0, 0.0, 1.0)))
    picture = range_picture(sensor, WALL)
    assert np.isinf(picture.distance).all() and not picture.occluded.any()


def test_below_the_ground_there_is_no_ground():
    sensor = pe.Sensor("toy", lidar([-45, 0]), pe.Pose((0.0, 0.0, -1.0)))
    assert np.isinf(range_picture(sensor, None).distance).all()


@pytest.mark.parametrize("model", ["Hesai AT128E2X", "Velodyne VLP-16 Puck", "RoboSense RS-Bpearl"])
def test_each_pixel_is_its_beam_s_first_hit(model):
    """Beam by beam, from directions worked out anew, turned and tilted."""
    sensor = pe.Sensor("it", catalog.load(model), pe.Pose((0.3, 0.2, 1.1), (0.1, 0.2, 0.4)))
    picture, rng = range_picture(sensor, WALL), np.random.default_rng(0)
    offsets = dict(zip(sensor.model.elevations, sensor.model.azimuth_offsets, strict=True))
    turned = sensor.pose.ground_from_sensor
    seen = set()
    for row, column in rng.integers(0, picture.distance.shape, (300, 2)).tolist():
        e = picture.elevations[row]
        a = picture.azimuths[column] + offsets[e]
        beam = turned @ [math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)]
        body = WALL.first_hit(sensor.pose.position, beam[None]).distance[0]
        ground = 1.1 / -beam[2] if beam[2] < 0 else math.inf
        nearest = min(body, ground)
        expected = nearest if nearest <= sensor.model.max_range else math.inf
        assert picture.distance[row, column] == pytest.approx(expected, rel=1e-9)
        assert picture.occluded[row, column] == (body <= ground and expected < math.inf)
        seen.add((bool(picture.occluded[row, column]), expected < math.inf))
    assert (True, True) in seen  # some met the wall


def test_nearer_than_its_least_range_nothing_comes_back():
    """The wall 2 m ahead stops the beam all the same; the ground sqrt 2 away is not seen."""
    table = {"kind": "lidar", "elevations_deg": [0, -45], "azimuth_count": 4, "max_range_m": 50.0}
    near = catalog.from_table("toy", table | {"min_range_m": 2.5})
    picture = range_picture(pe.Sensor("toy", near, pe.Pose((0.0, 0.0, 1.0))), WALL)
    assert np.isinf(picture.distance).all()
    assert picture.occluded.tolist() == [[False, False, True, False], [False] * 4]
    colors = range_colors(picture, 50.0)
    silent, nothing = colors[0, 2], colors[0, 0]
    assert silent[0] > silent[2] + 0.3 and np.ptp(nothing) < 0.02  # brown, and grey


def test_things_end_beams_unless_something_is_before_them():
    """A box ahead of the wall, one behind it, and one on the left, 5 m away."""
    boxes = [WALL.triangles + np.array([dx, 0.0, 0.0]) for dx in (-1.0, 1.0)]
    left = WALL.triangles[..., [1, 0, 2]] + np.array([0.0, 3.0, 0.0])
    parts = np.repeat([0, 1, 2], 2)
    things = pe.Vehicle(np.concatenate([*boxes, left]), parts, ["before", "behind", "left"])
    sensor = pe.Sensor("toy", lidar([0, -45]), pe.Pose((0.0, 0.0, 1.0)))
    picture = range_picture(sensor, WALL, things)
    assert picture.things[0].tolist() == [-1, 2, 0, -1]  # behind, left, ahead, right
    assert picture.distance[0] == pytest.approx([math.inf, 5.0, 1.0, math.inf])
    assert not picture.occluded.any()
    assert range_picture(sensor, WALL, pe.Vehicle(boxes[1])).occluded[0].tolist()[2]


def test_colours_run_from_bright_to_dark_and_are_the_body_s_own_hue():
    sensor = pe.Sensor("toy", lidar([-2, -10, -45]), pe.Pose((0.0, 0.0, 1.0)))
    colors = range_colors(range_picture(sensor, WALL), 50.0)
    lightness = colors[1:, 0] @ [0.2126, 0.7152, 0.0722]  # behind: the ground, 6 and 1.4 m away
    assert lightness[1] > lightness[0] + 0.1
    red, green, blue = colors[0, 2]  # ahead: the wall
    assert red > green > blue
