"""The definition of m on objects against an oracle that shares no code with it."""

import math
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_core import sensors as kinds
from tests.engine import object_oracle, shapes
from tests.engine.test_oracle import LIDARS, azimuths_of, random_pose
from tests.thorough import pairs, tries

ROOT = Path(__file__).parents[2]
SIZES = np.array([(4.6, 1.9, 1.7), (0.8, 0.7, 1.75), (1.76, 0.65, 1.74), (7.5, 2.55, 3.0)])
VIEWS = {
    "free": (False, False),
    "traffic": (False, True),
    "car": (True, False),
    "both": (True, True),
}
WIDE_LENSES = {
    "fisheye 190": pe.KannalaBrandt(100.0, 100.0, 200.0, 150.0, fov=math.radians(190.0)),
    "fisheye 150": pe.KannalaBrandt(130.0, 130.0, 200.0, 150.0, fov=math.radians(150.0)),
    "pinhole 140": None,
}
CAR = shapes.box_car()
BODIES = np.array([(4.6, 1.9, 1.7), (0.5, 0.35, 1.7), (0.1, 0.1, 2.0), (3.0, 0.05, 0.05)])


def random_objects(rng, count=12, per_scene=6, nearest=7.2, farthest=14.0):
    """Boxes about the origin, none of which reaches a sensor; they may overlap."""
    turn = rng.uniform(-math.pi, math.pi, count)
    away = rng.uniform(nearest, farthest, count)
    labels = rng.integers(0, len(SIZES), count)
    sizes = SIZES[labels] * rng.uniform(0.8, 1.2, (count, 1))
    centers = np.stack([away * np.cos(turn), away * np.sin(turn), sizes[:, 2] / 2.0], axis=1)
    yaws = rng.uniform(-math.pi, math.pi, count)
    scenes = np.arange(count) // per_scene
    return pe.Objects(
        centers, sizes, yaws, labels, class_names=tuple("abcd"), scenes=rng.permutation(scenes)
    )


@pytest.mark.parametrize(("kind", "view"), pairs(LIDARS, VIEWS))
def test_beams_equal_brute_force(kind, view):
    rng = np.random.default_rng([sorted(LIDARS).index(kind), sorted(VIEWS).index(view)])
    on_car, traffic = VIEWS[view]
    vehicle = shapes.box_car() if on_car else None
    lidar = shapes.small_lidar(12, 120, **LIDARS[kind] | options(kind))
    met = 0
    for steep in (True, False):
        sensor = pe.Sensor("s", lidar, random_pose(rng, steep))
        some = random_objects(rng)
        counted = pe.measure_objects(sensor, some, vehicle, traffic)
        expected = object_oracle.beams(sensor, azimuths_of(lidar), some, vehicle, traffic=traffic)
        assert counted.tolist() == expected.tolist()
        met += np.count_nonzero(counted)
    assert met > 2


def options(kind):
    """What else a LiDAR of the oracle's test has here."""
    if kind == "offsets":
        return {"azimuth_offsets": np.radians(np.linspace(-5, 5, 12))}
    return {"min_range": 5.0, "max_range": 11.0} if kind == "short" else {}


def small_camera(hfov_deg, width=150, height=100):
    return pe.Camera("small", width, height, math.radians(hfov_deg))


def fisheye():
    return pe.Camera(
        "fish", width=150, height=136, hfov=None, lens=pe.KannalaBrandt(45.0, 45.0, 75.0, 68.0)
    )


CAMERAS = {"60 deg": small_camera(60.0), "120 deg": small_camera(120.0), "fisheye": fisheye()}


def rays_of(camera):
    if camera.lens is None:
        return object_oracle.pinhole_rays(camera)
    return object_oracle.equidistant_rays(camera.lens, math.radians(100.0))


@pytest.mark.parametrize(("name", "view"), pairs(CAMERAS, VIEWS))
def test_pixels_are_those_of_dense_rays(name, view):
    """Within what counting pixels leaves open, and 4 % of what would be seen if nothing hid it."""
    rng = np.random.default_rng([sorted(CAMERAS).index(name), sorted(VIEWS).index(view)])
    on_car, traffic = VIEWS[view]
    camera = CAMERAS[name]
    vehicle = shapes.box_car() if on_car else None
    seen = 0
    for _ in range(2):
        pose = pe.Pose.from_degrees(
            rng.uniform((-2.5, -1.2, 1.6), (2.5, 1.2, 2.3)), rng.uniform(-1, 1, 3) * (15, 15, 180)
        )
        sensor = pe.Sensor("s", camera, pose)
        some = random_objects(rng)
        m, whole = (
            pe.measure_objects(sensor, some, v, t) for v, t in ((vehicle, traffic), (None, False))
        )
        counted = object_oracle.pixels(
            sensor, rays_of(camera), finer=1, objects=some, vehicle=vehicle, traffic=traffic
        )
        hidden = 0.04 * whole if on_car or traffic else 0.0
        open_ = 1.5 + 0.6 * np.sqrt(whole)
        assert (np.abs(m - counted) <= open_ + hidden).all()
        seen += np.count_nonzero(m)
    assert seen > 2


