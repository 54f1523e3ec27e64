"""Lenses: projections as OpenCV has them, and areas held to dense rays."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors import kind_of
from pe_core.sensors.camera.definition import axes_of, bent_pixel_area, frustum_distance
from pe_core.sensors.camera.lens import (
    RINGS,
    BrownConrady,
    FTheta,
    KannalaBrandt,
    Pinhole,
    field_outline,
    fold_angle,
)
from pe_core.sensors.camera.model import picture_rays
from pe_core.sensors.camera.sample_areas import BEYOND, NEAREST_RAD, QuickLens, bent_pixel_areas
from tests.engine import shapes
from tests.engine.refusals import wrongly_refused

WIDE = BrownConrady(930.5, 932.25, 965.0, 530.0, k1=-0.25, k2=0.12, p1=1e-3, p2=-2e-3, k3=-0.02)
RATIONAL = BrownConrady(
    fx=610.0,
    fy=612.0,
    cx=640.0,
    cy=400.0,
    fov=None,
    k1=0.3,
    k2=0.05,
    p1=-5e-4,
    p2=4e-4,
    k3=0.01,
    k4=0.6,
    k5=0.1,
    k6=0.005,
)
FISHEYE = KannalaBrandt(
    fx=440.0, fy=446.0, cx=1000.0, cy=680.0, fov=None, k1=-0.02, k2=0.001, k3=-5e-4, k4=2e-5
)
ROUND = FTheta(
    fx=1.0, fy=1.0, cx=649.0, cy=486.0, fov=None, k1=339.749, k2=-31.988, k3=48.275, k4=-7.201
)
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
OFF_CENTRE = Pinhole(400.0, 400.0, 300.0, 200.0)
RAYS = 1
"""Along a side of a pixel."""
SMALL = {
    "brown": BrownConrady(
        232.0, 232.0, 240.0, 135.0, k1=-0.25, k2=0.12, p1=1e-3, p2=-2e-3, k3=-0.02
    ),
    "fisheye": KannalaBrandt(fx=110.0, fy=112.0, cx=250.0, cy=150.0, fov=None, k1=-0.02, k2=0.001),
    "circle": KannalaBrandt(
        fx=70.0, fy=70.0, cx=250.0, cy=150.0, fov=math.radians(190.0), k1=-0.02, k2=0.001
    ),
    "f-theta": FTheta(
        fx=1.0, fy=1.0, cx=240.0, cy=135.0, fov=None, k1=127.0, k2=-12.0, k3=18.0, k4=-2.7
    ),
}
POSE = pe.Pose.from_degrees((2.1, 0.3, 1.1), (3.0, 20.0, 50.0))
CAR = shapes.box_car()
SPACE = pe.PerceptionSpace((-5, 6), (-4, 4), (0, 2), 0.25)
CATALOGUE = ("WoodScape surround view", "PandaSet front", "PandaSet wide")
OFF = 0.005
CUT_OFF = 0.001
"""How far areas may be off: of themselves, and of a face on the lens's axis where they are cut."""


@pytest.mark.parametrize(("lens", "point", "image"), OPENCV)
def test_points_fall_where_opencv_has_them(lens, point, image):
    right, down = lens.project(np.array(1.0), np.array(-point[0]), np.array(-point[1]))
    assert (float(right), float(down)) == pytest.approx(image, abs=1e-6)


@pytest.mark.parametrize("lens", [WIDE, RATIONAL, FISHEYE, ROUND])
def test_places_in_the_picture_come_back(lens):
    width, height = SIZES[lens]
    camera = pe.Camera("mine", width, height, lens=lens)
    rng = np.random.default_rng(3)
    right = rng.uniform(0, width, 500)
    down = rng.uniform(0, height, 500)
    directions = camera.lens.unproject(right, down)
    seen = ~np.isnan(directions[:, 0])
    assert seen.mean() > 0.6
    np.testing.assert_allclose((directions[seen] ** 2).sum(axis=1), 1.0, atol=1e-12)
    again = camera.lens.project(*directions[seen].T)
    np.testing.assert_allclose(again, (right[seen], down[seen]), atol=1e-6)


