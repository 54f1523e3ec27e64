"""Warnings: each is told where it is due, and nowhere else."""

import math
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_tools import advice
from tests.engine import shapes

SPACE, PRIOR = pe.PerceptionSpace(), pe.Prior.uniform()
STUDIES = sorted((Path(pe.__file__).parent.parent / "blend_assets/experiments").glob("*.toml"))
ROOF = shapes.lidar_on_roof(shapes.small_lidar(), (-0.4, 0.0, 1.7))
"""0.3 m above the roof of the car of two boxes."""


def told(vehicle, *sensors, score=None):
    """Warnings on a rig by what they concern and their code."""
    found = advice.warnings(pe.Rig(sensors or [ROOF]), vehicle, SPACE, PRIOR, score)
    return {(each.subject, each.code): each for each in found}


def lidar_at(*position, **options):
    return shapes.lidar_on_roof(shapes.small_lidar(**options), position, name="s")


def camera_at(*position, rotation=(0.0, 0.0, 0.0), hfov_deg=60.0):
    return shapes.camera(hfov_deg, position, rotation, name="s")


def moved(vehicle, turn=None, shift=(0.0, 0.0, 0.0), scale=1.0):
    """A vehicle with its triangles turned, scaled and shifted, in this order."""
    triangles = vehicle.triangles @ (np.eye(3) if turn is None else np.array(turn, float)).T
    placed = triangles * scale + np.array(shift)
    return pe.Vehicle(placed, vehicle.parts, vehicle.part_names, vehicle.glass)


def unnamed(vehicle):
    """The same body, of one part whose name says nothing."""
    return pe.Vehicle(vehicle.triangles)


@pytest.fixture(scope="module")
def sedan():
    return pe.load_study(next(p for p in STUDIES if p.name == "1_pandar64.toml")).vehicle


@pytest.fixture(scope="module")
def bus():
    return pe.load_study(next(p for p in STUDIES if p.name == "3_front.toml")).vehicle


LEFT = [(0, -1, 0), (1, 0, 0), (0, 0, 1)]
"""Turned by 90 degrees: what was ahead is on the left."""
RIGHT = [(0, 1, 0), (-1, 0, 0), (0, 0, 1)]
BACK = [(-1, 0, 0), (0, -1, 0), (0, 0, 1)]
TAIL = [(0, 0, -1), (0, 1, 0), (1, 0, 0)]
SIDE = [(1, 0, 0), (0, 0, -1), (0, 1, 0)]


@pytest.mark.parametrize("path", STUDIES, ids=lambda p: p.stem)
def test_the_paper_s_placements_give_no_warning(path):
    study = pe.load_study(path)
    assert advice.warnings(study.rig, study.vehicle, study.space, study.prior) == ()


def test_all_is_well_with_a_lidar_on_the_roof_and_without_a_vehicle():
    assert told(shapes.box_car()) == {} and told(None) == {}


def open_below(vehicle):
    """A vehicle without the faces that look down."""
    a, b, c = (vehicle.triangles[:, i] for i in range(3))
    normal = np.cross(b - a, c - a)
    level = np.abs(normal[:, 2]) > 0.99 * np.linalg.norm(normal, axis=1)
    low = vehicle.triangles[:, :, 2].max(axis=1) < 0.25
    keep = ~(level & low)
    return pe.Vehicle(vehicle.triangles[keep], vehicle.parts[keep], vehicle.part_names)


@pytest.mark.parametrize("mesh", [lambda v: v, open_below], ids=["closed", "open"])
def test_inside_the_body(mesh):
    car = mesh(shapes.box_car())
    inside = told(car, lidar_at(1.5, 0.0, 0.5))
    assert list(inside) == [("s", "inside")]
    assert inside["s", "inside"].text == "it is inside the body and sees next to nothing"
    for at in ((1.5, 0.0, 0.1), (1.5, 0.0, 0.93), (2.4, 0.0, 0.6), (1.5, 0.0, 0.89)):
        # under the body, on the bonnet, before the bumper, 1 cm in the skin: they see
        assert ("s", "inside") not in told(car, lidar_at(*at)), at


def test_a_double_skin_does_not_turn_inside_into_outside():
    car = shapes.box_car()
    inner = moved(car, scale=0.98, shift=(0, 0, 0.01))
    both = pe.Vehicle(np.concatenate([car.triangles, inner.triangles]))
    assert ("s", "inside") in told(both, lidar_at(1.5, 0.0, 0.5))


