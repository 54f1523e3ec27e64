"""Where a vector of variables puts a sensor: in its box, on a surface, in a slot."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.search import Parametrization
from pe_core.search.domains import snap_to_mount, standoff_point
from tests.engine import mounting, shapes
from tests.engine.mounting import BASE, CENTER, ON_ROOF, RADIUS, TOP, can, coded, roof

RNG_SEED = 3
LEVEL = ("x", "y", "z")
SLOTS = pe.SlotMount(
    [
        pe.Slot("left", pe.Pose.from_degrees((0.0, 0.4, 1.6), (0.0, 5.0, 90.0))),
        pe.Slot("middle", pe.Pose.from_degrees(ON_ROOF)),
        pe.Slot("right", pe.Pose.from_degrees((0.0, -0.4, 1.6), (0.0, 5.0, -90.0))),
    ]
)
SLAB = (
    shapes.box((-2.0, -0.9, 0.2), (2.0, 0.9, 1.2)),
    shapes.box((-1.2, -0.7, 1.3), (0.8, 0.7, 1.4)),
)
"""A body, and a roof 0.1 m thick that floats 0.1 m above it."""


def drawn(coding, count=200):
    """Placements drawn over all that the variables may be."""
    rng = np.random.default_rng(RNG_SEED)
    vectors = [[rng.uniform(u.low, u.high) for u in coding.variables] for _ in range(count)]
    return [coding.candidate(vector).rig for vector in vectors]


def test_a_box_s_unknowns_are_its_free_coordinates_in_the_order_of_axes():
    coding = coded(can(), free=("pitch", "z"), limits={"roof": {"z": (1.0, 2.0)}})
    assert [(u.low, u.high, u.unit) for u in coding.variables] == [
        (1.0, 2.0, "m"),
        (-math.pi / 2, math.pi / 2, "rad"),
    ]
    assert coding.start.vector == (ON_ROOF[2], 0.0)
    pose = coding.candidate([1.234567, 0.1]).rig["roof"].pose
    assert pose.position == (-0.43, 0.0, 1.23457)
    assert coding.candidate([1.234567, 0.1]).vector[0] == 1.23457


@pytest.mark.parametrize(
    ("name", "mount"), [("roll", None), ("yaw", None), ("yaw", {"roof": roof()})]
)
@pytest.mark.parametrize("turns", [-360.0, 0.0, 360.0])
@pytest.mark.parametrize("middle", [-180.0, 0.0, 95.0, 180.0])
def test_bounds_of_angles_hold_modulo_a_turn(name, mount, turns, middle):
    """A rear camera at -180 degrees is within [160, 200]: the same start, and the same range."""
    axis = ("roll", "pitch", "yaw").index(name)
    rotation = [middle if axis == k else 0.0 for k in range(3)]
    sensor = can(rotation=rotation)
    bounds = np.radians([middle - 20.0, middle + 20.0])
    limits = {"roof": {name: bounds + math.radians(turns)}}
    coding = coded(sensor, mount=mount, free=(name,), limits=limits)
    start = coding.candidate(coding.start.vector).rig["roof"].pose
    turned = start.ground_from_sensor - sensor.pose.ground_from_sensor
    assert np.abs(turned).max() < 1e-6
    last = (*coding.start.vector[:-1], coding.variables[-1].high)
    end = coding.candidate(last).rig["roof"].pose.rpy[axis]
    assert math.cos(end - bounds[1]) == pytest.approx(1.0, abs=1e-9)
    beside = {"roof": {name: bounds + math.radians(turns + 21.0)}}
    with pytest.raises(pe.InputError, match=f"bounds of {name}"):
        coded(sensor, mount=mount, free=(name,), limits=beside)


def test_a_sensor_on_the_roof_stands_at_its_stand_off_wherever_it_goes_and_reaches_all_of_it():
    rigs = drawn(coded(can(), mount={"roof": roof()}, free=LEVEL))
    x, y, z = np.array([rig["roof"].pose.position for rig in rigs]).T
    assert z == pytest.approx(TOP + BASE + CENTER, abs=1e-5)
    assert -1.5 - 1e-5 <= x.min() < -1.4 and 0.7 < x.max() <= 0.8 + 1e-5
    assert -0.7 - 1e-5 <= y.min() < -0.6 and 0.6 < y.max() <= 0.7 + 1e-5


def ramp(slope_deg=30.0):
    """A plate that rises to the front, and the pose of a can that stands on its middle."""
    rise = math.tan(math.radians(slope_deg))
    corners = [(-1.0, -1.0, 1.0 - rise), (1.0, -1.0, 1.0 + rise), (1.0, 1.0, 1.0 + rise)]
    other = [corners[0], corners[2], (-1.0, 1.0, 1.0 - rise)]
    floor = shapes.box((-2.0, -2.0, 0.0), (2.0, 2.0, 0.1))
    triangles = np.concatenate([floor, np.array([corners, other])])
    parts = np.array([0] * len(floor) + [1, 1], np.int32)
    return pe.Vehicle(triangles, parts, ("floor", "ramp"))


def test_orientation_upright_stays_so_and_normal_follows_the_surface():
    slope = math.radians(30.0)
    normal = np.array([-math.sin(slope), 0.0, math.cos(slope)])
    foot = np.array([0.0, 0.0, 1.0])
    upright = can(foot + 0.2 * normal + [0.0, 0.0, CENTER], "a")
    tilted = can(foot + (0.2 + CENTER) * normal, "b", (0.0, -30.0, 0.0))
    mounts = {
        "a": pe.SurfaceMount(["ramp"], 0.2, "upright"),
        "b": pe.SurfaceMount(["ramp"], 0.2, "normal"),
    }
    free = ("x", "y", "z", "yaw")
    for rig in drawn(coded(upright, tilted, mount=mounts, free=free, vehicle=ramp()), 20):
        up_a, up_b = (rig[name].pose.ground_from_sensor[:, 2] for name in "ab")
        assert up_a == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)
        assert up_b == pytest.approx(normal, abs=1e-5)
        base = np.array(rig["b"].pose.position) - CENTER * up_b
        assert (base - foot) @ normal == pytest.approx(0.2, abs=1e-4)


def test_facing_looks_along_the_normal():
    """A camera in the car's front looks ahead, one in its left side to the left."""
    ahead = shapes.camera(position=(2.32, 0.0, 0.6), name="ahead")
    aside = shapes.camera(position=(0.0, 0.92, 0.6), rotation=(0.0, 0.0, 90.0), name="aside")
    mounts = {
        "ahead": pe.SurfaceMount(["front"], 0.02, "facing"),
        "aside": pe.SurfaceMount(["left"], 0.02, "facing"),
    }
    coding = coded(ahead, aside, mount=mounts, free=("x", "y", "z"))
    for rig in drawn(coding, 20):
        assert rig["ahead"].pose.position[0] == pytest.approx(2.32, abs=1e-5)
        assert rig["ahead"].pose.rotation_deg == (0.0, 0.0, 0.0)
        assert rig["aside"].pose.position[1] == pytest.approx(0.92, abs=1e-5)
        assert rig["aside"].pose.rotation_deg == (0.0, 0.0, 90.0)


