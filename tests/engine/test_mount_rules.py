"""Each rule of a search: a placement that breaks it, one that just does not, and nothing else."""

import sys

import numpy as np
import pytest

import pe_core as pe
from pe_core.geometry.overlap import hull_box, overlaps
from pe_core.scene.rig import Housing, hull_of
from pe_core.scene.vehicle import is_enclosed, is_open
from pe_core.search import feasible_start
from tests.engine import mounting, shapes
from tests.engine.mounting import BASE, CENTER, HEIGHT, ON_ROOF, RADIUS, TOP, can, roof

FLYING = 2.5
"""Above everything [m]."""


def broken(*sensors, **options):
    """The rules that sensors break where they are."""
    coding = mounting.coded(*sensors, **options)
    return sorted(coding.broken(coding.start.rig))


def limited(*sensors, **limits):
    own = {key: limits.pop(key) for key in ("no_go", "clear_housings") if key in limits}
    return broken(*sensors, figures=limits, constraints=pe.Constraints(**own))


def test_greatest_height_is_of_the_housing_s_top():
    top = 2.0 + HEIGHT - CENTER
    low = top - 1e-4
    high = top + 1e-4
    assert limited(can((0, 0, 2.0)), height=high) == []
    assert limited(can((0, 0, 2.0)), height=low) == ["limits.height of 'roof'"]
    eye = shapes.camera(position=(0, 0, 2.0), name="eye")  # of no known size
    assert limited(eye, height=2.0) == []
    assert limited(eye, height=1.9999) == ["limits.height of 'eye'"]


def test_greatest_width_is_of_the_housing_s_side_on_either_side():
    for side in (1.0, -1.0):
        sensor = can((0, side * 0.9, FLYING))
        assert limited(sensor, width=2 * (0.9 + 1.03 * RADIUS)) == []
        assert limited(sensor, width=2 * (0.9 + 0.97 * RADIUS)) == ["limits.width of 'roof'"]


def test_least_distance_is_between_any_two_sensors():
    first, middle, last = (can((x, 0, FLYING), f"s{x}") for x in (0, 3, 4))
    assert limited(first, middle, last, distance=1.0) == []
    assert limited(first, middle, last, distance=1.001) == ["limits.distance of 's3' and 's4'"]


def test_a_no_go_box_takes_the_whole_housing_and_an_axis_that_is_not_said_has_no_ends():
    area = [pe.NoGo("antenna", x=(0.5, 1.0), y=(-0.1, 0.1))]
    told = ["no_go 'antenna' for 'roof'"]
    assert limited(can((0.5 - 1.03 * RADIUS, 0, FLYING)), no_go=area) == []
    assert limited(can((0.5 - 0.97 * RADIUS, 0, FLYING)), no_go=area) == told
    assert limited(can((0.75, 0.0, 9.0)), no_go=area) == told
    assert limited(can((0.75, 0.2, FLYING)), no_go=area) == []
    eye = shapes.camera(position=(0.75, 0.0, FLYING), name="roof")
    assert limited(eye, no_go=area) == told


def test_a_housing_in_the_body_is_found_where_that_is_asked_for():
    sunk = can((0.0, 0.0, TOP + CENTER - 0.01))
    assert limited(sunk) == []
    assert limited(sunk, clear_housings=True) == ["the body for 'roof'"]
    assert limited(can((0.0, 0.0, TOP + CENTER + 0.001)), clear_housings=True) == []


def test_a_sensor_wholly_inside_the_body_is_found_though_it_touches_nothing():
    inside = can((0.0, 0.0, 1.1))
    assert pe.cuts_body(inside.pose, pe.catalog.housing(inside.model.name), mounting.car()) == ()
    assert limited(inside, clear_housings=True) == ["the body for 'roof'"]
    eye = shapes.camera(position=(0.0, 0.0, 1.1), name="eye")
    assert limited(eye, clear_housings=True) == ["the body for 'eye'"]


def test_on_a_surface_the_housing_is_kept_clear_without_being_asked_for():
    """A wall rises from the roof's front edge, in a can's way."""
    wall = shapes.box((0.7, -0.7, TOP), (0.8, 0.7, TOP + 0.3))
    car = mounting.car()
    parts = np.concatenate([car.parts, np.full(len(wall), 4)]).astype(np.int32)
    vehicle = pe.Vehicle(np.concatenate([car.triangles, wall]), parts, (*car.part_names, "wall"))
    near = can((0.7 - 0.9 * RADIUS, 0.0, ON_ROOF[2]))
    assert broken(near, mount={"roof": roof()}, vehicle=vehicle) == ["the body for 'roof'"]
    far = can((0.7 - 1.1 * RADIUS, 0.0, ON_ROOF[2]))
    assert broken(far, mount={"roof": roof()}, vehicle=vehicle) == []


def test_housings_keep_out_of_each_other_where_that_is_asked_for():
    for gap, told in ((1.03, []), (0.97, ["clear housings of 'a' and 'b'"])):
        one = can((0, 0, FLYING), "a")
        other = can((2 * gap * RADIUS, 0, FLYING), "b")
        assert limited(one, other) == []
        assert limited(one, other, clear_housings=True) == told


def test_a_surface_that_is_hollow_keeps_its_stand_off_all_round():
    """In the corner of an L, a sensor on its floor would be too near to its wall."""
    floor = shapes.box((-1.0, -1.0, 0.0), (1.0, 1.0, 0.1))
    wall = shapes.box((0.9, -1.0, 0.1), (1.0, 1.0, 1.0))
    vehicle = pe.Vehicle(np.concatenate([floor, wall]))
    eye = shapes.camera(position=(0.0, 0.0, 0.4), name="eye")
    mount = {"eye": pe.SurfaceMount(["vehicle"], 0.3)}
    coding = mounting.coded(eye, mount=mount, free=("x", "y", "z"), vehicle=vehicle)
    near, far = (coding.candidate([x, 0.0, 0.1]).rig for x in (0.8, 0.5))
    assert coding.broken(near) == {"standoff of 'eye'"}
    assert coding.broken(far) == set()