def test_behind_glass_a_camera_looks_out_and_a_lidar_does_not():
    car = shapes.box_car()
    cabin = pe.Vehicle(car.triangles, car.parts, car.part_names, glass=("cabin",))
    assert told(cabin, camera_at(0.0, 0.0, 1.2, hfov_deg=40.0)) == {}
    assert ("s", "inside") in told(cabin, lidar_at(0.0, 0.0, 1.2))


def test_under_the_ground():
    assert (
        told(None, lidar_at(0, 0, -0.05))["s", "underground"].text == "it is 5 cm under the ground"
    )
    assert told(None, lidar_at(0, 0, 0)) == {}


def test_outside_the_space():
    found = told(None, lidar_at(0, 0, 5.5))
    assert found["s", "outside"].text == "it is outside the perception space, at (0, 0, 5.5) m"
    assert ("s", "outside") in told(None, lidar_at(81, 0, 0.5))
    assert told(None, lidar_at(80, 0, 5)) == {}


def test_clear_of_the_vehicle():
    """More than 0.5 m beside it, or 0.75 m above it."""
    car = shapes.box_car()  # ends at x = 2.3, its roof at 1.4
    assert ("s", "clear") not in told(car, lidar_at(2.75, 0, 0.6))
    found = told(car, lidar_at(2.9, 0, 0.6))
    assert found["s", "clear"].text == "it is 60 cm clear of the vehicle: what holds it?"
    assert told(car, lidar_at(0, 0, 2.1)) == {}
    assert told(car, lidar_at(0, 0, 2.2))["s", "clear"].text.startswith("it is 80 cm clear")
    assert ("s", "clear") in told(car, lidar_at(0, 1.3, 1.5))  # higher than the roof, beside it
    assert told(car, lidar_at(0, 30, 1))["s", "clear"].text.startswith("it is 29 m clear")


def test_a_housing_that_cuts_into_the_body():
    """A Pandar64 is 12 cm across and its beams leave it 5 cm above its base."""
    car, name = shapes.box_car(), "Pandar64"  # its roof at 1.4

    def at(x, z, name=name):
        return pe.Sensor("s", pe.catalog.load(name), pe.Pose((x, 0.0, z)))

    found = told(car, at(0.0, 1.41))["s", "housing"]
    assert (found.text, found.part) == ("its housing (12 x 12 x 12 cm) cuts into cabin", "cabin")
    assert ("s", "housing") not in told(car, at(0.0, 1.45))  # it stands on the roof
    assert ("s", "housing") not in told(car, at(2.37, 0.6))  # beside the bumper, at 2.3
    both = told(car, at(0.81, 0.92))["s", "housing"]  # in the corner of bonnet and cabin
    assert both.text.endswith("cuts into body, cabin") and both.part == "body"
    assert pe.catalog.housing("HDL-64E") is None
    assert ("s", "housing") not in told(car, at(0.0, 1.41, "HDL-64E"))  # of no known size


def test_upside_down_is_a_matter_for_pictures():
    car = shapes.box_car()
    found = told(car, camera_at(0, 0, 1.6, rotation=(180, 0, 0)))["s", "upside_down"]
    assert found.text == "the camera is upside down"
    assert (found.fix, found.amount) == ("roll_sensor", (180.0,))
    for rotation in ((90, 0, 0), (0, 60, 0), (0, -80, 20)):
        assert ("s", "upside_down") not in told(car, camera_at(0, 0, 1.6, rotation=rotation))
    hung = pe.Sensor("s", shapes.small_lidar(), pe.Pose.from_degrees((0, 0, 1.7), (180, 0, 0)))
    assert ("s", "upside_down") not in told(car, hung)


def test_looking_at_the_body_from_near():
    """5 cm behind the cabin's back wall, which is at x = -1.5, looking ahead."""
    found = told(shapes.box_car(), camera_at(-1.55, 0, 1.15, hfov_deg=30.0))
    assert list(found) == [("s", "looks_at")]
    assert found["s", "looks_at"].text == "it looks at cabin from 5 cm"
    assert found["s", "looks_at"].part == "cabin"


