"""Constants of the paper and of data sheets, written down once more: a slip of the pen shows."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core import metric
from pe_core.prior import HIGHWAY_CLASSES, ROAD_CLASSES
from pe_core.scoring.score import ZONES
from pe_core.search import PAPER_FREE, search_space

ROAD = [
    # name, size (length, width, height), its spread, decay_x, Laplace and Gauss along y, Laplace's
    # share, lanes, share
    ("car", (4.6, 1.9, 1.7), 0.195, 39.4, 12.82, 20.03, 0.533, (0.0,), 1.0),
    ("pedestrian", (0.8, 0.7, 1.75), 0.120, 32.2, 659.55, 16.15, 0.171, (0.0,), 1.0),
    ("cyclist", (1.76, 0.65, 1.74), 0.267, 28.7, 170.45, 14.89, 0.033, (0.0,), 1.0),
    ("truck", (7.5, 2.55, 3.0), 0.785, 58.5, 20.1, 22.33, 0.365, (0.0,), 1.0),
    ("cone", (0.4, 0.4, 0.9), 0.232, 14.8, 34.25, 10.05, 0.024, (0.0,), 1.0),
]
LANES = (-3.75, 0.0, 3.75)
EDGES = (-5.625, -1.875, 1.875, 5.625)
HIGHWAY = [
    ("car", (4.6, 1.9, 1.7), 0.195, 58.1, 13.93, 0.3, 0.2, LANES, 0.4),
    ("truck", (10.8, 2.7, 3.5), 0.327, 59.5, 13.93, 0.3, 0.2, LANES, 0.4),
    ("cyclist", (2.11, 0.77, 1.74), 0.267, 45.4, 13.93, 0.3, 0.2, LANES, 0.1),
    ("cone", (0.4, 0.4, 0.9), 0.232, 21.7, 13.93, 0.3, 0.0, EDGES, 0.1),
]

# Ma, Liu and Li, Perception Entropy, ICRA 2021. Table I has the channels, steps and vertical fields
# of view; where in it the channels lie is from Hesai's manuals, ranges are the makers'.


def numbers(text):
    return [float(word) for word in text.split()]


PANDAR64_SIXTHS_OF_A_DEGREE = (
    numbers(  # 15, 11, 8, 5, 3, 2 to -6 by sixths, -7 to -14, -19, -25 deg
        """
    90 66 48 30 18 12 11 10 9 8 7 6 5 4 3 2 1 0 -1 -2 -3 -4 -5 -6 -7 -8 -9 -10 -11 -12 -13 -14
    -15 -16 -17 -18 -19 -20 -21 -22 -23 -24 -25 -26 -27 -28 -29 -30 -31 -32 -33 -34 -35 -36
    -42 -48 -54 -60 -66 -72 -78 -84 -114 -150
    """
    )
)
PANDAR40_THIRDS_OF_A_DEGREE = numbers(  # the same, by thirds from 2 to -6
    """
    45 33 24 15 9 6 5 4 3 2 1 0 -1 -2 -3 -4 -5 -6 -7 -8 -9 -10 -11 -12 -13 -14 -15 -16 -17 -18
    -21 -24 -27 -30 -33 -36 -39 -42 -57 -75
    """
)
HDL64E_THOUSANDTHS_OF_A_DEGREE = numbers(  # 64 channels from -24.9 deg in steps of 0.427
    """
    -24900 -24473 -24046 -23619 -23192 -22765 -22338 -21911 -21484 -21057 -20630 -20203 -19776
    -19349 -18922 -18495 -18068 -17641 -17214 -16787 -16360 -15933 -15506 -15079 -14652 -14225
    -13798 -13371 -12944 -12517 -12090 -11663 -11236 -10809 -10382 -9955 -9528 -9101 -8674
    -8247 -7820 -7393 -6966 -6539 -6112 -5685 -5258 -4831 -4404 -3977 -3550 -3123 -2696 -2269
    -1842 -1415 -988 -561 -134 293 720 1147 1574 2001
    """
)
LIDARS = {
    # name: elevations, how many to a degree, azimuths, range [m], beams
    "Pandar64": (PANDAR64_SIXTHS_OF_A_DEGREE, 6, 1800, 200.0, 115_200),
    "Pandar40": (PANDAR40_THIRDS_OF_A_DEGREE, 3, 1800, 200.0, 72_000),
    "HDL-64E": (HDL64E_THOUSANDTHS_OF_A_DEGREE, 1000, 2156, 120.0, 137_984),
}


@pytest.mark.parametrize("name", LIDARS)
def test_the_paper_s_lidars(name):
    """Idealised as in Table I: no azimuth offsets, a full circle in steps of 0.2 or 0.167 deg."""
    elevations, to_a_degree, azimuths, max_range, beams = LIDARS[name]
    lidar = pe.catalog.load(name)
    found = (np.degrees(lidar.elevations) * to_a_degree).tolist()
    assert found == pytest.approx(elevations, abs=1e-9)
    assert (lidar.azimuth_count, lidar.max_range, lidar.beam_count) == (azimuths, max_range, beams)
    assert lidar.azimuth_offsets.tolist() == [0.0] * len(elevations)
    assert lidar.horizontal_fov == (-math.pi, math.pi)


@pytest.mark.parametrize(
    ("hfov", "focal_px", "vfov"),
    [
        # 960 / tan(hfov / 2); 2 atan(540 / focal)
        (30, 3582.768775, 17.142372),
        (60, 1662.768775, 35.983398),
        (120, 554.256258, 88.507155),
    ],
)
def test_the_paper_s_cameras(hfov, focal_px, vfov):
    camera = pe.catalog.load(f"Camera {hfov} deg")
    assert (camera.width, camera.height) == (1920, 1080)
    assert math.degrees(camera.hfov) == pytest.approx(hfov, abs=1e-12)
    assert camera.focal_px == pytest.approx(focal_px, abs=1e-6)
    assert math.degrees(camera.vfov) == pytest.approx(vfov, abs=1e-6)


DATA_SHEETS = {
    # name: (elevations, azimuth offsets) [deg], azimuths, range [m]
    "Velodyne VLP-16 Puck": (
        numbers("15 13 11 9 7 5 3 1 -1 -3 -5 -7 -9 -11 -13 -15"),
        [0] * 16,
        1800,
        100.0,
    ),
    "Velodyne VLP-32C Ultra Puck": (
        numbers(
            """
            15 10.333 7 4.667 3.333 2.333 1.667 1.333 1 0.667 0.333 0 -0.333 -0.667 -1 -1.333
            -1.667 -2 -2.333 -2.667 -3 -3.333 -3.667 -4 -4.667 -5.333 -6.148 -7.254 -8.843 -11.31
            -15.639 -25
            """
        ),
        numbers(
            """
            1.4 -1.4 1.4 -1.4 1.4 -1.4 4.2 1.4 -1.4 -4.2 4.2 1.4 -1.4 -4.2 4.2 1.4
            -1.4 -4.2 4.2 1.4 -1.4 -4.2 4.2 1.4 -1.4 -4.2 1.4 -1.4 1.4 -1.4 1.4 -1.4
            """
        ),
        1800,
        200.0,
    ),
}


@pytest.mark.parametrize("name", DATA_SHEETS)
def test_lidars_of_data_sheets(name):
    """Velodyne's user manuals: VLP-16, "Laser ID and elevation angle"; VLP-32C, appendix A."""
    elevations, offsets, azimuths, max_range = DATA_SHEETS[name]
    lidar = pe.catalog.load(name)
    assert np.degrees(lidar.elevations).tolist() == pytest.approx(elevations, abs=1e-9)
    assert np.degrees(lidar.azimuth_offsets).tolist() == pytest.approx(offsets, abs=1e-9)
    assert (lidar.azimuth_count, lidar.max_range) == (azimuths, max_range)


