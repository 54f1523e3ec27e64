"""Warnings: each is told where it is due, and nowhere else; its fix fixes what it warns of."""

import math
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_tools import advice
from pe_tools.wording import warning_text
from tests.engine import shapes

SPACE = pe.PerceptionSpace()
PRIOR = pe.Prior.uniform()
STUDIES = sorted((Path(pe.__file__).parent.parent / "blend_assets/experiments").glob("*.toml"))
CAR = shapes.box_car()
"""Its body ends at x = 2.3; its cabin, from x = -1.5 to 0.8, at z = 1.4."""
ROOF = shapes.lidar_on_roof(shapes.small_lidar(), (-0.4, 0.0, 1.7))
LEFT = [(0, -1, 0), (1, 0, 0), (0, 0, 1)]
"""Turned by 90 degrees: what was ahead is on the left."""
RIGHT = [(0, 1, 0), (-1, 0, 0), (0, 0, 1)]
BACK = [(-1, 0, 0), (0, -1, 0), (0, 0, 1)]
TAIL = [(0, 0, -1), (0, 1, 0), (1, 0, 0)]
SIDE = [(1, 0, 0), (0, 0, -1), (0, 1, 0)]
GLAZED = pe.Vehicle(CAR.triangles, CAR.parts, CAR.part_names, glass=("cabin",))
WALL = pe.Vehicle(shapes.box((1, -1, 0), (1.1, 1, 2)))
LYING = {"on_tail", "on_side", "on_roof"}
FLOOR = ("floor", (-10, -10, -0.01), (10, 10, 0.0))
STUDIO = ("studio", (-20, -20, -0.1), (20, 20, 15))
BACKDROP = ("backdrop", (-10, 9, 0), (10, 9.1, 6))


def told(vehicle, *sensors):
    """Warnings on a rig by what they concern and their code."""
    found = advice.warnings(pe.Rig(sensors or [ROOF]), vehicle, SPACE, PRIOR)
    return {(each.subject, each.code): each for each in found}


def lidar_at(*position):
    return shapes.lidar_on_roof(shapes.small_lidar(), position, name="s")


def preset_at(x, z, name="Pandar64"):
    return pe.Sensor("s", pe.catalog.load(name), pe.Pose((x, 0.0, z)))


def camera_at(*position, rotation=(0.0, 0.0, 0.0), hfov_deg=60.0):
    return shapes.camera(hfov_deg, position, rotation, name="s")


def ring_at(x):
    """A ring of level beams."""
    return pe.Sensor("s", pe.Lidar("ring", np.zeros(1), 3600, 50.0), pe.Pose((x, 0.0, 1.0)))


def moved(vehicle, turn=None, shift=(0.0, 0.0, 0.0), scale=1.0):
    """A vehicle with its triangles turned, scaled and shifted, in this order."""
    triangles = vehicle.triangles @ (np.eye(3) if turn is None else np.array(turn, float)).T
    placed = triangles * scale + np.array(shift)
    return pe.Vehicle(placed, vehicle.parts, vehicle.part_names, vehicle.glass)


def with_parts(*boxes, vehicle=None):
    """A vehicle of boxes (name, low, high), each a part, beside those that another has."""
    names = [name for name, _, _ in boxes]
    triangles = [shapes.box(low, high) for _, low, high in boxes]
    parts = np.repeat(np.arange(len(boxes)), 12)
    if vehicle is not None:
        names = [*vehicle.part_names, *names]
        triangles = [vehicle.triangles, *triangles]
        parts = np.concatenate([vehicle.parts, parts + len(vehicle.part_names)])
    return pe.Vehicle(np.concatenate(triangles), parts.astype(np.int32), names)


def of_size(size):
    x, y, z = size
    return pe.Vehicle(shapes.box((-x / 2, -y / 2, 0), (x / 2, y / 2, z)))


def open_below(vehicle):
    """A vehicle without the faces that look down."""
    a, b, c = (vehicle.triangles[:, i] for i in range(3))
    normal = np.cross(b - a, c - a)
    level = np.abs(normal[:, 2]) > 0.99 * np.linalg.norm(normal, axis=1)
    keep = ~(level & (vehicle.triangles[:, :, 2].max(axis=1) < 0.25))
    return pe.Vehicle(vehicle.triangles[keep], vehicle.parts[keep], vehicle.part_names)


