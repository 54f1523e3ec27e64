"""One small lopsided scene, worked by hand: 24 voxels, two classes, two LiDARs and a camera.

Nothing in it is symmetric, so that front and rear, left and right, near and far, one class and the
other, one sensor and the other cannot be taken for each other. Voxels are 14 m wide, and called
(i, j, k) along x, y, z. Seen from above, with the middles of the columns:

              j = 2, y = 21     (0, 2) window   (1, 2)         (2, 2)         (3, 2)
    left
              j = 1, y = 7      (0, 1) roof     (1, 1)         (2, 1) board   (3, 1)
    eye >
    right     j = 0, y = -7     (0, 0) lid      (1, 0) hood    (2, 0)         (3, 0)
                                                       mast
                                 x = -7           7              21             35
                                 rear            front ->
"""

import math
from dataclasses import asdict

import numpy as np
import pytest

import pe_core as pe

SPACE = pe.PerceptionSpace((-14.0, 42.0), (-14.0, 28.0), (0.0, 28.0), 14.0)

# Entropies. A LiDAR's AP is 0.152 ln m + 0.659, a camera's 0.055 ln m + 0.155; sigma = 1 / AP - 1;
# H = 2 ln sigma + 1 + ln(2 pi) = 2 ln sigma + 2.837877; late fusion adds 1 / sigma^2.
H0 = 16.651386624  # not seen: AP 0.001, sigma 999
H1 = 1.520194952  # one beam: AP 0.659, sigma 0.517450683, 1 / sigma^2 3.734754603
H2 = 0.484427819  # two: AP 0.764358371, sigma 0.308286842, 10.5217995
H3 = -0.277049759  # three: AP 0.825989068, sigma 0.210669776, 22.53178155
HC = 3.580001643  # 100 pixels: AP 0.408284360, sigma 1.449273343, 0.4761013265
H1_1 = 0.827047906  # one beam and, in another group, one more: 2 x 3.734754603 = 7.469509
H1_C = 1.400211369  # one beam and the camera: 4.210855
H2_C = 0.440172737  # two beams of one group and the camera: 10.997900
H1_1_C = 0.765257677  # one, one, and the camera: 7.945610
LOOK_UP = 2e-4
"""A pixel area is looked at to 11 binary digits: 0.055 / 4096 in AP, 1.1e-4 in H at 100 px."""