def test_facing_the_back_of_the_housing_is_at_the_stand_off():
    """A can in the car's front, its axis 8 mm before its middle: origin, radius, 2 cm."""
    housing = pe.Housing("cylinder", (0.1, 0.1, 0.06), (0.008, 0.0, 0.03))
    mount = pe.SurfaceMount(["front"], 0.02, "facing")
    assert standoff_point(mount, housing) == pytest.approx([-0.008 - 0.05, 0.0, 0.0])
    ahead = can((2.3 + 0.02 + RADIUS, 0.0, 0.6), "ahead")
    (rig, *_) = drawn(coded(ahead, mount={"ahead": mount}, free=("x", "y", "z")), 3)
    assert rig["ahead"].pose.position[0] == pytest.approx(2.32 + RADIUS, abs=1e-5)


def test_a_surface_s_outside_does_not_depend_on_how_its_corners_turn():
    car = mounting.car()
    for vehicle in (car, pe.Vehicle(car.triangles[:, ::-1], car.parts, car.part_names)):
        (rig,) = drawn(coded(can(), mount={"roof": roof()}, free=LEVEL, vehicle=vehicle), 1)
        assert rig["roof"].pose.position[2] == pytest.approx(TOP + BASE + CENTER, abs=1e-5)


def test_slots_are_taken_whole_and_no_other_place_is():
    coding = coded(can(), mount={"roof": SLOTS})
    poses = [slot.pose for slot in SLOTS.slots]
    found = [rig["roof"].pose for rig in drawn(coding)]
    assert all(pose in poses for pose in found)
    assert all(found.count(pose) > 30 for pose in poses)


def test_a_pair_is_its_own_mirror_image():
    left = can((0.2, 0.5, ON_ROOF[2]), "left", (3.0, 10.0, 40.0))
    right = can((0.2, -0.5, ON_ROOF[2]), "right", (-3.0, 10.0, -40.0))
    coding = coded(left, right, pairs=[("left", "right")], free=("x", "y", "roll", "yaw"))
    assert len(coding.variables) == 4
    for rig in drawn(coding, 20):
        x, y, z = rig["left"].pose.position
        roll, pitch, yaw = rig["left"].pose.rotation_deg
        assert rig["right"].pose.position == (x, -y, z)
        assert rig["right"].pose.rotation_deg == (-roll, pitch, -yaw)