def test_stopped_by_a_part_by_hand():
    """A ring of level beams between two walls: one stops 90 of 360 degrees, one 180 or so."""
    wall = pe.Vehicle(shapes.box((1, -1, 0), (1.1, 1, 2)))  # seen within 45 degrees
    level = pe.Lidar("ring", np.zeros(1), 3600, 50.0)
    sensor = pe.Sensor("s", level, pe.Pose((0.6, 0.0, 1.0)))
    # From x = 0.6 the wall spans 2 atan(1 / 0.4) = 136.4 of 360 degrees: 37.9 %.
    found = told(wall, sensor)["s", "occluded"]
    assert (found.text, found.part) == ("38% of its beams are occluded by vehicle", "vehicle")
    further = pe.Sensor("s", level, pe.Pose((0.1, 0.0, 1.0)))  # 2 atan(1 / 0.9) = 96 degrees
    assert ("s", "occluded") not in told(wall, further)


def test_pixels_that_are_stopped_are_reported_too():
    """The lower half of a level picture is the bonnet's."""
    found = told(shapes.box_car(), camera_at(0.85, 0, 0.95, hfov_deg=40.0))["s", "occluded"]
    assert found.text.endswith("of its pixels are occluded by body") and found.part == "body"


@pytest.mark.parametrize(
    ("turn", "words", "amount"),
    [
        (LEFT, "it faces left (+y) by its parts' names", -90.0),
        (RIGHT, "it faces right (-y) by its parts' names", 90.0),
        (BACK, "it faces backwards (-x) by its parts' names", 180.0),
    ],
)
def test_a_vehicle_that_faces_elsewhere(sedan, bus, turn, words, amount):
    for vehicle in (sedan, bus):
        found = told(moved(vehicle, turn))[None, "faces"]
        assert found.text.startswith(words)
        assert (found.fix, found.amount) == ("turn_vehicle", (amount,))
        mended = moved(moved(vehicle, turn), turn_by(amount))
        assert (None, "faces") not in told(mended)


def turn_by(degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(c, -s, 0), (s, c, 0), (0, 0, 1)]


def test_without_names_only_the_long_side_tells(sedan):
    found = told(moved(unnamed(sedan), LEFT))[None, "faces"]
    assert found.text.startswith("it lies along y (4.70 m wide, 2.03 m long) but forward is +x")
    assert "which end is the front" in found.text
    assert (None, "faces") not in told(moved(unnamed(sedan), BACK))  # it cannot be told


def test_on_its_tail_or_on_its_side(sedan, bus):
    for vehicle in (sedan, bus, unnamed(sedan)):
        on_tail = told(moved(vehicle, TAIL, shift=(0, 0, 3.1)))
        assert on_tail[None, "on_tail"].text.startswith("taller (")
        assert (None, "faces") not in on_tail
        on_side = told(moved(vehicle, SIDE, shift=(0, 0, 1.05)))
        assert "lie on its side" in on_side[None, "on_side"].text
    assert (None, "on_side") not in told(shapes.box_car())


def turned_by(vehicle, amount):
    """Return a vehicle turned about x, then about y [deg], and put on the ground."""
    (sx, sy), (cx, cy) = np.sin(np.radians(amount[:2])), np.cos(np.radians(amount[:2]))
    about_x = np.array([(1, 0, 0), (0, cx, -sx), (0, sx, cx)])
    about_y = np.array([(cy, 0, sy), (0, 1, 0), (-sy, 0, cy)])
    turned = moved(vehicle, about_y @ about_x)
    return moved(turned, shift=(0.0, 0.0, -turned.bounds[0][2]))


LYING = ("on_tail", "on_side", "on_roof")


def test_the_fix_of_a_lying_vehicle_puts_its_wheels_down(sedan, bus):
    """However it lies: on tail or nose, on either side, on its roof, and along y as well."""
    nose, other = -np.array(TAIL) * [[1], [-1], [1]], np.array(SIDE) * [[1], [-1], [-1]]
    roof = np.diag([1.0, -1.0, -1.0])
    still_lying = []
    for vehicle in (sedan, bus):
        for name, lying in (("tail", TAIL), ("nose", nose), ("side", SIDE), ("other", other)):
            for yaw in (np.eye(3), LEFT):
                there = moved(vehicle, np.array(yaw) @ lying)
                (found,) = [each for (_, code), each in told(there).items() if code in LYING]
                assert found.fix == "stand_vehicle"
                left = {code for _, code in told(turned_by(there, found.amount))}
                still_lying += [name] if left & set(LYING) else []
        over = moved(vehicle, roof)
        left = {code for _, code in told(turned_by(over, told(over)[None, "on_roof"].amount))}
        still_lying += ["roof"] if left & set(LYING) else []
    assert not still_lying