# What each sensor sees.
#
# hood, at the centre of (1, 0, 0), has three beams of 20 m. Straight ahead: stopped by the mast 3 m
# on, inside its own voxel. To the left: (1, 1, 0) after 7 m; (1, 2, 0) would be 21 m. Ahead and up,
# two up for one along: over the mast, which is 10 m high where the beam is at 13, into (1, 0, 1) at
# x = 10.5 (7.8 m on), and into (2, 0, 1) at x = 14 and z = 21 (15.7 m on).
HOOD = {(1, 0, 0): 3, (1, 1, 0): 1, (1, 0, 1): 1, (2, 0, 1): 1}
# roof, at the centre of (0, 1, 0), has two beams of 30 m. To the left: (0, 2, 0) after 7 m, where
# the window stops it at 9 m. Ahead: (1, 1, 0) after 7 m, (2, 1, 0) after 21 m; the board at 32 m is
# beyond its range, as (3, 1, 0) is at 35 m.
ROOF = {(0, 1, 0): 2, (0, 2, 0): 1, (1, 1, 0): 1, (2, 1, 0): 1}
# eye, 14 m behind the space in the row of (., 1, 0), sees 10 x 10 pixels with a focal length of 50:
# the first voxel's face is 14 m wide at 14 m, 50 px, the last's at 56 m 12.5 px; each fills the
# picture, 100 px. The nearest edge of the next row is never nearer to the middle than 7 / 70 of 50,
# 5 px: outside. It looks through the window; the board hides (3, 1, 0).
EYE = {(0, 1, 0): 100.0, (1, 1, 0): 100.0, (2, 1, 0): 100.0}
UP = math.degrees(math.atan(2.0))
# The prior: labelled boxes of one voxel each, cars on the ground, trucks two voxels high, and the
# trucks counted twice: cars are 1/3 of it, 1/48 a box; trucks 2/3, 1/24 for each of a box's voxels.
CARS = {
    (0, 0): 1, (0, 1): 2, (0, 2): 1, (1, 0): 1, (1, 1): 4, (1, 2): 1,
    (2, 0): 2, (2, 1): 1, (3, 0): 1, (3, 1): 1, (3, 2): 1,
}  # fmt: skip
TRUCKS = {(0, 2): 1, (1, 0): 2, (2, 0): 3, (3, 1): 2}
CLASSES = {
    # 15 of 47: (0,1) 2, (0,2) 1, (1,0) 1, (1,1) 4, (2,1) 1 are seen, 6 are not
    "car": ((2 * H2_C + H1 + H3 + 4 * H1_1_C + H1_C + 6 * H0) / 15, 9 / 15, 15 / 47),
    # 32 of 47, 2 a voxel: seen are (0,2,0), 2 of (1,0,0), 2 of (1,0,1), 3 of (2,0,1)
    "truck": ((2 * H1 + 4 * H3 + 4 * H1 + 6 * H1 + 16 * H0) / 32, 16 / 32, 32 / 47),
}
ZONES = {
    # x > 0: (1,0) 5 + 4, (1,1) 4, (1,2) 1, (2,0) 8 + 6, (2,1) 1, (3,0) 1, (3,1) 5 + 4, (3,2) 1
    "front": ((5 * H3 + 4 * H1 + 4 * H1_1_C + 6 * H1 + H1_C + 20 * H0) / 40, 20 / 40, 40 / 47),
    # x < 0: (0,1) 2, (0,2) 3 + 2
    "rear": ((2 * H2_C + 3 * H1 + 2 * H0) / 7, 5 / 7, 7 / 47),
    # y > 0: (0,1) 2, (0,2) 3 + 2, (1,1) 4, (1,2) 1, (2,1) 1, (3,1) 5 + 4, (3,2) 1
    "left": ((2 * H2_C + 3 * H1 + 4 * H1_1_C + H1_C + 13 * H0) / 23, 10 / 23, 23 / 47),
    # y < 0: (1,0) 5 + 4, (2,0) 8 + 6, (3,0) 1
    "right": ((5 * H3 + 4 * H1 + 6 * H1 + 9 * H0) / 24, 15 / 24, 24 / 47),
    # nearer than 10 m: four columns 9.90 m away: (0,1) 2, (1,0) 5 + 4, (1,1) 4
    "near": ((2 * H2_C + 5 * H3 + 4 * H1 + 4 * H1_1_C) / 15, 15 / 15, 15 / 47),
    # between: all others but (3,2): (0,2) 3 + 2, (1,2) 1, (2,0) 8 + 6, (2,1) 1, (3,0) 1, (3,1) 9
    "mid": ((3 * H1 + 6 * H1 + H1_C + 21 * H0) / 31, 10 / 31, 31 / 47),
    # farther than 40 m: (35, 21) is 40.8 m away
    "far": (H0, 0.0, 1 / 47),
}
SENSORS = {
    # alone: 5 H3, 4 + 4 + 6 H1. Failed: (1,0,0), (1,0,1), (2,0,1) are not seen, (1,1,0) is by two.
    "hood": (
        (5 * H3 + 14 * H1 + 28 * H0) / 47,
        19 / 47,
        (5 * (H0 - H3) + 10 * (H0 - H1) + 4 * (H1_C - H1_1_C)) / 47,
    ),
    # alone: 2 H2, 3 + 4 + 1 H1. Failed: (0,2,0) is not seen, three more by what is left.
    "roof": (
        (2 * H2 + 8 * H1 + 37 * H0) / 47,
        10 / 47,
        (3 * (H0 - H1) + 2 * (HC - H2_C) + 4 * (H1_C - H1_1_C) + (HC - H1_C)) / 47,
    ),
    # alone: 2 + 4 + 1 HC. Failed: all it sees is seen by others.
    "eye": (
        (7 * HC + 40 * H0) / 47,
        7 / 47,
        (2 * (H2 - H2_C) + 4 * (H1_1 - H1_1_C) + (H1 - H1_C)) / 47,
    ),
}
BEAMS = {
    "hood": (3, 1, {"mast": 1}),
    "roof": (2, 1, {"window": 1}),
    "eye": (100, 100, {"board": 100}),
}
"""The eye's picture is 10 x 10 pixels, 10.6 m wide where the board of 14 m stands: all of it."""