def near_a_car(rng):
    """A pose close to a side of the car, that looks away from it or along it."""
    at = rng.uniform(-1.0, 1.0, 2) * (2.2, 0.9)
    side = rng.choice([-1.0, 1.0])
    end = rng.random() < 0.4
    x, y = (side * rng.uniform(2.35, 2.6), at[1]) if end else (at[0], side * rng.uniform(1.0, 1.2))
    yaw = math.degrees(math.atan2(*((0.0, x) if end else (y, 0.0)))) + rng.uniform(-110, 110)
    turned = (rng.uniform(-30, 30), rng.uniform(-20, 60), yaw)
    return pe.Pose.from_degrees((x, y, rng.uniform(0.4, 1.6)), turned)


@pytest.mark.parametrize("name", WIDE_LENSES)
def test_bodies_near_a_wide_camera_on_a_car(name):
    """Images that fill little of their bounding rectangle, too, are seen within 4 %."""
    rng = np.random.default_rng(7)
    lens = WIDE_LENSES[name]
    worst = 0.0
    partly = 0
    hfov = math.radians(140.0) if lens is None else None
    camera = pe.Camera(name, width=400, height=300, hfov=hfov, lens=lens)
    rays = rays_of(camera)
    if lens is not None:
        rays = object_oracle.equidistant_rays(lens, lens.fov / 2.0)
    for _ in range(tries(7, 30)):
        sensor = pe.Sensor("s", camera, near_a_car(rng))
        labels = rng.integers(0, len(BODIES), 5)
        turn = rng.uniform(-math.pi, math.pi, 5)
        sizes = BODIES[labels]
        away = rng.exponential(2.0, 5) + 0.4 + sizes[:, 0] / 2.0
        x, y, _ = sensor.pose.position
        centers = np.stack([x + away * np.cos(turn), y + away * np.sin(turn), sizes[:, 2] / 2], 1)
        some = pe.Objects(
            centers, sizes, 3.0 * turn, labels, class_names=tuple("abcd"), scenes=np.zeros(5, int)
        )
        whole = pe.measure_objects(sensor, some, None, False)
        shares = object_oracle.visible_shares(sensor, rays, some, CAR)
        for expected, traffic in zip(shares, (False, True), strict=True):
            m = pe.measure_objects(sensor, some, CAR, traffic)
            known = np.flatnonzero((whole > 0.0) & ~np.isnan(expected))
            off = np.abs(m[known] / whole[known] - expected[known])
            worst = max(worst, off.max(initial=0.0))
            partly += np.count_nonzero((expected[known] > 0.0) & (expected[known] < 1.0))
    assert worst <= 0.04
    assert partly > 2


def test_a_cyclist_at_the_edge_of_a_bus_s_fisheye():
    """5 of 144 rays over the bounding rectangle would meet it, and one of 4 be visible."""
    body = np.load(ROOT / "blend_assets" / "bus.npz")["triangles"]
    lens = pe.KannalaBrandt(330.0, 330.0, 640.0, 480.0, fov=math.radians(190.0))
    pose = pe.Pose.from_degrees((-3.084, 0.018, 0.939), (0.69, 22.74, 177.09))
    eye = pe.Sensor("eye", pe.Camera("fisheye", 1280, 960, lens=lens), pose)
    cyclist = pe.Objects(
        [[-2.67, -1.91, 0.85]], [[0.5, 0.35, 1.7]], [math.radians(90)], [0], class_names=["cyclist"]
    )
    near = np.linalg.norm(body.mean(axis=1) - pose.position, axis=1) < 4.0
    whole = pe.measure_objects(eye, cyclist)[0]
    assert whole == pytest.approx(4655.0, rel=0.005)
    rays = object_oracle.equidistant_rays(lens, math.radians(95.0))
    bus = pe.Vehicle(body)
    (share,), _ = object_oracle.visible_shares(
        eye, rays, cyclist, pe.Vehicle(body[near]), want=4000
    )
    assert share == pytest.approx(303.0 / 4655.0, abs=0.005)
    kernel = kinds.kind_of(eye).on_objects(kinds.ObjectView(cyclist, bus, False))
    for m in (pe.measure_objects(eye, cyclist, bus)[0], kernel.measure(eye)[0]):
        assert m == pytest.approx(share * whole, abs=0.04 * whole)


