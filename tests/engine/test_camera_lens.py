"""Lenses: their projections as OpenCV has them, there and back, and those that are refused."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.camera.lens import RINGS, field_outline, fold_angle
from pe_core.sensors.camera.lens_models import BrownConrady, FTheta, KannalaBrandt, Pinhole
from pe_core.sensors.camera.pixel_area import frustum_distance
from pe_core.sensors.camera.sample_areas import BEYOND, NEAREST_RAD, QuickLens
from tests.engine.refusals import wrongly_refused

WIDE = BrownConrady(930.5, 932.25, 965.0, 530.0, k1=-0.25, k2=0.12, p1=1e-3, p2=-2e-3, k3=-0.02)
RATIONAL = BrownConrady(
    610.0, 612.0, 640.0, 400.0, None, 0.3, 0.05, -5e-4, 4e-4, 0.01, 0.6, 0.1, 0.005
)
FISHEYE = KannalaBrandt(440.0, 446.0, 1000.0, 680.0, None, -0.02, 0.001, -5e-4, 2e-5)
ROUND = FTheta(1.0, 1.0, 649.0, 486.0, None, 339.749, -31.988, 48.275, -7.201)
SIZES = {WIDE: (1920, 1080), RATIONAL: (1280, 800), FISHEYE: (2000, 1400), ROUND: (1280, 966)}

OPENCV = [
    (WIDE, (0.427, 0.308), (1337.334144184, 799.705196847)),
    (WIDE, (-0.3, -0.446), (702.727556749, 140.425175789)),
    (WIDE, (0.699, 0.152), (1548.334561338, 657.771213156)),
    (WIDE, (0.482, -0.108), (1387.801769874, 435.211689984)),
    (RATIONAL, (0.247, -0.439), (780.522355716, 149.459579053)),
    (RATIONAL, (-0.32, 0.38), (458.007948583, 616.820360628)),
    (RATIONAL, (0.554, 0.372), (940.520405771, 602.245643974)),
    (FISHEYE, (-0.805, 3.492), (875.891868898, 1225.708568151)),
    (FISHEYE, (-2.079, 1.931), (614.621983469, 1042.824749294)),
    (FISHEYE, (1.474, -0.289), (1416.62301073, 597.200866003)),
    (FISHEYE, (1.083, -0.988), (1310.185931662, 393.164588234)),
]
"""Lens, a point one metre ahead (right, down), and its image: of OpenCV 4.11, `projectPoints` and
`fisheye.projectPoints` with the coefficients in their order."""


@pytest.mark.parametrize(("lens", "point", "image"), OPENCV)
def test_points_fall_where_opencv_has_them(lens, point, image):
    right, down = lens.project(np.array(1.0), np.array(-point[0]), np.array(-point[1]))
    assert (float(right), float(down)) == pytest.approx(image, abs=1e-6)


@pytest.mark.parametrize("lens", [WIDE, RATIONAL, FISHEYE, ROUND])
def test_places_in_the_picture_come_back(lens):
    width, height = SIZES[lens]
    camera = pe.Camera("mine", width, height, lens=lens)
    rng = np.random.default_rng(3)
    right, down = rng.uniform(0, width, 500), rng.uniform(0, height, 500)
    directions = camera.lens.unproject(right, down)
    seen = ~np.isnan(directions[:, 0])
    assert seen.mean() > 0.6
    np.testing.assert_allclose((directions[seen] ** 2).sum(axis=1), 1.0, atol=1e-12)
    again = camera.lens.project(*directions[seen].T)
    np.testing.assert_allclose(again, (right[seen], down[seen]), atol=1e-6)


@pytest.mark.parametrize("lens", [WIDE, RATIONAL, FISHEYE, ROUND])
def test_pixels_a_steradian_are_the_projection_s_derivative(lens):
    rng = np.random.default_rng(4)
    turn, theta = rng.uniform(0, 2 * math.pi, 200), rng.uniform(0.02, 0.7, 200)
    at = np.stack([np.cos(theta), np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn)], 1)
    one = np.cross(at, [0.3, 0.5, 0.7])
    one /= np.linalg.norm(one, axis=1)[:, None]
    steps = []
    for way in (one, np.cross(at, one)):
        ends = [np.array(lens.project(*(at + s * way).T)) for s in (1e-5, -1e-5)]
        steps.append((ends[0] - ends[1]) / 2e-5)
    (a, b), (c, d) = steps
    np.testing.assert_allclose(lens.density(*at.T), np.abs(a * d - b * c), rtol=1e-6)


def test_a_fisheye_sees_behind_its_shoulders():
    camera = pe.Camera("mine", 1280, 966, lens=ROUND)
    assert math.degrees(camera.hfov) == pytest.approx(189.8, abs=0.1)
    assert math.degrees(camera.lens.edge) == pytest.approx(100.0)


def test_a_pinhole_of_an_ideal_camera_is_that_camera():
    ideal = pe.Camera("ideal", 640, 480, math.radians(60.0))
    f = ideal.focal_px
    lens = pe.Camera("lens", 640, 480, lens=Pinhole(f, f, 320.0, 240.0))
    assert lens.projection.is_straight and lens.focal_px == f
    assert (lens.hfov, lens.vfov) == pytest.approx((ideal.hfov, ideal.vfov), abs=1e-12)


KEYS = {"kind": "camera", "width": 640, "height": 480, "fx": 400, "cx": 320, "cy": 240}
BENT = {"model": "brown-conrady"}


REFUSED = [
    ("cx", {"cx": -0.5}),
    ("cx", {"cx": -5}),
    ("cy", {"cy": 481.5}),
    ("fx", {"fx": -400}),
    ("fy", {"fy": 0}),
    ("cx", {"cx": None}),
    ("hfov_deg", {"hfov_deg": 60}),
    ("distortion", {"distortion": 3}),
    ("distortion.model", {"distortion": {"model": "fish"}}),
    ("distortion.k7", {"distortion": BENT | {"k7": 1}}),
    ("distortion.k1", {"distortion": BENT | {"k1": "x"}}),
    ("distortion.coefficients", {"distortion": BENT | {"coefficients": [1, 2, 3]}}),
    (
        "distortion.coefficients",
        {"distortion": {"model": "kannala-brandt", "coefficients": [0] * 5}},
    ),
    ("distortion.coefficients", {"distortion": BENT | {"coefficients": [0] * 4, "k1": 1}}),
    ("distortion.k1", {"distortion": {"model": "f-theta"}}),
    ("distortion", {"distortion": BENT | {"k1": -0.8}}),
    ("fov_deg", {"fov_deg": 230}),
    ("min_range_m", {"min_range_m": 8, "max_range_m": 6}),
    ("max_range_m", {"max_range_m": 0}),
]


def test_impossible_lenses_are_refused():
    assert wrongly_refused(lambda v: pe.catalog.from_table("mine", KEYS | v), REFUSED) == []


def test_a_folding_lens_is_taken_up_to_a_field_of_view():
    table = KEYS | {"distortion": BENT | {"k1": -0.8}, "fov_deg": 60}
    camera = pe.catalog.from_table("mine", table)
    assert math.degrees(camera.hfov) == pytest.approx(60.0)
    assert pe.catalog.to_table(camera) == table | {"fx": 400.0, "fy": 400.0}


def test_listed_coefficients_are_opencv_s():
    listed = KEYS | {"distortion": BENT | {"coefficients": [-0.2, 0.05, 1e-3, -2e-3, 0.01]}}
    named = KEYS | {
        "distortion": BENT | {"k1": -0.2, "k2": 0.05, "p1": 1e-3, "p2": -2e-3, "k3": 0.01}
    }
    one, other = (pe.catalog.from_table("mine", t) for t in (listed, named))
    assert one.lens == other.lens


@pytest.mark.parametrize("lens", [WIDE, RATIONAL, FISHEYE, ROUND])
def test_the_axis_falls_on_the_principal_point(lens):
    lens, none = pe.Camera("mine", *SIZES[lens], lens=lens).projection, np.zeros(1)
    right, down = lens.project(np.ones(1), none, none)
    assert (right[0], down[0]) == pytest.approx((lens.cx, lens.cy), abs=1e-9)
    direction = lens.unproject(np.array([lens.cx]), np.array([lens.cy]))[0]
    assert direction == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)


def test_the_outline_of_a_picture_goes_round_its_border_and_where_it_is_dark_round_the_field():
    """A circle of 70 px in 480 x 270: corners see nothing, and have the direction of the edge."""
    edge = math.radians(50.0)
    lens = KannalaBrandt(70.0, 72.0, 250.0, 150.0, 2.0 * edge, -0.02, 0.001)
    outline = field_outline(lens, 480, 270, 4)
    share = np.arange(4) / 4
    right = np.concatenate([share, np.ones(4), 1.0 - share, np.zeros(4)]) * 480
    down = np.concatenate([np.zeros(4), share, np.ones(4), 1.0 - share]) * 270
    x, y = (right - 250.0) / 70.0, (down - 150.0) / 72.0
    away = np.hypot(x, y)
    assert (away > lens.radius(np.array(edge))).all()
    aside = np.stack([-x / away, -y / away], 1) * math.sin(edge)
    np.testing.assert_allclose(outline[:, 0], math.cos(edge), atol=1e-12)
    np.testing.assert_allclose(outline[:, 1:], aside, atol=1e-12)
    wide = pe.Camera("mine", 1920, 1080, lens=WIDE).projection
    whole = wide.project(*field_outline(wide, 1920, 1080, 4).T)
    np.testing.assert_allclose(whole, (right * 4, down * 4), atol=1e-6)


def test_a_lens_folds_where_its_radius_is_largest():
    """r (1 + k1 r^2) is largest at r = 1 / sqrt(-3 k1); angles are tried in 1100 equal steps."""
    lens = BrownConrady(400.0, 400.0, 320.0, 240.0, k1=-0.8)
    step = lens.edge / RINGS
    folds = math.atan(1.0 / math.sqrt(2.4))
    assert fold_angle(lens) == pytest.approx(math.floor(folds / step) * step, abs=1e-12)
    assert fold_angle(FTheta(1.0, 1.0, 320.0, 240.0, None, -300.0)) == 0.0
    assert fold_angle(FISHEYE) == FISHEYE.edge


@pytest.mark.parametrize("lens", [WIDE, RATIONAL, FISHEYE, ROUND])
def test_tables_of_a_lens_are_the_lens(lens):
    """Image and density to parts in ten thousand, without bias; the stretch bounds what is near."""
    width, height = SIZES[lens]
    quick = QuickLens(pe.Camera("mine", width, height, lens=lens))
    rng = np.random.default_rng(5)
    theta = rng.uniform(0.05, min(quick.outer, 1.2), 4000)
    turn = rng.uniform(0, 2 * math.pi, 4000)
    axes = np.cos(theta), np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn)
    narrow = [part.astype(np.float32) for part in axes]
    seen = quick.seen(narrow[0], *narrow, np.float32(1.0))
    right, down = lens.project(*axes)
    away = np.hypot(right - lens.cx, down - lens.cy)
    np.testing.assert_allclose(seen.right, right, atol=4e-4 * away.max())
    np.testing.assert_allclose(seen.down, down, atol=4e-4 * away.max())
    np.testing.assert_allclose(seen.density, lens.density(*axes), rtol=4e-4)
    found = np.hypot(seen.right - lens.cx, seen.down - lens.cy)
    assert abs(np.mean(found / away - 1.0)) < 2e-6
    grid = np.linspace(1e-3, min(quick.outer + BEYOND, lens.edge), 3000)
    pixels = np.maximum(lens.radius(grid) / np.sin(grid), lens.slope(grid)) * max(lens.fx, lens.fy)
    most = np.maximum.accumulate(pixels)
    bound = np.interp(theta + NEAREST_RAD, grid, most)
    assert (seen.stretch >= bound).all() and (seen.stretch <= 1.12 * bound).all()


OFF_CENTRE = Pinhole(400.0, 400.0, 300.0, 200.0)


def test_an_off_centre_picture_s_fields_of_view_are_sums_of_two_angles():
    camera = pe.Camera("mine", 640, 480, lens=OFF_CENTRE)
    assert camera.hfov == pytest.approx(math.atan(300 / 400) + math.atan(340 / 400), abs=1e-12)
    assert camera.vfov == pytest.approx(math.atan(200 / 400) + math.atan(280 / 400), abs=1e-12)


def test_distances_to_the_sides_of_an_off_centre_frustum():
    """4 m ahead, in the middle, to the left, to the right, and below; at each the nearest side."""
    camera = pe.Camera("mine", 640, 480, lens=OFF_CENTRE)
    left, up = np.array([0.0, 2.0, -3.0, 0.0]), np.array([0.0, 0.0, 0.0, -2.0])
    found = frustum_distance(camera, np.full(4, 4.0), left, up)
    top = 200 * 4 / math.hypot(200, 400)
    bottom = (280 * 4 - 400 * 2) / math.hypot(280, 400)
    sides = (300 * 4 - 400 * 2) / 500, (340 * 4 - 400 * 3) / math.hypot(340, 400)
    assert found == pytest.approx([top, *sides, bottom])