def beams(name, position, angles_deg, max_range):
    """A LiDAR with a beam for each (azimuth, elevation)."""
    azimuths, elevations = np.radians(angles_deg).T
    model = pe.Lidar(
        name, elevations, azimuth_count=1, max_range=max_range, azimuth_offsets=azimuths
    )
    return pe.Sensor(name, model, pe.Pose(position), fusion=name)


RIG = pe.Rig(
    [
        beams("hood", (7.0, -7.0, 7.0), [(0.0, 0.0), (90.0, 0.0), (0.0, UP)], 20.0),
        beams("roof", (-7.0, 7.0, 7.0), [(90.0, 0.0), (0.0, 0.0)], 30.0),
        pe.Sensor(
            "eye", pe.Camera("eye", 10, 10, 2.0 * math.atan(0.1)), pe.Pose((-28.0, 7.0, 7.0))
        ),
    ]
)


def plate(low, high):
    """Two triangles of a rectangle that is flat along one axis."""
    a, b = [k for k in range(3) if low[k] != high[k]]
    flat = np.array(low, float)
    corners = np.array([flat] * 4)
    corners[[1, 2], a] = high[a]
    corners[[2, 3], b] = high[b]
    return corners[[0, 1, 2, 0, 2, 3]].reshape(2, 3, 3)


PARTS = {
    "lid": [plate((-14, -14, 10), (0, 0, 10))],  # (0, 0, 0), centre at 7 m, lies under it
    "mast": [plate((10, -10, 0), (10, -4, 10))],
    "board": [plate((25, 0, 0), (25, 14, 14))],
    "window": [plate((-20, 0, 0), (-20, 14, 14)), plate((-14, 16, 0), (0, 16, 14))],
}
VEHICLE = pe.Vehicle(
    np.concatenate([p for plates in PARTS.values() for p in plates]),
    np.repeat(range(4), [2 * len(plates) for plates in PARTS.values()]),
    tuple(PARTS),
    glass=("window",),
)

# In 48ths, then, and without (0, 0, 0), which lies in the vehicle's own volume: 47 in all.
#   ground: (0,1) 2   (0,2) 1 + 2   (1,0) 1 + 4   (1,1) 4   (1,2) 1   (2,0) 2 + 6   (2,1) 1
#           (3,0) 1   (3,1) 1 + 4   (3,2) 1
#   above:  (0,2) 2   (1,0) 4       (2,0) 6       (3,1) 4


def boxes(name, columns, height):
    return [
        (name, 14.0 * i - 7.0, 14.0 * j - 7.0, height / 2.0, 14.0, 14.0, height, 0.0)
        for (i, j), count in columns.items()
        for _ in range(count)
    ]


PRIOR = pe.Prior.from_boxes(
    boxes("car", CARS, 14.0) + boxes("truck", TRUCKS, 28.0), [pe.Focus(2.0, classes=("truck",))]
)


@pytest.fixture(scope="module")
def grid():
    return pe.Evaluator(SPACE, PRIOR, VEHICLE).score(RIG)


@pytest.fixture(scope="module")
def sampled():
    return pe.Evaluator(SPACE, PRIOR, VEHICLE, samples=1 << 14).score(RIG)


@pytest.mark.parametrize(("name", "seen"), [("hood", HOOD), ("roof", ROOF), ("eye", EYE)])
def test_what_each_sensor_measures(name, seen):
    index = np.argwhere(np.ones(SPACE.shape))
    found = pe.measure(RIG[name], SPACE.center_of(index), SPACE.interval, VEHICLE)
    expected = [seen.get(tuple(voxel), 0) for voxel in index.tolist()]
    assert found.tolist() == pytest.approx(expected, abs=1e-9)


def test_where_the_prior_lies():
    car, truck = PRIOR.densities(SPACE)
    assert (car.name, truck.name) == ("car", "truck")
    assert car.profile.tolist() == [1.0, 0.0] and truck.profile.tolist() == [0.5, 0.5]
    for density, counts, unit in ((car, CARS, 1 / 48), (truck, TRUCKS, 1 / 12)):
        expected = [[unit * counts.get((i, j), 0) for j in range(3)] for i in range(4)]
        np.testing.assert_allclose(density.ground, expected, atol=1e-15)