@pytest.fixture(scope="module")
def vehicles():
    """The shipped sedan and bus."""
    named = {path.name: path for path in STUDIES}
    return [pe.load_study(named[name]).vehicle for name in ("1_pandar64.toml", "3_front.toml")]


@pytest.fixture(scope="module")
def sedan(vehicles):
    return vehicles[0]


def test_the_paper_s_placements_and_a_lidar_on_the_roof_give_no_warning():
    studies = [pe.load_study(path) for path in STUDIES]
    assert studies and not [s for s in studies if advice.warnings(s.rig, s.vehicle, s.space, PRIOR)]
    assert told(CAR) == {} and told(None) == {}


OPEN = open_below(CAR)
INNER = moved(CAR, scale=0.98, shift=(0, 0, 0.01))
DOUBLE = pe.Vehicle(np.concatenate([CAR.triangles, INNER.triangles]))
MOUNTED = [
    ("inside", CAR, [lidar_at(1.5, 0.0, 0.5)], True),
    ("inside", OPEN, [lidar_at(1.5, 0.0, 0.5)], True),
    ("inside", DOUBLE, [lidar_at(1.5, 0.0, 0.5)], True),
    # under the body, on the bonnet, before the bumper, 1 cm in the skin: they see
    ("inside", CAR, [lidar_at(1.5, 0.0, z) for z in (0.1, 0.93, 0.89)], False),
    ("inside", OPEN, [lidar_at(1.5, 0.0, 0.1), lidar_at(2.4, 0.0, 0.6)], False),
    ("inside", GLAZED, [lidar_at(0.0, 0.0, 1.2)], True),
    ("inside", GLAZED, [camera_at(0.0, 0.0, 1.2, hfov_deg=40.0)], False),
    ("underground", None, [lidar_at(0, 0, -0.05)], True),
    ("underground", None, [lidar_at(0, 0, 0)], False),
    ("outside", None, [lidar_at(0, 0, 5.5), lidar_at(81, 0, 0.5)], True),
    ("outside", None, [lidar_at(80, 0, 5)], False),
    # more than 0.5 m beside the vehicle, or 0.75 m above it; higher than the roof, beside it
    ("clear", CAR, [lidar_at(2.9, 0, 0.6), lidar_at(0, 0, 2.2), lidar_at(0, 1.3, 1.5)], True),
    ("clear", CAR, [lidar_at(2.75, 0, 0.6), lidar_at(0, 0, 2.1)], False),
    # a Pandar64 is 12 cm across and its beams leave it 5 cm above its base
    ("housing", CAR, [preset_at(0.0, 1.41), preset_at(0.81, 0.92)], True),
    ("housing", CAR, [preset_at(0.0, 1.45), preset_at(2.37, 0.6)], False),
    ("housing", CAR, [preset_at(0.0, 1.41, "HDL-64E")], False),  # of no known size
    ("upside_down", CAR, [camera_at(0, 0, 1.6, rotation=(180, 0, 0))], True),
    (
        "upside_down",
        CAR,
        [camera_at(0, 0, 1.6, rotation=r) for r in ((90, 0, 0), (0, 60, 0), (0, -80, 20))],
        False,
    ),
    # 5 cm behind the cabin's back wall, looking ahead
    ("looks_at", CAR, [camera_at(-1.55, 0, 1.15, hfov_deg=30.0)], True),
    # from x = 0.1 the wall spans 2 atan(1 / 0.9) = 96 of 360 degrees, from 0.6 136.4: 37.9 %
    ("occluded", WALL, [ring_at(0.6)], True),
    ("occluded", WALL, [ring_at(0.1)], False),
    ("occluded", CAR, [camera_at(0.85, 0, 0.95, hfov_deg=40.0)], True),
]
"""Code, vehicle, sensors that are each tried alone, and whether the warning is due."""


def test_a_sensor_s_warning_is_told_where_it_is_due_and_nowhere_else():
    wrong = [
        (code, sensor.pose, due)
        for code, vehicle, sensors, due in MOUNTED
        for sensor in sensors
        if (("s", code) in told(vehicle, sensor)) != due
    ]
    assert not wrong
    hung = pe.Sensor("s", shapes.small_lidar(), pe.Pose.from_degrees((0, 0, 1.7), (180, 0, 0)))
    assert ("s", "upside_down") not in told(CAR, hung), "a matter for pictures"