def test_the_paper_s_curves_and_clamp():
    """PointPillars' and RTM3D's AP on KITTI moderate; AP is kept from 0.001 to 0.999."""
    assert (metric.POINTPILLARS.a, metric.POINTPILLARS.b) == (0.152, 0.659)
    assert (metric.RTM3D.a, metric.RTM3D.b) == (0.055, 0.155)
    assert (metric.AP_MIN, metric.AP_MAX) == (0.001, 0.999)
    model = pe.PerceptionModel()
    assert model.curve("lidar") == metric.POINTPILLARS and model.curve("camera") == metric.RTM3D
    assert model.blind == "floor"


def test_measurements_from_which_on_ap_is_clipped():
    """exp(0.34 / 0.152) = 9.363715 beams, exp(0.844 / 0.055) = 4,617,918 pixels."""
    assert metric.POINTPILLARS.saturation == pytest.approx(9.363715, abs=1e-6)
    assert metric.RTM3D.saturation == pytest.approx(4_617_918, abs=1)
    ap = metric.average_precision([9, 10, 1e7], metric.POINTPILLARS)
    assert ap.tolist() == pytest.approx([0.659 + 0.152 * 2.1972245773, 0.999, 0.999], abs=1e-9)


@pytest.mark.parametrize(
    ("ap", "sigma", "entropy"),
    [
        # sigma = 1 / AP - 1, H = 2 ln sigma + 1 + ln(2 pi), 1 + ln(2 pi) = 2.837877066
        (0.001, 999.0, 16.651386624),  # a blind voxel: 2 ln 999 = 13.813509557
        (0.5, 1.0, 2.837877066),
        (0.659, 0.517450683, 1.520194952),  # one beam: 2 ln 0.517450683 = -1.317682114
        (0.155, 5.451612903, 6.229700087),  # one pixel: 2 ln 5.451612903 = 3.391823021
        (0.999, 0.001001001, -10.975632491),  # a saturated one: 2 ln (1 / 999) = -13.813509557
    ],
)
def test_entropies_at_round_numbers(ap, sigma, entropy):
    assert float(metric.sigma_of(ap)) == pytest.approx(sigma, abs=1e-9)
    assert float(metric.entropy_of(sigma**-2)) == pytest.approx(entropy, abs=2e-6)
    assert float(metric.entropy_of(metric.sigma_of(ap) ** -2)) == pytest.approx(entropy, abs=1e-8)