def test_the_whole(grid):
    """Seen are 25 of 47: (0,1,0), (0,2,0), (1,0,0), (1,1,0), (2,1,0), (1,0,1), (2,0,1)."""
    seen = 2 * H2_C + 3 * H1 + 5 * H3 + 4 * H1_1_C + 1 * H1_C + 4 * H1 + 6 * H1
    assert grid.entropy == pytest.approx((seen + 22 * H0) / 47, abs=LOOK_UP)
    assert grid.coverage == pytest.approx(25 / 47, abs=1e-9)
    assert (grid.stderr, grid.voxels) == (0.0, 24)


def check_parts(found, expected, within):
    assert list(found) == list(expected)
    for name, values in expected.items():
        part = found[name]
        assert (part.entropy, part.coverage, part.share) == pytest.approx(values, abs=within), name


def test_classes(grid):
    check_parts(grid.per_class, CLASSES, LOOK_UP)


def test_zones(grid):
    check_parts(grid.per_zone, ZONES, LOOK_UP)


def test_sensors_alone_and_lost(grid):
    assert list(grid.per_sensor) == ["hood", "roof", "eye"]
    for name, (entropy, coverage, lost) in SENSORS.items():
        own = grid.per_sensor[name]
        assert own.entropy == pytest.approx(entropy, abs=LOOK_UP)
        assert own.coverage == pytest.approx(coverage, abs=1e-9)
        assert own.lost == pytest.approx(lost, abs=LOOK_UP)
        assert (own.beams, own.occluded, own.occluded_by) == BEAMS[name]


def test_the_ground_map(grid):
    """Columns, their entropies and coverage averaged over height, and their 48ths of the prior."""
    nan = math.nan
    mixed = (5 * H3 + 4 * H1) / 9
    entropy = [
        [nan, H2_C, (3 * H1 + 2 * H0) / 5],
        [mixed, H1_1_C, H0],
        [(8 * H0 + 6 * H1) / 14, H1_C, nan],
        [H0, H0, H0],
    ]
    coverage = [[nan, 1, 3 / 5], [1, 1, 0], [6 / 14, 1, nan], [0, 0, 0]]
    mass = [[0, 2, 5], [9, 4, 1], [14, 1, 0], [1, 9, 1]]
    np.testing.assert_allclose(grid.ground_map.entropy, entropy, atol=LOOK_UP)
    np.testing.assert_allclose(grid.ground_map.coverage, coverage, atol=1e-12)
    np.testing.assert_allclose(grid.ground_map.mass, np.array(mass) / 48, atol=1e-15)


def test_a_coarser_ground_map(grid):
    """Squares of two by two columns; one column is left at the far end of y."""
    coarse = grid.ground_map.coarser(2)
    front = 8 * H0 + 6 * H1 + H0 + H1_C + 9 * H0  # (2,0), (3,0), (2,1), (3,1)
    entropy = [
        [(2 * H2_C + 5 * H3 + 4 * H1 + 4 * H1_1_C) / 15, (3 * H1 + 2 * H0 + H0) / 6],
        [front / 25, H0],
    ]
    np.testing.assert_allclose(coarse.entropy, entropy, atol=LOOK_UP)
    np.testing.assert_allclose(coarse.coverage, [[1, 3 / 6], [7 / 25, 0]], atol=1e-12)
    np.testing.assert_allclose(coarse.mass * 48, [[15, 6], [25, 1]], atol=1e-12)


def test_columns_without_any_prior_are_no_square_of_a_coarser_map():
    empty = pe.GroundMap(*np.array([[[math.nan, 2.0]], [[math.nan, 1.0]], [[0.0, 0.5]]]))
    same = empty.coarser(1)
    np.testing.assert_array_equal(same.entropy, [[math.nan, 2.0]])
    np.testing.assert_array_equal(same.coverage, [[math.nan, 1.0]])
    assert empty.coarser(2).entropy.tolist() == [[2.0]]


def test_a_sample_tells_the_same(sampled, grid):
    """Of 16,384 draws: shares within 0.001, entropies within 0.02 of 17 nats."""
    assert 15_900 < sampled.voxels < 16_384 and sampled.ground_map is None
    assert sampled.entropy == pytest.approx(grid.entropy, abs=0.02)
    assert sampled.coverage == pytest.approx(25 / 47, abs=0.001)
    check_parts(sampled.per_class, CLASSES, 0.02)
    check_parts(sampled.per_zone, ZONES, 0.02)
    for found, expected in ((sampled.per_class, CLASSES), (sampled.per_zone, ZONES)):
        for name, (_, coverage, share) in expected.items():
            part = found[name]
            assert (part.coverage, part.share) == pytest.approx((coverage, share), abs=0.001)
    for name, (entropy, coverage, lost) in SENSORS.items():
        own = sampled.per_sensor[name]
        assert (own.entropy, own.lost) == pytest.approx((entropy, lost), abs=0.02)
        assert own.coverage == pytest.approx(coverage, abs=0.001)
        assert (own.beams, own.occluded, own.occluded_by) == BEAMS[name]