def test_no_two_sensors_share_a_slot():
    slots = pe.SlotMount(
        [pe.Slot("1", pe.Pose((0, 0, FLYING))), pe.Slot("2", pe.Pose((1, 0, FLYING)))]
    )
    two = can((0, 0, FLYING), "a"), can((1, 0, FLYING), "b")
    rig = pe.Rig(two)
    mounts = pe.Mounting({"rack": slots}, {"a": "rack", "b": "rack"})
    study = pe.Study(rig, search=pe.Search(mounting=mounts))
    coding = study.coding()
    assert coding.broken(rig) == set()
    assert coding.broken(coding.candidate([0.25, 0.25]).rig) == {"one slot for 'a' and 'b'"}


def test_bounds_of_a_sensor_on_a_surface_hold_where_the_surface_leads():
    coding = mounting.coded(can(), mount={"roof": roof()}, limits={"roof": {"x": (-0.5, 0.0)}})
    for x in (-0.6, -0.4, -0.1, 0.1):
        broken = set() if -0.5 < x < 0.0 else {"bounds of x of 'roof'"}
        assert coding.broken(coding.candidate([x, 0.0, TOP, 0.0]).rig) == broken


# --- hulls ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", ["box", "cylinder"])
def test_solids_meet_when_points_of_one_are_in_the_other(shape):
    """Against points sown densely in one hull and looked for in the other, at random poses."""
    rng = np.random.default_rng(1)
    housing = Housing(shape, (0.2, 0.2, 0.3), (0.0, 0.0, 0.1))
    sown = rng.uniform(-1.0, 1.0, (20_000, 3))
    if shape == "cylinder":
        sown = sown[np.hypot(sown[:, 0], sown[:, 1]) <= 1.0]
    own = housing.center + sown * np.array(housing.size) / 2.0
    met = apart = 0
    for _ in range(150):
        a, b = (pe.Pose(rng.normal(0.0, 0.12, 3), rng.normal(0.0, 2.0, 3)) for _ in range(2))
        ground = own @ a.ground_from_sensor.T + a.position
        local = (ground - b.position) @ b.ground_from_sensor - housing.center
        half = np.array(housing.size) / 2.0
        within = (np.abs(local) < half).all(axis=1)
        if shape == "cylinder":
            within &= np.hypot(local[:, 0], local[:, 1]) < half[0]
        found = overlaps(hull_of(a, housing), hull_of(b, housing))
        assert found or not within.any()
        met += within.any()
        apart += not found
    assert met > 30 and apart > 20


def test_solids_that_touch_do_not_meet():
    one = hull_box(np.zeros(3), np.ones(3))
    for gap, told in ((0.0, False), (-1e-4, True), (1e-4, False)):
        assert overlaps(one, hull_box(np.array([1.0 + gap, 0.0, 0.0]), np.full(3, 2.0))) is told
    point = hull_of(pe.Pose((0.5, 0.5, 0.5)), None)
    assert overlaps(one, point) and not overlaps(hull_box(np.ones(3), np.full(3, 2.0)), point)


@pytest.mark.parametrize(
    ("place", "open_"),
    [
        ((0.0, 0.0, 1.1), False),  # in the cabin
        ((0.0, 0.0, TOP + 0.05), True),
        ((2.32, 0.0, 0.6), True),  # at the front, the sky above it
        ((0.0, 0.92, 0.3), True),  # at the left side
        ((0.0, 0.0, 0.1), False),  # under the floor: not open at once, but nor enclosed
        ((9.0, 0.0, 0.0), True),
    ],
)
def test_what_is_open_at_first_sight_is_not_enclosed(place, open_):
    car = mounting.car()
    assert is_open(car, np.array(place)) is open_
    assert is_enclosed(car, np.array(place)) is (place == (0.0, 0.0, 1.1))


# --- none that fits -------------------------------------------------------------------------------


def test_a_start_that_breaks_a_rule_gives_way_to_a_placement_near_it():
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(-0.6, -0.2))])
    coding = mounting.coded(can(), mount={"roof": roof()}, constraints=limits)
    assert not coding.allowed(coding.start.rig)
    found = feasible_start(coding)
    assert coding.allowed(found.rig)
    assert abs(found.rig["roof"].pose.position[0] - ON_ROOF[0]) < 0.5
    assert feasible_start(coding).vector == found.vector


@pytest.fixture
def few_tries(monkeypatch):
    """A start is looked for at 200 placements."""
    monkeypatch.setattr(sys.modules[feasible_start.__module__], "MAX_TRIES", 200)


def test_rules_that_exclude_each_other_are_named_and_no_others(few_tries):
    """A high mount under a low ceiling; least distance and width are innocent."""
    other = can((0.0, 0.0, FLYING), "other")
    limits = {"height": TOP + BASE + HEIGHT - 0.01, "width": 3.0, "distance": 0.1}
    options = {"mount": {"roof": roof()}, "figures": limits, "free": ()}
    with pytest.raises(pe.InputError) as error:
        feasible_start(mounting.coded(can(), other, **options))
    assert str(error.value) == (
        "optimize: limits.height of 'roof' leaves no feasible placement: expected a placement that "
        "breaks no rule, found none in 201 tried"
    )