def test_warnings_of_sensors_have_the_figures_and_the_part():
    assert list(told(CAR, lidar_at(1.5, 0.0, 0.5))) == [("s", "inside")]
    assert told(None, lidar_at(0, 0, 5.5))["s", "outside"].values == {"x": 0, "y": 0, "z": 5.5}
    assert told(None, lidar_at(0, 0, -0.05))["s", "underground"].values == {"depth": 0.05}
    for x, y, z, gap in ((2.9, 0, 0.6, 0.6), (0, 0, 2.2, 0.8), (0, 30, 1, 29.1)):
        found = told(CAR, lidar_at(x, y, z))["s", "clear"].values["gap"]
        assert found == pytest.approx(gap, abs=1e-3)
    assert told(CAR, preset_at(0.0, 1.41))["s", "housing"].part == "cabin"
    both = told(CAR, preset_at(0.81, 0.92))["s", "housing"]  # in the corner of bonnet and cabin
    assert both.part == "body" and both.text.endswith("cuts into body, cabin")
    turned = told(CAR, camera_at(0, 0, 1.6, rotation=(180, 0, 0)))["s", "upside_down"]
    assert (turned.fix, turned.amount) == ("roll_sensor", (180.0,))
    near = told(CAR, camera_at(-1.55, 0, 1.15, hfov_deg=30.0))
    assert list(near) == [("s", "looks_at")] and near["s", "looks_at"].part == "cabin"
    assert near["s", "looks_at"].values["distance"] == pytest.approx(0.05, abs=0.01)
    found = told(WALL, ring_at(0.6))["s", "occluded"]
    assert found.values["share"] == pytest.approx(0.379, abs=0.002) and found.part == "vehicle"
    assert found.text == "38% of its beams are occluded by vehicle"
    some = warning_text("occluded", "mast", {"share": 0.5, "part_share": 0.3, "unit": "beams"})
    assert some == "50% of its beams are occluded, 30% by mast"
    pixels = told(CAR, camera_at(0.85, 0, 0.95, hfov_deg=40.0))["s", "occluded"]
    assert (pixels.values["unit"], pixels.part) == ("pixels", "body")


def turn_by(degrees):
    c = math.cos(math.radians(degrees))
    s = math.sin(math.radians(degrees))
    return [(c, -s, 0), (s, c, 0), (0, 0, 1)]


def test_a_vehicle_that_faces_elsewhere(vehicles, sedan):
    for vehicle in vehicles:
        for turn, amount in ((LEFT, -90.0), (RIGHT, 90.0), (BACK, 180.0)):
            found = told(moved(vehicle, turn))[None, "faces"]
            assert (found.fix, found.amount) == ("turn_vehicle", (amount,))
            assert (None, "faces") not in told(moved(moved(vehicle, turn), turn_by(amount)))
    unnamed = pe.Vehicle(sedan.triangles)  # only the long side tells, and not which end is ahead
    assert not told(moved(unnamed, LEFT))[None, "faces"].values["is_named"]
    assert (None, "faces") not in told(moved(unnamed, BACK))


def turned_by(vehicle, amount):
    """Return a vehicle turned about x, then about y [deg], and put on the ground."""
    sx, sy = np.sin(np.radians(amount[:2]))
    cx, cy = np.cos(np.radians(amount[:2]))
    about_x = np.array([(1, 0, 0), (0, cx, -sx), (0, sx, cx)])
    about_y = np.array([(cy, 0, sy), (0, 1, 0), (-sy, 0, cy)])
    turned = moved(vehicle, about_y @ about_x)
    return moved(turned, shift=(0.0, 0.0, -turned.bounds[0][2]))


def test_the_fix_of_a_lying_vehicle_puts_its_wheels_down(vehicles):
    """However it lies: on tail or nose, on either side, on its roof, and along y as well."""
    nose = -np.array(TAIL) * [[1], [-1], [1]]
    other = np.array(SIDE) * [[1], [-1], [-1]]
    ways = [(TAIL, "on_tail"), (nose, "on_tail"), (SIDE, "on_side"), (other, "on_side")]
    still_lying = []
    for vehicle in vehicles:
        for lying, code in [*ways, (np.diag([1.0, -1.0, -1.0]), "on_roof")]:
            for yaw in (np.eye(3), LEFT)[: 1 if code == "on_roof" else 2]:
                there = moved(vehicle, np.array(yaw) @ lying)
                (found,) = [each for (_, code), each in told(there).items() if code in LYING]
                assert (found.code, found.fix) == (code, "stand_vehicle")
                left = {code for _, code in told(turned_by(there, found.amount))}
                still_lying += [code] if left & LYING else []
    assert not still_lying