def test_one_fusion_group_sums_beams():
    """hood and roof in one group: (1,1,0) then holds two beams, H2, and not twice one, H1_1."""
    lidars = [pe.Sensor(n, RIG[n].model, RIG[n].pose) for n in ("hood", "roof")]
    early = pe.Evaluator(SPACE, PRIOR, VEHICLE).score(pe.Rig(lidars))
    late = pe.Evaluator(SPACE, PRIOR, VEHICLE).score(pe.Rig([RIG["hood"], RIG["roof"]]))
    same = 2 * H2 + 3 * H1 + 5 * H3 + 1 * H1 + 4 * H1 + 6 * H1 + 22 * H0
    assert early.entropy == pytest.approx((same + 4 * H2) / 47, abs=1e-8)
    assert late.entropy == pytest.approx((same + 4 * H1_1) / 47, abs=1e-8)


def test_the_letter_of_equation_7_lets_blind_sensors_vote():
    """Three groups, each worth at least f = 1 / 999^2: unseen voxels hold 3 f, H0 - ln 3."""
    model = pe.PerceptionModel(blind="literal")
    score = pe.Evaluator(SPACE, PRIOR, VEHICLE, model=model).score(RIG)
    seen = 2 * H2_C + 3 * H1 + 5 * H3 + 4 * H1_1_C + 1 * H1_C + 4 * H1 + 6 * H1
    expected = (seen + 22 * (H0 - math.log(3.0))) / 47
    assert score.entropy == pytest.approx(expected, abs=LOOK_UP)
    rest = 22 * (H0 - math.log(2.0)) + 5 * H3 + 4 * H1_1 + 1 * H1 + 2 * H2 + 13 * H1
    assert score.per_sensor["eye"].lost == pytest.approx(rest / 47 - expected, abs=LOOK_UP)


def test_a_lone_sensor_s_failure_costs_all_it_saw():
    """hood alone: its whole 19 of 47 fall back to H0."""
    for samples, within in ((0, 1e-8), (1 << 14, 0.02)):
        evaluator = pe.Evaluator(SPACE, PRIOR, VEHICLE, samples=samples)
        own = evaluator.score(pe.Rig([RIG["hood"]])).per_sensor["hood"]
        assert own.lost == pytest.approx((5 * (H0 - H3) + 14 * (H0 - H1)) / 47, abs=within)


def test_without_a_vehicle_nothing_is_hidden_and_nothing_left_out():
    """hood's first beam goes on to (2,0,0), the eye sees (3,1,0), and (0,0,0) counts: 48 in all."""
    score = pe.Evaluator(SPACE, PRIOR).score(RIG)
    seen = 2 * H2_C + 3 * H1 + 5 * H3 + 4 * H1_1_C + 1 * H1_C + 4 * H1 + 6 * H1
    assert score.entropy == pytest.approx(
        (seen + 8 * H1 + 5 * HC + (22 - 13 + 1) * H0) / 48, abs=LOOK_UP
    )
    assert score.coverage == pytest.approx((25 + 13) / 48, abs=1e-9)
    assert {n: (s.beams, s.occluded) for n, s in score.per_sensor.items()} == {
        "hood": (3, 0),
        "roof": (2, 0),
        "eye": (100, 0),
    }


def test_the_score_as_plain_data_says_the_same(grid):
    data = grid.to_dict()
    assert data["entropy"] == grid.entropy
    assert data["per_class"] == {name: asdict(part) for name, part in grid.per_class.items()}
    assert data["per_zone"]["far"] == {"entropy": H0, "coverage": 0.0, "share": round(1 / 47, 9)}
    assert data["per_sensor"]["hood"]["occluded_by"] == {"mast": 1}
    assert (data["coverage"], data["stderr"], data["voxels"]) == (round(25 / 47, 9), 0.0, 24)
