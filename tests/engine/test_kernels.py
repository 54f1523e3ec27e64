"""Every kernel of every kind of sensor, with and without a vehicle, against the definition."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.sensors import Voxels, kind_of
from pe_core.sensors.lidar import voxel_beams
from pe_core.sensors.lidar.bracket import bracket
from pe_core.sensors.lidar.grid_sweep import MAX_COUNT, BeamGrid
from tests.engine import shapes
from tests.engine.kernels import (
    assert_defined,
    assert_objects_defined,
    every_voxel,
    on_grid,
    on_sample,
)
from tests.engine.test_object_oracle import CAMERAS as SMALL_CAMERAS
from tests.engine.test_object_oracle import VIEWS, random_objects
from tests.thorough import tries

SPACE = pe.PerceptionSpace((-12, 12), (-8, 8), (0, 4), 0.2)
SMALL = pe.PerceptionSpace((-6, 6), (-4, 4), (0, 4), 0.2)
CAR = shapes.box_car()
POSES = {
    "roof": ((-0.43, 0.0, 1.8), (0.0, 0.0, 0.0)),
    "on grid planes": ((0.0, 0.0, 2.0), (0.0, 0.0, 0.0)),
    "turned a quarter": ((0.2, -0.4, 2.0), (0.0, 0.0, 90.0)),
    "turned a little": ((0.537, -0.281, 1.713), (0.0, 0.0, 33.3)),
    "rolled, pitched, yawed": ((0.33, 0.21, 1.77), (10.0, 25.0, 77.0)),
    "on its side": ((0.0, 0.3, 2.0), (90.0, 0.0, 135.0)),
    "looking down": ((0.33, 0.21, 2.77), (0.0, 90.0, 0.0)),
    "looking up": ((3.0, 0.0, 0.1), (0.0, -90.0, 30.0)),
    "on the border": ((12.0, 0.1, 1.1), (0.0, 3.0, 180.0)),
    "behind the space": ((-14.0, 1.0, 1.5), (0.0, 2.0, 0.0)),
    "above the space": ((0.0, 0.0, 6.2), (0.0, 32.0, 0.0)),
    "below the space": ((1.0, 0.5, -0.7), (0.0, -10.0, 20.0)),
}
SCAN = {
    "name": "scan",
    "azimuth_deg": [-50, 0, 50],
    "range_m": [40, 100, 60],
    "elevation_deg": [-15, 0, 15],
    "elevation_scale": [0.5, 1.0, 0.6],
    "azimuth_resolution_deg": 2.0,
    "min_range_m": 1.0,
}
CONE = {"kind": "ultrasonic", "hfov_deg": 60, "vfov_deg": 30, "max_range_m": 2.0}
ELEVATIONS = np.radians(np.linspace(-25.0, 15.0, 20))
SPREAD = np.linspace(-4.0, 4.0, 20)
TILTS = ((0, 3, 0), (0, 90, 0), (90, 0, 0), (180, 0, 0), (0, -30, 90), (0, 1e-7, 0), (1e-4, 0, 45))


def rosette(nearest=0.0):
    """5,000 beams in no order, some straight up, down and back."""
    rng = np.random.default_rng(8)
    beams = rng.normal(size=(5000, 3)) * [1.0, 1.0, 0.5]
    beams[:6] = [[0, 0, 1], [0, 0, -1], [-1, 0, 0], [-1, -1e-17, 0], [1, 0, 0], [0, 1, 0]]
    return pe.Lidar.from_directions("rosette", beams, 40.0, nearest)


def eye(hfov_deg, **options):
    return pe.Camera("eye", 1920, 1080, math.radians(hfov_deg), **options)


def bent(lens, **options):
    return pe.Camera("bent", 480, 270, lens=lens, **options)


MODELS = {
    "regular": shapes.small_lidar(24, 360),
    "offsets": shapes.small_lidar(24, 360, azimuth_offsets=np.radians(np.linspace(-5, 5, 24))),
    "limited": shapes.small_lidar(24, 360, horizontal_fov=tuple(np.radians((-60, 45)))),
    "short": shapes.small_lidar(24, 360, max_range=5.1),
    "not near": shapes.small_lidar(24, 360, min_range=1.5),
    "sector, not near": shapes.small_lidar(horizontal_fov=(-1.0, 2.0), min_range=1.5),
    "short, not near": shapes.small_lidar(max_range=2.0, min_range=0.75),
    "pattern": rosette(),
    "pattern, not near": rosette(1.5),
    "paper": catalog.load("Pandar64"),
    "odd azimuths": shapes.small_lidar(3, 7),
    "few azimuths": shapes.small_lidar(3, 8),
    "one channel": shapes.small_lidar(1, 360),
    "many azimuths": shapes.small_lidar(24, 3600, max_range=9.0),
    "up and down": pe.Lidar("up and down", np.radians([-89.0, 0.0, 90.0]), 36, 60.0),
    "twice the same": pe.Lidar("twice", np.radians([-5.0, -5.0, 0.0, 0.0]), 720, 60.0),
    "narrow camera": eye(40.0),
    "wide camera": eye(110.0),
    "ranged camera": eye(70.0, min_range=1.5, max_range=6.0),
    "off-centre pinhole": bent(pe.Pinhole(232.0, 240.0, 300.0, 60.0)),
    "brown, ranged": bent(
        pe.BrownConrady(232.0, 232.0, 240.0, 135.0, k1=-0.25, k2=0.12, p1=1e-3, p2=-2e-3, k3=-0.02),
        min_range=1.5,
        max_range=6.0,
    ),
    "circle": bent(
        pe.KannalaBrandt(
            fx=70.0, fy=70.0, cx=250.0, cy=150.0, fov=math.radians(190.0), k1=-0.02, k2=0.001
        )
    ),
    "fisheye": bent(
        pe.KannalaBrandt(fx=110.0, fy=112.0, cx=250.0, cy=150.0, fov=None, k1=-0.02, k2=0.001)
    ),
    "f-theta": bent(
        pe.FTheta(
            fx=1.0, fy=1.0, cx=240.0, cy=135.0, fov=None, k1=127.0, k2=-12.0, k3=18.0, k4=-2.7
        )
    ),
    "radar": catalog.from_table("own", {"kind": "radar", "mode": [SCAN], "list_length": 400}),
    "ultrasonic": catalog.from_table("own", CONE),
}


def some_voxels(sensor, space, grid, rng, count):
    """Indices of voxels that are seen, of any voxels, and of voxels round and level with it."""
    seen = np.flatnonzero(grid)
    shape = np.array(space.shape)
    flat = np.concatenate([rng.choice(seen, count), rng.integers(0, space.size, count)])
    index = np.stack(np.unravel_index(flat, space.shape), axis=1)
    here = ((np.array(sensor.pose.position) - space.origin) / space.interval).astype(int)
    near = here + rng.integers(-4, 5, (count // 3, 3))
    level = rng.integers(0, shape, (count // 3, 3))
    level[:, 2] = here[2] + rng.integers(-1, 2, len(level))
    level[::2, 1] = here[1] + rng.integers(-1, 2, len(level[::2]))
    return np.clip(np.concatenate([index, near, level]), 0, shape - 1)


def cases():
    """Each model at a quarter of the poses, each pose with a quarter of the models."""
    for number, model in enumerate(MODELS):
        poses = list(POSES)[number % 4 :: tries(4, 2)]
        yield from ((model, pose) for pose in poses)


@pytest.mark.parametrize(("model", "pose"), list(cases()))
def test_grid_and_sample_equal_the_definition(model, pose):
    """With the car, and without it where a case has an even number."""
    number = list(MODELS).index(model) + list(POSES).index(pose)
    vehicle = CAR if number % 2 else None
    sensor = pe.Sensor("s", MODELS[model], pe.Pose.from_degrees(*POSES[pose]))
    grid = on_grid(sensor, SPACE, vehicle)
    if not grid.any():  # nothing in view: not of a small cone up there
        return
    index = some_voxels(sensor, SPACE, grid, np.random.default_rng(number), count=200)
    assert np.count_nonzero(assert_defined(sensor, SPACE, index, vehicle, grid=grid)) > 100


@pytest.mark.parametrize("seed", range(tries(2, 3)))
def test_a_lidar_anywhere_on_the_vehicle(seed):
    rng = np.random.default_rng(seed)
    place = rng.uniform((-2.5, -1.0, 0.5), (2.5, 1.0, 2.2)).round(2)
    yaw = float(rng.choice([0.0, rng.uniform(-180, 180)]))
    sensor = pe.Sensor("s", MODELS["paper"], pe.Pose.from_degrees(place, (0.0, 0.0, yaw)))
    grid = on_grid(sensor, SPACE, CAR)
    index = some_voxels(sensor, SPACE, grid, rng, count=100)
    expected = assert_defined(sensor, SPACE, index, CAR, grid=grid)
    voxels = Voxels(SPACE, index, SPACE.center_of(index))
    few = kind_of(sensor).on_sample(voxels, CAR, 10).measure(sensor).m
    assert np.minimum(few, 10).tolist() == np.minimum(expected, 10).tolist()


def test_every_voxel_of_the_grid_equals_the_sample():
    """Two kernels that share no method, over all 192,000 voxels."""
    pose = pe.Pose.from_degrees((0.0, 0.0, 1.8), (0, 1.5, 45.0))
    sensor = pe.Sensor("s", MODELS["offsets"], pose)
    sample = on_sample(sensor, SPACE, every_voxel(SPACE).index, CAR)
    assert np.array_equal(sample, on_grid(sensor, SPACE, CAR).reshape(-1))


@pytest.mark.parametrize("model", ["wide camera", "fisheye"])
def test_planes_do_not_depend_on_how_many_are_asked_for(model):
    sensor = pe.Sensor("s", MODELS[model], pe.Pose.from_degrees((0.2, -0.3, 1.6), (4, 5, 30)))
    one, *others = (on_grid(sensor, shapes.small_space(), CAR, run) for run in (1, 7, 80))
    assert all(np.array_equal(one, other) for other in others)


def counts_of(*sensors, space=SMALL):
    """Beams of several LiDARs in one grid."""
    grid = BeamGrid(space)
    for sensor in sensors:
        field = pe.beam_field(sensor, None)
        grid.add(sensor.pose.position, field.directions, field.ends)
    return grid.counts


@pytest.mark.parametrize(
    "positions",
    [
        ((0.1, 0.1, 2.1), (3.1, -1.3, 1.1)),
        ((0.1, 0.1, 2.1), (0.5, 0.1, 2.1), (0.1, 0.3, 1.9)),  # each in the others' thick
        ((-5.99, -3.99, 0.01), (5.99, 3.99, 3.99)),
        ((-7.0, 0.1, 1.0), (0.1, 0.1, 1.1)),  # the first stands outside
    ],
)
def test_several_lidars_add_up_and_hold_at_the_maximum(positions):
    sensors = [
        shapes.lidar_on_roof(position=position, rotation=(0.0, 5.0 * number, 10.0))
        for number, position in enumerate(positions)
    ]
    alone = [counts_of(s).astype(int) for s in sensors]
    assert counts_of(*sensors).tolist() == np.minimum(sum(alone), MAX_COUNT).tolist()
    assert max(counts.max() for counts in alone) == MAX_COUNT


def test_more_beams_one_way_than_a_count_holds():
    """Equal to the same beams added in small portions, and summed without a limit."""
    dense = pe.Lidar("dense", np.radians(np.linspace(-25.0, 15.0, 80)), 3600, 40.0)
    sensor = shapes.lidar_on_roof(dense, (0.1, 0.1, 2.1))
    field = pe.beam_field(sensor, None)
    total = np.zeros(SMALL.shape, int)
    for some in np.array_split(np.arange(len(field.ends)), 5):
        grid = BeamGrid(SMALL)
        grid.add(sensor.pose.position, field.directions[some], field.ends[some])
        total += grid.counts
    assert total.max() == 288_000
    assert counts_of(sensor).tolist() == np.minimum(total, MAX_COUNT).tolist()
    grid.clear()
    assert not grid.counts.any()


def test_a_pattern_of_a_lidar_s_own_beams_is_that_lidar():
    regular = MODELS["regular"]
    pattern = pe.Lidar.from_directions("pattern", regular.directions, regular.max_range)
    pose = pe.Pose.from_degrees((0.13, 0.27, 1.91), (1.0, 2.0, 3.0))
    a, b = (on_grid(pe.Sensor("s", m, pose), SPACE, CAR) for m in (regular, pattern))
    assert np.count_nonzero(a != b) <= a.size // 10_000  # beams differ in their last bit


AT_OBJECTS = {
    "regular": pe.Lidar("regular", ELEVATIONS, 150, 60.0),
    "more than a word": pe.Lidar("tall", np.radians(np.linspace(-30.0, 20.0, 70)), 90, 60.0),
    "fans": pe.Lidar(
        "fans",
        ELEVATIONS,
        azimuth_count=150,
        max_range=60.0,
        azimuth_offsets=np.radians(np.round(SPREAD)),
    ),
    "a fan a channel": pe.Lidar(
        "many", ELEVATIONS, azimuth_count=150, max_range=60.0, azimuth_offsets=np.radians(SPREAD)
    ),
    "limited": pe.Lidar(
        "limited",
        ELEVATIONS,
        azimuth_count=150,
        max_range=60.0,
        azimuth_offsets=None,
        horizontal_fov=(-1.0, 0.8),
    ),
    "ranged": pe.Lidar("ranged", ELEVATIONS, 150, 15.0, min_range=6.0),
    "steep": pe.Lidar("steep", np.radians([-90.0, -80.0, -30.0, 0.0, 89.5]), 60, 60.0),
    "a pattern": pe.Lidar.from_directions(
        "pattern", np.random.default_rng(3).normal((2, 0, -0.2), (1, 1, 0.3), (1500, 3)), 60.0
    ),
    **SMALL_CAMERAS,
    "ranged camera": pe.Camera(
        "ranged",
        width=200,
        height=130,
        hfov=math.radians(60.0),
        lens=None,
        min_range=8.0,
        max_range=20.0,
    ),
    "radar": MODELS["radar"],
    "far radar": catalog.load("Continental ARS408-21"),
    "ultrasonic": catalog.from_table("far", {**CONE, "max_range_m": 15.0, "hfov_deg": 120}),
}


def round_objects(rng):
    """Boxes of round measures at round places along the axes: faces in line with the sensor."""
    some = random_objects(rng, 40, 10, nearest=1.0, farthest=20.0)
    centers, sizes = (np.round(w * 2.0) / 2.0 for w in (some.centers, some.sizes))
    yaws = np.round(some.yaws * 2.0 / math.pi) * math.pi / 2.0
    centers[:, 2] = np.maximum(centers[:, 2], 0.5)
    names = some.class_names
    return pe.Objects(
        centers, np.maximum(sizes, 0.5), yaws, some.labels, class_names=names, scenes=some.scenes
    )


def places(rng):
    """Sensors upright at a free and at a round place, and tilted, and what is round them."""
    free = pe.Pose.from_degrees(rng.uniform((-3, -2, 1.5), (3, 2, 1.7)), (0, 0, 37.3))
    yield free, random_objects(rng, 60, 15, nearest=4.0, farthest=25.0)
    whole = np.round(rng.uniform((-3, -2, 1.6), (3, 2, 2.5)) * 2.0) / 2.0
    yield pe.Pose.from_degrees(whole, (0, 0, 90)), round_objects(rng)
    tilted = pe.Pose.from_degrees((-0.3, 0.1, 1.45), rng.uniform(-1, 1, 3) * (20, 20, 180))
    yield tilted, random_objects(rng, 60, 15, nearest=4.0, farthest=25.0)


@pytest.mark.parametrize("name", AT_OBJECTS)
def test_the_kernel_of_objects_equals_the_definition(name):
    """To the bit, free, in traffic, on a car, and both."""
    rng = np.random.default_rng(sorted(AT_OBJECTS).index(name))
    model = AT_OBJECTS[name]
    totals = np.zeros(len(VIEWS))
    for pose, objects in places(rng):
        sensor = pe.Sensor("s", model, pose)
        totals += [
            assert_objects_defined(sensor, objects, CAR if on_car else None, traffic).sum()
            for on_car, traffic in VIEWS.values()
        ]
    assert totals[0] > totals[3] > 0  # something hides something


@pytest.mark.parametrize("rotation", TILTS)
def test_a_tilted_lidar_at_round_angles_among_round_objects(rotation):
    """Sides then run along planes of channels, or nearly."""
    objects = round_objects(np.random.default_rng(11))
    pose = pe.Pose.from_degrees((0.5, -1.0, 2.0), rotation)
    sensor = pe.Sensor("s", AT_OBJECTS["regular"], pose)
    counts = [assert_objects_defined(sensor, objects, vehicle) for vehicle in (None, CAR)]
    assert np.count_nonzero(counts[1]) > 5


def test_a_sensor_over_and_in_objects_of_a_scene():
    """Such scenes are compared beam by beam, the others are not."""
    some = random_objects(np.random.default_rng(4), 40, 10, nearest=4.0, farthest=25.0)
    centers = some.centers.copy()
    sizes = some.sizes.copy()
    centers[[3, 20]] = (0.0, 0.0, 0.5), (0.1, 0.0, 1.5)
    sizes[[3, 20]] = (4.0, 2.0, 1.0), (1.0, 1.0, 2.0)
    objects = pe.Objects(
        centers, sizes, some.yaws, some.labels, class_names=some.class_names, scenes=some.scenes
    )
    for name in ("regular", "a pattern"):
        sensor = pe.Sensor("s", AT_OBJECTS[name], pe.Pose((0.0, 0.0, 1.5)))
        for traffic in (False, True):
            counts = assert_objects_defined(sensor, objects, None, traffic)
        assert counts[20] == sensor.model.beam_count
        assert counts[3] > 0 or objects.scenes[3] == objects.scenes[20]


@pytest.mark.parametrize("traffic", [False, True])
def test_the_paper_s_lidar_on_a_few_hundred_objects(traffic):
    """As many channels and azimuths as the benchmarks have; nearly all of it by runs."""
    some = random_objects(np.random.default_rng(6), 60, 20, nearest=5.0, farthest=90.0)
    assert_objects_defined(shapes.lidar_on_roof(rotation=(0.0, 0.0, 10.01)), some, CAR, traffic)


def test_an_upright_lidar_leaves_few_voxels_to_the_kernel_of_any_tilt(monkeypatch):
    """Work, not time: it is what a moved LiDAR costs. A tilted one leaves none out."""
    asked = []

    def counted(points, *rest):
        asked.append(len(points[0]))
        return bracket(points, *rest)

    monkeypatch.setattr(voxel_beams, "bracket", counted)
    evaluator = pe.Evaluator(pe.PerceptionSpace(), pe.Prior.road(), samples=16_384)
    for pitch in (0.0, 3.0):
        pose = pe.Pose.from_degrees((-0.43, 0.0, 1.9), (0.0, pitch, 12.0))
        evaluator.entropy(pe.Rig([pe.Sensor("roof", catalog.load("Pandar64"), pose)]))
    upright, tilted = asked
    assert upright < 0.06 * tilted