def test_rays_through_a_bent_picture_are_those_of_a_raster_of_it():
    camera = pe.Camera("mine", *SIZES[RATIONAL], lens=RATIONAL)
    sensor = pe.Sensor("eye", camera, pe.Pose((1.0, 2.0, 3.0), (0.1, 0.2, -2.0)))
    rays = kind_of(sensor).rays(sensor, 160) @ sensor.pose.ground_from_sensor
    assert len(rays) == 160  # 16 x 10 fields of 80 px
    places = np.round(np.transpose(camera.lens.project(*rays.T)), 6)
    raster = {(x, y) for x in range(40, 1280, 80) for y in range(40, 800, 80)}
    assert {tuple(place) for place in places.tolist()} == raster


@pytest.mark.parametrize("lens", [WIDE, RATIONAL, FISHEYE, ROUND])
def test_pixels_a_steradian_are_the_projection_s_derivative(lens):
    rng = np.random.default_rng(4)
    turn = rng.uniform(0, 2 * math.pi, 200)
    theta = rng.uniform(0.02, 0.7, 200)
    at = np.stack([np.cos(theta), np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn)], 1)
    one = np.cross(at, [0.3, 0.5, 0.7])
    one /= np.linalg.norm(one, axis=1)[:, None]
    steps = []
    for way in (one, np.cross(at, one)):
        ends = [np.array(lens.project(*(at + s * way).T)) for s in (1e-5, -1e-5)]
        steps.append((ends[0] - ends[1]) / 2e-5)
    (a, b), (c, d) = steps
    np.testing.assert_allclose(lens.density(*at.T), np.abs(a * d - b * c), rtol=1e-6)


def test_a_pinhole_of_an_ideal_camera_is_that_camera():
    ideal = pe.Camera("ideal", 640, 480, math.radians(60.0))
    f = ideal.focal_px
    lens = pe.Camera("lens", 640, 480, lens=Pinhole(f, f, 320.0, 240.0))
    assert lens.projection.is_straight and lens.focal_px == f
    assert (lens.hfov, lens.vfov) == pytest.approx((ideal.hfov, ideal.vfov), abs=1e-12)
    through_lens, through_pinhole = (
        picture_rays(pe.Sensor("s", camera), 100) for camera in (lens, ideal)
    )
    np.testing.assert_allclose(through_lens, through_pinhole, atol=1e-12)


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


def test_the_outline_of_a_picture_goes_round_its_border_and_where_it_is_dark_round_the_field():
    """A circle of 70 px in 480 x 270: corners see nothing, and have the direction of the edge."""
    edge = math.radians(50.0)
    lens = KannalaBrandt(fx=70.0, fy=72.0, cx=250.0, cy=150.0, fov=2.0 * edge, k1=-0.02, k2=0.001)
    outline = field_outline(lens, 480, 270, 4)
    share = np.arange(4) / 4
    right = np.concatenate([share, np.ones(4), 1.0 - share, np.zeros(4)]) * 480
    down = np.concatenate([np.zeros(4), share, np.ones(4), 1.0 - share]) * 270
    x = (right - 250.0) / 70.0
    y = (down - 150.0) / 72.0
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
    assert fold_angle(FTheta(fx=1.0, fy=1.0, cx=320.0, cy=240.0, fov=None, k1=-300.0)) == 0.0
    assert fold_angle(FISHEYE) == FISHEYE.edge


@pytest.mark.parametrize("lens", [WIDE, RATIONAL, FISHEYE, ROUND])
def test_tables_of_a_lens_are_the_lens(lens):
    """Image and density to parts in ten thousand, without bias; the stretch bounds what is near."""
    width, height = SIZES[lens]
    quick = QuickLens(pe.Camera("mine", width, height, lens=lens))
    rng = np.random.default_rng(5)
    theta = rng.uniform(0.05, min(quick.outer, 1.2), 4000)
    turn = rng.uniform(0, 2 * math.pi, 4000)
    forward = np.cos(theta)
    left = np.sin(theta) * np.cos(turn)
    up = np.sin(theta) * np.sin(turn)
    x, y, z = (part.astype(np.float32) for part in (forward, left, up))
    seen = quick.seen(x, x, y, z, np.float32(1.0))
    right, down = lens.project(forward, left, up)
    away = np.hypot(right - lens.cx, down - lens.cy)
    np.testing.assert_allclose(seen.right, right, atol=4e-4 * away.max())
    np.testing.assert_allclose(seen.down, down, atol=4e-4 * away.max())
    np.testing.assert_allclose(seen.density, lens.density(forward, left, up), rtol=4e-4)
    found = np.hypot(seen.right - lens.cx, seen.down - lens.cy)
    assert abs(np.mean(found / away - 1.0)) < 2e-6
    grid = np.linspace(1e-3, min(quick.outer + BEYOND, lens.edge), 3000)
    pixels = np.maximum(lens.radius(grid) / np.sin(grid), lens.slope(grid)) * max(lens.fx, lens.fy)
    most = np.maximum.accumulate(pixels)
    bound = np.interp(theta + NEAREST_RAD, grid, most)
    assert (seen.stretch >= bound).all() and (seen.stretch <= 1.12 * bound).all()