def test_on_its_roof(sedan, bus):
    for vehicle in (sedan, bus):
        over = told(
            moved(vehicle, [(1, 0, 0), (0, -1, 0), (0, 0, -1)], (0, 0, vehicle.bounds[1][2]))
        )
        assert next(iter(over)) == (None, "on_roof")
    large = np.concatenate(
        [shapes.box((-2, -1, 0), (2, 1, 2)), shapes.box((0, -1, 0), (1, 1, 1.8))]
    )
    monster = pe.Vehicle(large, np.repeat([0, 1], 12), ("body", "wheels"))
    assert (None, "on_roof") not in told(monster)
    wheel = pe.Vehicle(
        np.concatenate([shapes.box_car().triangles, shapes.box((0, 0, 1), (0.1, 0.4, 1.3))]),
        np.repeat([0, 1], [24, 12]),
        ("body", "steering_wheel"),
    )
    assert (None, "on_roof") not in told(wheel)


def test_names_are_taken_by_their_words(sedan):
    """`detail` is no tail, and what is at both ends tells nothing."""
    names = ("body", "FrontDetail", "rear_windshield", "TailLights")
    boxes = [shapes.box((x - 0.1, -0.5, 0), (x + 0.1, 0.5, 1)) for x in (0, 2, 1, -2)]
    triangles, parts = np.concatenate(boxes), np.repeat([0, 1, 2, 3], 12)
    assert (None, "faces") not in told(pe.Vehicle(triangles, parts, names))
    turned = pe.Vehicle(triangles * (-1, -1, 1), parts, names)
    assert told(turned)[None, "faces"].amount == (180.0,)
    detail = pe.Vehicle(triangles * (-1, -1, 1), parts, ("body", "front", "x", "detail"))
    assert (None, "faces") not in told(detail)


def test_sunk_or_floating(sedan):
    sunk = told(moved(sedan, shift=(0, 0, -0.5)))[None, "height"]
    assert sunk.text == "it stands 50 cm deep in the ground, z = 0"
    assert sunk.fix == "move_vehicle" and sunk.amount == pytest.approx((0, 0, 0.5))
    floats = told(moved(sedan, shift=(0, 0, 0.5)))[None, "height"]
    assert floats.text == "it floats 50 cm above the ground, z = 0"
    assert floats.amount == pytest.approx((0, 0, -0.5))
    for little in (-0.1, 0.25):
        assert (None, "height") not in told(moved(sedan, shift=(0, 0, little)))


def test_a_vehicle_beside_its_axis_or_off_the_origin_is_not_centred(sedan, bus):
    for vehicle in (sedan, bus):
        for shift in ((0.9, 0, 0), (0, 0.04, 0), (0, -0.04, 0)):
            assert (None, "not_centred") not in told(moved(vehicle, shift=shift))
        for shift in ((1.2, 0, 0), (0, -0.77, 0), (0, 0.06, 0), (30, 1, 0)):
            found = told(moved(vehicle, shift=shift))[None, "not_centred"]
            assert found.fix == "move_vehicle"
            assert found.amount == pytest.approx(np.negative(shift), abs=0.01)
            mended = moved(moved(vehicle, shift=shift), shift=found.amount)
            assert (None, "not_centred") not in told(mended)


def test_one_mirror_or_one_seat_leave_the_axis_where_it_is():
    car = shapes.box_car().triangles
    for low, high in (((0.5, 0.9, 0.9), (0.6, 1.2, 1.0)), ((-0.3, 0.2, 0.5), (0.3, 0.8, 1.3))):
        with_one = pe.Vehicle(np.concatenate([car, shapes.box(low, high)]))
        assert (None, "not_centred") not in told(with_one)
        beside = told(moved(with_one, shift=(0, 0.5, 0)))[None, "not_centred"]
        assert beside.amount[1] == pytest.approx(-0.5, abs=0.1)


def test_a_car_as_wide_as_no_road_vehicle(sedan):
    """2.03 m over its mirrors: 3.25 m at 1.6 times the size; 4.70 m long, 0.6 of which is 4.5."""
    found = told(moved(sedan, scale=1.6))[None, "width"]
    assert found.text.startswith("3.25 m wide is more than roads allow; scaled by 0.6 it would")
    assert (found.fix, found.amount) == ("scale_vehicle", (0.6,))
    assert (None, "width") not in told(moved(sedan, scale=1.5))