def test_a_group_keeps_its_relative_pose():
    lead = can((0.0, 0.0, 1.6), "lead", (0.0, 0.0, 10.0))
    other = can((0.3, 0.1, 1.7), "other", (0.0, 5.0, 50.0))

    def between(rig):
        lead = rig["lead"].pose
        other = rig["other"].pose
        back = lead.ground_from_sensor.T
        away = np.array(other.position) - np.array(lead.position)
        return np.concatenate([back @ away, (back @ other.ground_from_sensor).ravel()])

    coding = coded(lead, other, groups=[("lead", "other")], free=("x", "z", "pitch", "yaw"))
    assert len(coding.variables) == 4
    places = set()
    for rig in drawn(coding, 20):
        assert between(rig) == pytest.approx(between(coding.start.rig), abs=1e-5)
        places.add(rig["other"].pose.position)
    assert len(places) == 20


def test_a_sensor_is_snapped_to_its_mount():
    """Tilted above the roof's (0.1, 0.2), heading 40 deg: level on it, or upright as it was."""
    sensor = can((0.1, 0.2, 3.0), rotation=(5.0, 10.0, 40.0))
    housing = pe.Housing("cylinder", (0.1, 0.1, 0.06), (0.0, 0.0, 0.0))
    for orientation, turned in (("normal", (0.0, 0.0, 40.0)), ("upright", (5.0, 10.0, 40.0))):
        pose = snap_to_mount(sensor, roof(0.1, orientation), mounting.car(), housing)
        assert pose.rotation_deg == pytest.approx(turned, abs=1e-3)
        assert pose.position[:2] == pytest.approx((0.1, 0.2), abs=0.03)
    slots = pe.SlotMount([pe.Slot("a", pe.Pose((0, 0, 2))), pe.Slot("b", pe.Pose((0, 0.3, 3)))])
    assert snap_to_mount(sensor, slots).position == (0.0, 0.3, 3.0)


def slab(turned):
    """The body and the closed roof; `turned` faces of the roof have their corners the other way."""
    roof_faces = np.where(turned[:, None, None], SLAB[1][:, ::-1], SLAB[1])
    parts = np.repeat(np.arange(2, dtype=np.int32), [len(SLAB[0]), len(roof_faces)])
    return pe.Vehicle(np.concatenate([SLAB[0], roof_faces]), parts, ("body", "roof"))


@pytest.mark.parametrize("seed", range(6))
def test_an_upright_sensor_stands_on_top_of_a_slab_whichever_way_its_faces_turn(seed):
    """Every place of the space is projected onto the top, 1.4 m high: no side, no underside."""
    rng = np.random.default_rng(seed)
    turned = rng.random(len(SLAB[1])) < (0.0, 1.0, 0.5, 0.2, 0.8, 0.5)[seed]
    model = shapes.small_lidar(4, 90)  # its housing is not known: nothing else would keep it off
    start = pe.Sensor("roof", model, pe.Pose((0.0, 0.0, 1.44)))
    rig, space = mounting.space(start, mount={"roof": roof()}, vehicle=slab(turned))
    coding = Parametrization(rig, space)
    for point in rng.uniform((-3.0, -2.0, 0.0), (3.0, 2.0, 2.0), (200, 3)):
        x, y, z = coding.candidate((*point, 0.0)).rig["roof"].pose.position
        assert z == pytest.approx(1.44, abs=1e-5), point
        assert -1.2 <= x <= 0.8 and -0.7 <= y <= 0.7, point


def test_a_slope_says_which_faces_an_upright_sensor_may_have():
    """A wall slopes by 90 degrees: it is refused by default, with the slope to ask for."""
    start = pe.Sensor("front", shapes.small_lidar(4, 90), pe.Pose((2.34, 0.0, 0.6)))
    for slope in (60.0, 89.0):
        mount = pe.SurfaceMount(["front"], 0.04, max_slope=np.radians(slope))
        with pytest.raises(pe.InputError, match=f"max_slope: .* {slope:g} deg"):
            coded(start, mount={"front": mount})
    mount = pe.SurfaceMount(["front"], 0.04, max_slope=np.radians(90.0))
    coding = coded(start, mount={"front": mount})
    pose = coding.candidate((2.3, 0.3, 0.5, 0.0)).rig["front"].pose
    assert pose.position == pytest.approx((2.34, 0.3, 0.5)) and pose.rpy == (0.0, 0.0, 0.0)
    for turned in ("normal", "facing"):  # such a sensor turns with the face
        where = start if turned == "normal" else start.moved(pe.Pose((2.34, 0.0, 0.6)))
        whole = pe.SurfaceMount(["front"], 0.04, turned)
        assert snap_to_mount(where, whole, mounting.car()).position[0] == pytest.approx(2.34)