def test_an_off_centre_picture_s_fields_of_view_are_sums_of_two_angles():
    camera = pe.Camera("mine", 640, 480, lens=OFF_CENTRE)
    assert camera.hfov == pytest.approx(math.atan(300 / 400) + math.atan(340 / 400), abs=1e-12)
    assert camera.vfov == pytest.approx(math.atan(200 / 400) + math.atan(280 / 400), abs=1e-12)


def test_distances_to_the_sides_of_an_off_centre_frustum():
    """4 m ahead, in the middle, to the left, to the right, and below; at each the nearest side."""
    camera = pe.Camera("mine", 640, 480, lens=OFF_CENTRE)
    left = np.array([0.0, 2.0, -3.0, 0.0])
    up = np.array([0.0, 0.0, 0.0, -2.0])
    found = frustum_distance(camera, np.full(4, 4.0), left, up)
    top = 200 * 4 / math.hypot(200, 400)
    bottom = (280 * 4 - 400 * 2) / math.hypot(280, 400)
    sides = (300 * 4 - 400 * 2) / 500, (340 * 4 - 400 * 3) / math.hypot(340, 400)
    assert found == pytest.approx([top, *sides, bottom])


def camera(lens, scale=1.0, **options):
    return pe.Camera("mine", round(480 * scale), round(270 * scale), lens=lens, **options)


def by_rays(model, offsets, side):
    """Pixels of cubes by rays through RAYS x RAYS places of every pixel."""
    u, v = (np.arange(n * RAYS) + 0.5 for n in (model.width, model.height))
    places = [w.ravel() / RAYS for w in np.meshgrid(u, v)]
    rays = model.projection.unproject(*places)
    rays = rays[~np.isnan(rays[:, 0])]
    found = []
    for offset in offsets:
        least = math.cos(math.asin(min(1.0, side * 0.87 / np.linalg.norm(offset))))
        near = rays[rays @ offset >= least * np.linalg.norm(offset)]
        t0 = (offset - side / 2) / near
        t1 = (offset + side / 2) / near
        enter = np.minimum(t0, t1).max(axis=1)
        leave = np.maximum(t0, t1).min(axis=1)
        found.append(np.count_nonzero((enter < leave) & (leave > 0.0)))
    return np.array(found) / RAYS**2


@pytest.mark.parametrize("lens", SMALL)
def test_areas_are_those_of_dense_rays(lens):
    """Within 2 % of a cube from two sides on, cut or not, and 0.3 % of all: rays miss as much."""
    model = camera(SMALL[lens])
    rng = np.random.default_rng(8)
    way = rng.normal(size=(8, 3))
    way[:, 0] = np.abs(way[:, 0]) + 0.5
    offsets = way / np.linalg.norm(way, axis=1)[:, None] * rng.uniform(2.0, 5.0, (8, 1))
    area = bent_pixel_area(model, np.eye(3), offsets, 1.0)
    rays = by_rays(model, offsets, 1.0)
    seen = rays > 600.0
    assert np.count_nonzero(seen) > 3
    np.testing.assert_allclose(area[seen], rays[seen], rtol=0.02)
    assert area.sum() == pytest.approx(rays.sum(), rel=0.003)