@pytest.mark.parametrize(
    ("factor", "unit"), [(0.0254, "inches"), (0.01, "centimetres"), (0.001, "millimetres")]
)
def test_a_size_in_another_unit(sedan, factor, unit):
    found = told(moved(sedan, scale=1 / factor))
    assert list(found)[:1] == [(None, "size")]
    size = found[None, "size"]
    assert f"if these are {unit}, scale by {factor:g}: 4.70 m x 2.03 m x 1.45 m" in size.text
    assert (size.fix, size.amount) == ("scale_vehicle", (factor,))


def test_sizes_that_are_no_vehicle():
    suv = pe.Vehicle(shapes.box((-22, -42, 0), (22, 42, 36)))  # of issue 11
    assert told(suv)[None, "size"].text == (
        "44 m long, 84 m wide and 36 m high is no vehicle; if these are inches, scale by 0.0254: "
        "1.12 m x 2.13 m x 91 cm"
    )
    floor = np.concatenate([shapes.box_car().triangles, shapes.box((-9, -9, -0.1), (9, 9, 0))])
    assert "is a floor part of its mesh? Or, " in told(pe.Vehicle(floor))[None, "size"].text
    coach = pe.Vehicle(shapes.box((-20, -4, 0), (20, 4, 10)))
    assert (
        "if these are feet, scale by 0.3048: 12 m x 2.44 m x 3.05 m"
        in told(coach)[None, "size"].text
    )
    toy = pe.Vehicle(shapes.box((-0.175, -0.1, 0), (0.175, 0.1, 0.1)))
    assert told(toy)[None, "size"].text.endswith("scaled by 13 it would be as long as a car")
    assert told(toy)[None, "size"].amount == (13.0,)
    point = pe.Vehicle(np.zeros((1, 3, 3)))
    assert told(point)[None, "size"].text == "all of it is one point"
    tiny = pe.Vehicle(shapes.box((-0.0235, -0.01, 0), (0.0235, 0.01, 0.015)))
    assert told(tiny)[None, "size"].amount == (100.0,)
    for fine in ((0.9, 0.5, 0.8), (18.75, 2.5, 3.2), (15.1, 9.5, 7.7)):
        box = pe.Vehicle(
            shapes.box((-fine[0] / 2, -fine[1] / 2, 0), (fine[0] / 2, fine[1] / 2, fine[2]))
        )
        assert (None, "size") not in told(box), fine


def in_room(vehicle, *rooms):
    """A vehicle with boxes of their own parts round it."""
    names = [f"room {k}" for k in range(len(rooms))]
    triangles = [vehicle.triangles, *(shapes.box(*room) for room in rooms)]
    parts = [vehicle.parts, *(np.full(12, len(vehicle.part_names) + k) for k in range(len(rooms)))]
    all_names = (*vehicle.part_names, *names)
    return pe.Vehicle(np.concatenate(triangles), np.concatenate(parts).astype(np.int32), all_names)


FLOOR = ((-10, -10, -0.01), (10, 10, 0.0))
STUDIO = ((-20, -20, -0.1), (20, 20, 15))
BACKDROP = ((-10, 9, 0), (10, 9.1, 6))


@pytest.mark.parametrize("rooms", [[FLOOR], [STUDIO], [FLOOR, BACKDROP]])
def test_a_part_as_large_as_a_room(sedan, rooms):
    """It is named; the vehicle in it is evaluated without it, and nobody is inside the body."""
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar())])
    found = advice.warnings(rig, in_room(sedan, *rooms), SPACE, PRIOR)
    ours = [(each.code, each.part) for each in found if each.subject is None]
    assert ours == [("room", f"room {k}") for k in range(len(rooms))]
    assert "inside" not in {each.code for each in found}


def test_a_body_with_small_parts_is_no_room(bus):
    """The bus's body beside an antenna, and a double-decker's beside its wheels."""
    antenna = shapes.box((0, 0, 2.6), (0.1, 0.1, 2.9))
    two = pe.Vehicle(
        np.concatenate([bus.triangles, antenna]), np.repeat([0, 1], [len(bus.triangles), 12]), "ab"
    )
    decker = pe.Vehicle(
        np.concatenate(
            [
                shapes.box((-5.5, -1.25, 0.3), (5.5, 1.25, 4.4)),
                shapes.box((-4, -1.2, 0), (4, 1.2, 1)),
            ]
        ),
        np.repeat([0, 1], 12),
        ("body", "wheels"),
    )
    for vehicle in (two, decker):
        assert (None, "room") not in told(vehicle)
