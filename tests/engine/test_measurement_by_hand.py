"""Measurements of single voxels and beams worked by hand, and what sensors take and refuse."""

import math
from itertools import starmap

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.camera.definition import frustum_distance
from pe_core.sensors.camera.sample_areas import pixel_areas
from tests.engine import shapes
from tests.engine.refusals import wrongly_refused

ROOT3 = math.sqrt(3.0) / 2.0
NOWHERE = [
    ("directions", []),
    ("directions", [1.0, 2.0, 3.0]),
    ("directions", [[1.0, 2.0]]),
    ("directions", [[1, 0, 0], [0, 0, 0]]),
    ("directions", [[math.inf, 0, 0], [0, 0, 0]]),
    ("directions", [[1, 0, 0], [0, math.nan, 1]]),
]
LIDAR = {"kind": "lidar", "elevations_deg": [-10, 0.5], "azimuth_step_deg": 0.7, "max_range_m": 80}
CAMERA = {"kind": "camera", "width": 200, "height": 100, "hfov_deg": 90}
WRONG_TABLES = [
    ("horizontal_fov_deg", LIDAR | {"horizontal_fov_deg": [1, 2, 3]}),
    ("horizontal_fov_deg", LIDAR | {"horizontal_fov_deg": 90}),
    ("horizontal_fov_deg", LIDAR | {"horizontal_fov_deg": [0, "x"]}),
    ("azimuth_step_deg", LIDAR | {"azimuth_step_deg": 0}),
    ("azimuth_step_deg", LIDAR | {"azimuth_step_deg": 361}),
    ("azimuth_step_deg", LIDAR | {"azimuth_step_deg": True}),
    ("elevations_deg", LIDAR | {"elevations_deg": []}),
    ("elevations_deg", LIDAR | {"elevations_deg": 3}),
    ("elevations_deg", LIDAR | {"elevations_deg": [1, None]}),
    ("angles", LIDAR | {"angles": ""}),
    ("angles", LIDAR | {"angles": "x.csv"}),
    ("max_range_m", LIDAR | {"max_range_m": None}),
    ("width", CAMERA | {"width": "wide"}),
    ("hfov_deg", CAMERA | {"hfov_deg": None}),
]


def lidar(elevations_deg=(0.0,), azimuths=4, max_range=50.0, **options):
    return pe.Lidar("mine", np.radians(elevations_deg), azimuths, max_range, **options)


def at(model, position=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0)):
    return pe.Sensor("s", model, pe.Pose.from_degrees(position, rotation))


def test_beams_of_a_lidar_channel_by_channel():
    """Four azimuths, 90 degrees apart and counter-clockwise, at 0 and at 30 degrees up."""
    model = lidar((0.0, 30.0))
    level = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]
    up = [[ROOT3, 0, 0.5], [0, ROOT3, 0.5], [-ROOT3, 0, 0.5], [0, -ROOT3, 0.5]]
    np.testing.assert_allclose(model.directions, level + up, atol=1e-15)
    assert model.beam_count == 8 and model.azimuth_steps.tolist() == [0, 1, 2, 3]
    assert model.azimuth_step == pytest.approx(math.pi / 2)


def test_offsets_turn_a_channel_to_the_left():
    model = lidar((0.0, 0.0), 1, azimuth_offsets=np.radians([0.0, 30.0]))
    np.testing.assert_allclose(model.directions, [[1, 0, 0], [ROOT3, 0.5, 0]], atol=1e-15)


@pytest.mark.parametrize(
    ("low", "high", "steps"),
    [
        (-90.0, 90.0, [-1, 0, 1]),
        (-89.0, 180.0, [0, 1, 2]),
        (0.0, 360.0, [0, 1, 2, 3]),  # a full circle holds none twice
        (10.0, 100.0, [1]),
        (-180.0, 180.0 - 1e-3, [-2, -1, 0, 1]),  # a little less than a full circle
    ],
)
def test_azimuths_of_a_limited_field_of_view(low, high, steps):
    model = lidar(horizontal_fov=(math.radians(low), math.radians(high)))
    assert model.azimuth_steps.tolist() == steps
    assert model.beam_count == len(steps) == len(model.directions)