def test_a_lens_that_bends_nothing_is_a_pinhole():
    straight = Pinhole(232.0, 240.0, 250.0, 120.0)
    bent = Pinhole(fx=232.0, fy=240.0, cx=250.0, cy=120.0, fov=math.radians(150.0))
    index = np.stack(np.unravel_index(np.arange(SPACE.size), SPACE.shape), axis=1)
    centers = SPACE.center_of(index)
    one, other = (
        pe.measure(pe.Sensor("eye", camera(lens), POSE), centers, SPACE.interval, CAR)
        for lens in (straight, bent)
    )
    ahead = one > 0.0  # the pinhole leaves out what a corner of is behind
    assert np.count_nonzero(ahead) > 300
    np.testing.assert_allclose(other[ahead], one[ahead], rtol=1e-6, atol=1e-4)


def by_patches(model, axes, offset, side, count=100):
    """Pixels of a cube by its sides in count x count patches, each as its projected corners.

    A patch counts where its middle is in the picture and in the field.
    """
    lens = model.projection
    ends = np.linspace(-0.5, 0.5, count + 1) * side
    found = 0.0
    for axis in np.flatnonzero(np.abs(offset) > side / 2.0):
        a, b = np.meshgrid(ends, ends, indexing="ij")
        points = np.empty((*a.shape, 3))
        points[..., axis] = offset[axis] - np.sign(offset[axis]) * side / 2.0
        points[..., (axis + 1) % 3] = offset[(axis + 1) % 3] + a
        points[..., (axis + 2) % 3] = offset[(axis + 2) % 3] + b
        corners = points @ axes
        x, y = lens.project(*np.moveaxis(corners, -1, 0))
        across = (x[1:, 1:] - x[:-1, :-1], y[1:, 1:] - y[:-1, :-1])
        other = (x[:-1, 1:] - x[1:, :-1], y[:-1, 1:] - y[1:, :-1])
        areas = np.abs(across[0] * other[1] - across[1] * other[0]) / 2.0
        middle = (corners[1:, 1:] + corners[:-1, :-1]) / 2.0
        u, v = lens.project(*np.moveaxis(middle, -1, 0))
        theta = np.arctan2(np.hypot(middle[..., 1], middle[..., 2]), middle[..., 0])
        seen = (theta < lens.edge) & (u > 0) & (u < model.width) & (v > 0) & (v < model.height)
        found += float(areas[seen].sum())
    return found


def around_the_edge(lens, side, rng):
    """Directions (24, 3) to cubes 1 m away: in the field, on and across its edge, level by it.

    Where the picture ends before the field does, as far from the axis as its corner.
    """
    corner = float(lens.unproject(np.zeros(1), np.zeros(1))[0, 0])
    edge = lens.edge if math.isnan(corner) else math.acos(corner)
    inside = rng.uniform(0.0, edge, 6)
    across = edge + rng.uniform(-1.5, 0.7, 6) * side
    level = edge - np.linspace(0.01, 0.25, 12)
    theta = np.r_[inside, across, level]
    turn = np.r_[rng.uniform(0.0, 2.0 * math.pi, 12), np.tile([0.0, math.pi], 6)]
    aside = np.sin(theta)
    return np.stack([np.cos(theta), aside * np.cos(turn), aside * np.sin(turn)], axis=1)


@pytest.mark.parametrize("name", CATALOGUE)
@pytest.mark.parametrize("away", [1.5, 6.0, 15.1, 30.0])
def test_areas_keep_to_the_tolerance_that_the_page_states(name, away):
    """Definition and sample, in the field and across its edge, near a fold as well."""
    model = pe.catalog.load(name)
    rng = np.random.default_rng(int(away))
    pose = pe.Pose.from_degrees((0.0, 0.0, 0.0), rng.uniform(-180.0, 180.0, 3))
    axes = axes_of(pose)
    side = 1.0 / away
    offsets = around_the_edge(model.projection, side, rng) @ axes.T
    exact = np.array([by_patches(model, axes, offset, side) for offset in offsets])
    defined = bent_pixel_area(model, axes, offsets, side)
    sampled = bent_pixel_areas(model, pose, offsets, side, seen=None)
    assert np.count_nonzero(exact) >= 3
    lens = model.projection
    face = lens.fx * lens.fy * float(lens.slope(np.array(1e-6))) ** 2 * side**2
    for found in (defined, sampled):
        np.testing.assert_allclose(found, exact, rtol=OFF, atol=CUT_OFF * face)