@pytest.mark.parametrize("name", ["60 deg", "120 deg"])
def test_areas_through_a_pinhole_equal_the_clipped_hull(name):
    rng = np.random.default_rng(5)
    camera = CAMERAS[name]
    some = random_objects(rng, 120, farthest=40.0)
    for yaw in (0.0, 100.0, 200.0):
        sensor = pe.Sensor("s", camera, pe.Pose.from_degrees((0.3, 0.1, 1.5), (7.0, -4.0, yaw)))
        m = pe.measure_objects(sensor, some)
        hull = [object_oracle.hull_area(sensor, some, item) for item in range(len(some))]
        front = np.array([area is not None for area in hull])
        expected = [area for area in hull if area is not None]
        np.testing.assert_allclose(m[front], expected, rtol=1e-6, atol=1e-4)
        assert np.count_nonzero(expected) > 10
        assert not front.all()


def test_what_reaches_behind_a_camera_is_seen_in_front_of_it():
    """A lorry beside the camera: through a pinhole what is in front is a wall to its left."""
    lorry = pe.Objects([[0.0, 3.0, 1.5]], [[12.0, 2.5, 3.0]], [0.0], [0], class_names=("lorry",))
    sensor = pe.Sensor("s", small_camera(90.0, 300, 200), pe.Pose((0.0, 0.0, 1.5)))
    (dense,) = object_oracle.pixels(
        sensor, rays_of(sensor.model), finer=2, objects=lorry, vehicle=None, traffic=False
    )
    assert pe.measure_objects(sensor, lorry)[0] == pytest.approx(dense, rel=0.01)
    assert dense > 5000
    behind = sensor.moved(pe.Pose.from_degrees((0.0, 0.0, 1.5), (0.0, 0.0, 180.0)))
    assert pe.measure_objects(behind, lorry)[0] == pytest.approx(dense, rel=0.01)


def test_a_wall_right_behind_a_fisheye_shows_beyond_its_shoulders():
    """The outline of what is right behind goes round the whole picture."""
    wall = pe.Objects([[-0.6, 0.5, 1.0]], [[1.0, 30.0, 20.0]], [0.0], [0], class_names=("wall",))
    sensor = pe.Sensor("s", CAMERAS["fisheye"], pe.Pose((0.0, 0.0, 1.5)))
    (dense,) = object_oracle.pixels(
        sensor, rays_of(sensor.model), finer=2, objects=wall, vehicle=None, traffic=False
    )
    assert pe.measure_objects(sensor, wall)[0] == pytest.approx(dense, rel=0.05)
    assert 100 < dense < 30_000


def test_a_sliver_on_a_fisheye_s_edge_is_hidden_by_what_stands_before_it():
    """Of a car 20 m to the left 5 px reach into the field, beside every ray of the lattice."""
    lens = pe.KannalaBrandt(320, 320, 640, 480, fov=math.radians(190.0))
    eye = pe.Sensor("eye", pe.Camera("fisheye", 1280, 960, lens=lens), pe.Pose((0, 0, 1.0)))
    car = pe.Objects([[-3.82, 20.0, 0.75]], [[4.0, 1.8, 1.5]], [0.0], [0], class_names=["car"])
    free = pe.measure_objects(eye, car)
    assert 1.0 < free[0] < 10.0
    for side, expected in ((1.0, 0.0), (-1.0, free[0])):  # the car's side, and the other one
        wall = pe.Vehicle(shapes.box((-3.0, side * 0.55 - 0.05, 0.0), (3.0, side * 0.55, 3.0)))
        assert pe.measure_objects(eye, car, wall)[0] == expected
        kernel = kinds.kind_of(eye).on_objects(kinds.ObjectView(car, wall, False))
        assert kernel.measure(eye)[0] == expected


def test_boxes_behind_a_fisheye_show_nothing():
    """Their outlines go round the direction right behind, or pass it closely."""
    sensor = pe.Sensor("s", CAMERAS["fisheye"], pe.Pose((0.0, 0.0, 1.5)))
    rng = np.random.default_rng(2)
    centers = rng.uniform((-30.0, -1.5, 0.5), (-8.0, 1.5, 2.5), (300, 3))
    count = len(centers)
    sizes = rng.uniform(0.5, 4.0, (count, 3))
    yaws = rng.uniform(-3.0, 3.0, count)
    some = pe.Objects(centers, sizes, yaws, np.zeros(count), class_names=("box",))
    assert pe.measure_objects(sensor, some).tolist() == [0.0] * count