def test_what_only_seems_to_lie(sedan):
    unnamed = pe.Vehicle(sedan.triangles)
    on_tail = told(moved(unnamed, TAIL, shift=(0, 0, 3.1)))
    assert (None, "on_tail") in on_tail and (None, "faces") not in on_tail
    monster = with_parts(("body", (-2, -1, 0), (2, 1, 2)), ("wheels", (0, -1, 0), (1, 1, 1.8)))
    steered = with_parts(("steering_wheel", (0, 0, 1), (0.1, 0.4, 1.3)), vehicle=CAR)
    for vehicle in (CAR, monster, steered):
        assert not {code for _, code in told(vehicle)} & LYING


def test_sunk_floating_or_beside_the_axis(vehicles):
    """The fix moves it back; a little is left as it is."""
    for vehicle in vehicles:
        for shift, code in (
            *(((0, 0, z), "height") for z in (-0.5, 0.5)),
            *(((x, y, 0), "not_centred") for x, y in ((1.2, 0), (0, -0.77), (0, 0.06), (30, 1))),
        ):
            found = told(moved(vehicle, shift=shift))[None, code]
            assert found.fix == "move_vehicle"
            if code == "height":
                assert ("in the ground" in found.text) == (shift[2] < 0.0)
            assert found.amount == pytest.approx(np.negative(shift), abs=0.01)
            fixed = moved(moved(vehicle, shift=shift), shift=found.amount)
            assert (None, code) not in told(fixed)
        for little in ((0, 0, -0.1), (0, 0, 0.25), (0.9, 0, 0), (0, 0.04, 0), (0, -0.04, 0)):
            codes = {code for _, code in told(moved(vehicle, shift=little))}
            assert not codes & {"height", "not_centred"}, little


def test_a_size_in_another_unit_or_of_no_road_vehicle(sedan):
    """2.03 m over its mirrors: 3.25 m at 1.6 times the size; 4.70 m long, 0.6 of which is 4.5."""
    for factor in (0.0254, 0.01, 0.001):
        found = told(moved(sedan, scale=1 / factor))
        assert list(found)[:1] == [(None, "size")]
        assert (found[None, "size"].fix, found[None, "size"].amount) == ("scale_vehicle", (factor,))
    wide = told(moved(sedan, scale=1.6))[None, "width"]
    assert (wide.fix, wide.amount) == ("scale_vehicle", (0.6,))
    assert (None, "width") not in told(moved(sedan, scale=1.5))


def test_sizes_that_are_no_vehicle():
    for size, factor in (
        ((44, 84, 36), 0.0254),
        ((40, 8, 10), 0.3048),
        ((0.35, 0.2, 0.1), 13.0),
        ((0.047, 0.02, 0.015), 100.0),
    ):
        assert told(of_size(size))[None, "size"].amount == (factor,), size
    floor = np.concatenate([CAR.triangles, shapes.box((-9, -9, -0.1), (9, 9, 0))])
    assert "is a floor part of its mesh? Or, " in told(pe.Vehicle(floor))[None, "size"].text
    assert (None, "size") in told(pe.Vehicle(np.zeros((1, 3, 3))))
    for fine in ((0.9, 0.5, 0.8), (18.75, 2.5, 3.2), (15.1, 9.5, 7.7)):
        assert (None, "size") not in told(of_size(fine)), fine


def test_a_part_as_large_as_a_room(sedan):
    """It is named; the vehicle in it is evaluated without it, and nobody is inside the body."""
    rig = shapes.roof_rig()
    for rooms in ([FLOOR], [STUDIO], [FLOOR, BACKDROP]):
        found = advice.warnings(rig, with_parts(*rooms, vehicle=sedan), SPACE, PRIOR)
        ours = [(each.code, each.part) for each in found if each.subject is None]
        assert ours == [("room", name) for name, _, _ in rooms]
        assert "inside" not in {each.code for each in found}