def test_arbitrary_beams_of_any_length():
    beams = [[2.0, 0.0, 0.0], [0.0, 0.0, 0.1], [3.0, 3.0, 0.0], [-1.0, 0.0, -1.0]]
    model = pe.Lidar.from_directions("rosette", beams, 30.0)
    half = math.sqrt(0.5)
    expected = [[1, 0, 0], [0, 0, 1], [half, half, 0], [-half, 0, -half]]
    np.testing.assert_allclose(model.directions, expected, atol=1e-15)
    assert (model.name, model.max_range, model.azimuth_count) == ("rosette", 30.0, 1)


def test_beams_that_point_nowhere_are_refused():
    assert wrongly_refused(lambda v: pe.Lidar.from_directions("rosette", v, 30.0), NOWHERE) == []


def test_a_voxel_owns_its_lower_faces():
    """A beam along the face between two cubes, and one along the edge of four, belong to one."""
    ahead = at(lidar(azimuths=1))
    two = [[5.5, 0.5, 0.0], [5.5, -0.5, 0.0]]  # the beam runs along y = 0
    assert pe.measure(ahead, two, 1.0).tolist() == [1.0, 0.0]
    above = [[5.5, 0.0, 0.5], [5.5, 0.0, -0.5]]
    assert pe.measure(ahead, above, 1.0).tolist() == [1.0, 0.0]
    four = [[5.5, y, z] for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    assert pe.measure(ahead, four, 1.0).tolist() == [0.0, 0.0, 0.0, 1.0]
    left = at(lidar(azimuths=1), rotation=(0, 0, 90))
    assert pe.measure(left, [[0.5, 5.5, 0.2], [-0.5, 5.5, 0.2]], 1.0).tolist() == [1.0, 0.0]


def test_a_diagonal_beam_through_edges_passes_no_voxel_for_nothing():
    """45 degrees to the left, along the diagonal of every square: the tie goes one way always."""
    diagonal = at(lidar(azimuths=1), rotation=(0, 0, 45))
    on, right, left = ([[k + 0.5 + dx, k + 0.5 + dy, 0.2] for k in range(1, 6)]
                       for dx, dy in ((0, 0), (1, 0), (0, 1)))  # fmt: skip
    assert pe.measure(diagonal, on, 1.0).tolist() == [1.0] * 5
    beside = pe.measure(diagonal, right, 1.0) + pe.measure(diagonal, left, 1.0)
    assert beside.tolist() == [1.0] * 5


def test_a_beam_counts_where_it_enters_within_its_range():
    """The cube round x = 10.5 begins at 10 m: a range of 10 m reaches it, 9.999 m does not."""
    for max_range, counted in ((10.0001, 1.0), (9.9999, 0.0)):
        sensor = at(lidar(azimuths=1, max_range=max_range), (0.0, 0.2, 0.1))
        assert pe.measure(sensor, [[10.5, 0.0, 0.0]], 1.0).tolist() == [counted]
    near = at(lidar(azimuths=1, max_range=0.01), (10.4, 0.2, 0.1))
    assert pe.measure(near, [[10.5, 0.0, 0.0]], 1.0).tolist() == [1.0]  # it stands inside


def test_nothing_is_counted_behind_the_sensor_and_beside_the_beam():
    sensor = at(lidar(azimuths=1), (0.0, 0.2, 0.1))
    assert pe.measure(sensor, [[-5.5, 0.0, 0.0], [5.5, 1.0, 0.0]], 1.0).tolist() == [0.0, 0.0]


def test_the_vehicle_ends_a_beam_where_it_meets_it():
    """A wall at x = 4: the cube from 3 to 4 is passed, that from 4.5 to 5.5 is not."""
    wall = pe.Vehicle(shapes.box((4.0, -2.0, -2.0), (4.2, 2.0, 2.0)))
    sensor = at(lidar(azimuths=1), (0.0, 0.2, 0.1))
    assert pe.measure(sensor, [[3.5, 0, 0], [5.0, 0, 0]], 1.0, wall).tolist() == [1.0, 0.0]
    assert pe.measure(sensor, [[3.5, 0, 0], [5.0, 0, 0]], 1.0).tolist() == [1.0, 1.0]


def test_counts_do_not_depend_on_how_many_voxels_are_asked_for():
    """115,200 beams are looked at 72 voxels at a time."""
    sensor = shapes.lidar_on_roof()
    centers = np.random.default_rng(2).uniform((-9, -9, 0), (9, 9, 3), (200, 3))
    together = pe.measure(sensor, centers, 0.2)
    assert together.tolist() == [pe.measure(sensor, [c], 0.2)[0] for c in centers]
    assert np.count_nonzero(together) > 100


def test_beams_ask_which_part_stops_them():
    """Four level beams: ahead the near wall, left the far one beyond the range, others free."""
    walls = {
        "near": ((3, -1, -1), (3.1, 1, 1)),
        "far": ((-1, 8, -1), (1, 8.1, 1)),
        "back": ((-5.1, -1, -1), (-5, 1, 1)),
        "more": ((-2, -6.1, -1), (2, -6, 1)),
    }
    triangles = list(starmap(shapes.box, walls.values()))
    vehicle = pe.Vehicle(np.concatenate(triangles), np.repeat(range(4), 12), tuple(walls))
    field = pe.beam_field(at(lidar((0.0, 0.1), max_range=7.0)), vehicle)
    assert field.occluded_by.tolist() == [0, -1, 2, 3] * 2
    near = [3.0, 7.0, 5.0, 6.0]
    assert field.ends.tolist() == pytest.approx(near * 2, abs=1e-4)
    counts = field.occluded_count(tuple(walls))
    assert counts == {"near": 2, "back": 2, "more": 2} and list(counts) == ["near", "back", "more"]
    free = pe.beam_field(at(lidar(max_range=7.0)), None)
    assert free.occluded_by.tolist() == [-1] * 4 and free.ends.tolist() == [7.0] * 4
    assert free.occluded_count(()) == {}


def test_the_part_that_stops_most_comes_first():
    """The left wall stops both channels, the one ahead the level one only."""
    ahead = shapes.box((3, -1, -1), (3.1, 1, 0.1))
    left = shapes.box((-1, 3, -1), (1, 3.1, 2))
    vehicle = pe.Vehicle(np.concatenate([ahead, left]), np.repeat([0, 1], 12), ("ahead", "left"))
    field = pe.beam_field(at(lidar((0.0, 20.0))), vehicle)
    assert list(field.occluded_count(("ahead", "left")).items()) == [("left", 2), ("ahead", 1)]


def camera(width=200, height=100, hfov_deg=90.0):
    """100 px of focal length at 90 degrees and 200 px."""
    return pe.Camera("mine", width, height, math.radians(hfov_deg))


def test_a_camera_s_focal_length_and_field_of_view():
    assert camera().focal_px == pytest.approx(100.0)
    assert math.degrees(camera().vfov) == pytest.approx(2.0 * math.degrees(math.atan(0.5)))


@pytest.mark.parametrize(
    ("center", "area"),
    [
        # the face of a 1 m cube 9.5 m ahead: (100 / 9.5)^2
        ((10.0, 0.0, 0.0), (100.0 / 9.5) ** 2),
        # half of it beyond the right edge, 45 degrees to the right: of the near face 10.526 px wide
        # from y = -9.0 (94.737 px, visible) to -9.5 (the edge at 100 px), but the face towards the
        # middle of the picture shows as well, from 9.0 at 10.5 m (85.714 px) to 9.0 at 9.5 m: a
        # trapezoid of heights 100 / 10.5 and 100 / 9.5
        (
            (10.0, -9.5, 0.0),
            (100.0 - 900.0 / 9.5) * 100.0 / 9.5
            + (900.0 / 9.5 - 900.0 / 10.5) * (100.0 / 10.5 + 100.0 / 9.5) / 2.0,
        ),
        # its lower half beyond the upper edge, 50 px up: z from 4.25 to 5.25; seen from below
        (
            (10.0, 0.0, 4.75),
            (50.0 - 425.0 / 9.5) * 100.0 / 9.5
            + (425.0 / 9.5 - 425.0 / 10.5) * (100.0 / 10.5 + 100.0 / 9.5) / 2.0,
        ),
        ((-10.0, 0.0, 0.0), 0.0),  # behind
        ((0.4, 0.0, 0.0), 0.0),  # a corner behind
        ((10.0, -12.0, 0.0), 0.0),  # beside: nearest edge 11.5 / 10.5 of 100 px
        ((10.0, 0.0, 6.5), 0.0),  # above: 6.0 / 10.5 of 100 px is 57
        ((0.501, 0.0, 0.0), 20_000.0),  # right before it: the whole picture
    ],
)
def test_pixel_areas_by_hand(center, area):
    sensor = at(camera())
    assert pe.measure(sensor, [center], 1.0)[0] == pytest.approx(area, abs=1e-6)
    x, y, z = center
    mirrored = pe.measure(sensor, [[x, -y, -z]], 1.0)[0]
    assert mirrored == pytest.approx(area, abs=1e-6)


def test_how_far_inside_the_frustum():
    """Its sides lean by 45 degrees, its top by atan(1 / 2): distances along their normals."""
    depth, left, up = np.array([[10.0, 0.0, 0.0], [10.0, -9.0, 0.0], [10.0, 0.0, 7.0]]).T
    root2 = math.sqrt(2.0)
    root5 = math.sqrt(5.0)
    expected = [10.0 / root5, 1.0 / root2, (10.0 - 14.0) / root5]
    assert frustum_distance(camera(), depth, left, up).tolist() == pytest.approx(expected)


def test_from_afar_a_sample_takes_faces_for_flat_patches():
    """f^2 s^2 (a + 3 s / 2) / (d^3 - d s^2 / 2), a the way to the near faces along all axes.

    At (20, 3, -2): a = 19.5 + 2.5 + 1.5, so 100^2 (23.5 + 1.5) / (8000 - 10). At (14, 0, 0), nearer
    than 15 sides, and at the picture's border it is the exact area.
    """
    pose = pe.Pose((0.0, 0.0, 0.0))
    model = camera()
    centers = np.array([[20.0, 3.0, -2.0], [14.0, 0.0, 0.0], [20.0, 19.5, 0.0]])
    found = pixel_areas(model, pose, centers, side=1.0, seen=None)
    exact = pe.measure(pe.Sensor("s", model, pose), centers, 1.0)
    assert found[0] == pytest.approx(1e4 * 25.0 / 7990.0, rel=1e-12)
    assert found[0] != exact[0] and abs(found[0] / exact[0] - 1.0) < 0.003
    assert found[1:].tolist() == exact[1:].tolist()


def test_a_camera_on_its_side_sees_high_and_narrow():
    """Rolled by 90 degrees, 45 degrees up and down are in the picture, to the sides 26.6 only."""
    upright = at(camera())
    rolled = at(camera(), rotation=(90.0, 0.0, 0.0))
    high = [10.0, 0.0, 8.0]
    wide = [10.0, 8.0, 0.0]
    assert (pe.measure(upright, [high, wide], 1.0) > 0).tolist() == [False, True]
    assert (pe.measure(rolled, [high, wide], 1.0) > 0).tolist() == [True, False]
    turned = at(camera(), (1.0, 2.0, 3.0), (0.0, 0.0, 90.0))
    assert pe.measure(turned, [[1.0, 12.0, 3.0]], 1.0)[0] == pytest.approx((100.0 / 9.5) ** 2)


def test_the_vehicle_hides_what_is_behind_it_and_nothing_before_it():
    """A wall at x = 6, 2 m wide: centres at 5 m stay, at 8 m go, beside it they stay."""
    wall = pe.Vehicle(shapes.box((6.0, -1.0, -1.0), (6.1, 1.0, 1.0)))
    centers = [[5.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 1.2, 0.0], [8.0, 2.0, 0.0], [-8.0, 0, 0]]
    found = pe.measure(at(camera()), centers, 1.0, wall)
    assert (found > 0).tolist() == [True, False, False, True, False]
    free = pe.measure(at(camera()), centers, 1.0)
    assert found[[0, 3]].tolist() == free[[0, 3]].tolist() and (free[:4] > 0).all()


@pytest.mark.parametrize("centers", [[[1.0, 2.0]], [1.0, 2.0, 3.0], [[0.0, 0.0, math.inf]]])
def test_centres_have_three_finite_numbers(centers):
    with pytest.raises(pe.InputError, match="measure: centers"):
        pe.measure(at(camera()), centers, 1.0)


def test_wrong_tables_are_refused():
    assert wrongly_refused(lambda v: pe.catalog.from_table("mine", v), WRONG_TABLES) == []


def test_a_beam_counts_where_it_leaves_a_voxel_no_nearer():
    """One beam along x from 0.5 in a row of metre cubes: with 1.6 m the first seen ends at 2.5."""
    ahead = pe.Lidar.from_directions("one", [[1.0, 0.0, 0.0]], 100.0, 1.6)
    sensor = pe.Sensor("one", ahead, pe.Pose((0.5, 0.5, 0.5)))
    centers = [[x + 0.5, 0.5, 0.5] for x in range(5)]
    assert pe.measure(sensor, centers, 1.0).tolist() == [0, 0, 1, 1, 1]