def test_a_blind_voxel():
    assert pytest.approx(16.651386624, abs=1e-9) == metric.H_BLIND
    assert pytest.approx(1.0 / 998_001, rel=1e-12) == metric.BLIND_PRECISION  # 999^2


def test_the_paper_s_space():
    """x -80 to 80, y -40 to 40, z 0 to 5 m by 0.1 m: 1600 x 800 x 50."""
    space = pe.PerceptionSpace()
    assert (space.x, space.y, space.z) == ((-80.0, 80.0), (-40.0, 40.0), (0.0, 5.0))
    assert space.interval == 0.1 and space.origin == (-80.0, -40.0, 0.0)
    assert space.shape == (1600, 800, 50) and space.size == 64_000_000


def test_algorithm_1_s_schedule():
    """From 1 m and 30 deg by halves to 0.01 m and 0.3 deg; 1000 placements each; x, y, z, pitch."""
    schedule = pe.Schedule()
    assert (schedule.candidates, search_space.DECAY) == (1000, 0.5)
    assert (search_space.REACH_M, search_space.FLOOR_M) == (1.0, 0.01)
    assert math.degrees(search_space.REACH_RAD) == pytest.approx(30.0, abs=1e-12)
    assert math.degrees(search_space.FLOOR_RAD) == pytest.approx(0.3, abs=1e-12)
    assert schedule.scales == [1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625]
    assert PAPER_FREE == ("x", "y", "z", "pitch")
    assert pe.Search().samples == 65_536 and pe.Search().seed == 0


# The priors' classes. Road: maximum likelihood fits to CenterPoint's boxes of score 0.4 and more in
# the 150 scenes of nuScenes val (46,817 cars, 28,720 pedestrians, 5,740 cyclists, 13,069 trucks,
# 13,928 cones). Highway: decays of KITTI tracking (trucks) and Argoverse 2; lanes of 3.75 m.


@pytest.mark.parametrize(
    ("classes", "expected"), [(ROAD_CLASSES, ROAD), (HIGHWAY_CLASSES, HIGHWAY)]
)
def test_classes_of_the_priors(classes, expected):
    found = [
        (c.name, c.size, c.height_spread, c.decay_x, c.laplace_y, c.gauss_y, c.laplace_share)
        for c in classes
    ]
    assert found == [row[:7] for row in expected]
    assert [(c.lanes, c.share) for c in classes] == [row[7:] for row in expected]


def test_the_priors_are_made_of_them():
    assert pe.Prior.road().classes == ROAD_CLASSES
    assert pe.Prior.highway().classes == HIGHWAY_CLASSES
    assert pe.Prior.uniform().classes == () and pe.Prior.uniform().class_names == ("any",)


def test_zones_and_their_order():
    assert ZONES == ("front", "rear", "left", "right", "near", "mid", "far")
