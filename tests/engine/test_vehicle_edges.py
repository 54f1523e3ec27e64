"""Edges of a vehicle by name, and positions as distances from them: by hand, in files, in `pe`."""

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search.domains import rounded
from pe_core.study import VehicleEdges, study_from_dict, study_to_dict
from pe_tools.cli.verbs import main
from pe_tools.jobs import fingerprint
from tests.engine import shapes
from tests.engine.test_docs import ROOT
from tests.engine.test_named_places import vehicle

SEDAN = ROOT / "examples" / "robotaxi_sedan" / "decided.toml"
SMALL = """
samples = 1024
[space]
x = [-14, 14]
y = [-12, 12]
z = [0, 2]
interval = 0.5
[vehicle]
mesh = "car.npz"
[[sensor]]
name = "roof"
model = "Velodyne VLP-16 Puck"
position = [0.0, 0.0, 1.8]
[[sensor]]
name = "tail"
model = "Velodyne VLP-16 Puck"
position = [-2.4, 0.0, 0.8]
"""
CAR = shapes.box_car()
ROUND = pe.Edge("hoop", [[1.0, 0.0, 1.0], [0.0, -2.0, 1.0], [0.0, 2.0, 1.4]])
"""An arrow that points ahead, given out of order: x is 0 at both ends and 1 in the middle."""


def edges(*own):
    return VehicleEdges(CAR, own)


def study(position, **vehicle):
    data = {
        "sensor": [{"name": "roof", "model": "Velodyne VLP-16 Puck", "position": position}],
        "vehicle": {"mesh": "car.npz", **vehicle},
    }
    return study_from_dict(data, vehicle=CAR)


# --- edges ----------------------------------------------------------------------------------------


def test_outer_planes_of_a_box_car_by_hand():
    """4.6 x 1.8 m, 1.4 m high; axes of the ground frame."""
    here = (0.0, 0.0, 0.0)
    expected = {
        "x": {"front": 2.3, "rear": -2.3},
        "y": {"left side": 0.9, "right side": -0.9, "center line": 0.0},
        "z": {"ground": 0.0, "highest point": 1.4},
    }
    for axis, own in expected.items():
        assert {name: edges().at(name, axis, here) for name in own} == own


def test_sides_of_a_part_by_hand():
    """The cabin: x -1.5 to 0.8, y to 0.7, z 0.8 to 1.4."""
    here = (5.0, 5.0, 5.0)  # beyond the ends of the edges their ends count
    at = {
        ("cabin front", "x"): 0.8,
        ("cabin rear", "x"): -1.5,
        ("cabin left", "y"): 0.7,
        ("cabin right", "y"): -0.7,
        ("cabin top", "z"): 1.4,
        ("cabin bottom", "z"): 0.8,
    }
    for (name, axis), value in at.items():
        assert edges().at(name, axis, here) == value


def test_a_side_is_that_of_the_section_through_the_position():
    """A wedge: its front is at x = 1 + y for y from 0 to 1; its top at x = 0, z = 2."""
    corners = np.array([[0, 0, 2], [0, 1, 2], [1, 0, 0], [2, 1, 0]], dtype=float)
    wedge = pe.Vehicle(corners[[[0, 1, 2], [1, 3, 2]]], None, ("pane",))
    found = VehicleEdges(wedge)
    for y in (0.0, 0.25, 0.5, 1.0):
        assert found.at("pane front", "x", (0.0, y, 0.0)) == 1.0 + y
        assert found.at("pane top", "x", (0.0, y, 0.0)) == 0.0
        assert found.at("pane top", "z", (0.0, y, 0.0)) == 2.0


def test_a_stated_edge_is_straight_between_its_points_and_ends_hold_beyond():
    found = edges(ROUND)
    for y, x, z in ((-3.0, 0.0, 1.0), (-1.0, 0.5, 1.0), (0.0, 1.0, 1.0), (1.0, 0.5, 1.2)):
        assert found.at("hoop", "x", (9.0, y, 9.0)) == x
        assert found.at("hoop", "z", (9.0, y, 9.0)) == pytest.approx(z)
    assert "hoop" not in found.names("y")  # it runs along y


def test_a_stated_edge_takes_the_place_of_the_edge_of_a_part():
    own = pe.Edge("cabin front", [[0.5, -1.0, 1.0], [0.5, 1.0, 1.0]])
    assert edges(own).at("cabin front", "x", (0.0, 0.0, 0.0)) == 0.5
    assert edges(own).names("x").count("cabin front") == 1


def test_the_windscreen_of_the_shipped_sedan_has_its_top_edge_behind_its_bottom_edge():
    found = VehicleEdges(vehicle())
    here = (0.0, 0.0, 0.0)
    top, bottom = (found.at(f"windshield {side}", "x", here) for side in ("top", "bottom"))
    assert top < bottom - 0.5
    assert found.at("windshield top", "z", here) > found.at("windshield bottom", "z", here) + 0.3


@pytest.mark.parametrize(
    ("points", "field"),
    [
        ([[0, 0, 0]], "points"),
        ([[1, 2, 3], [1, 2, 3]], "points"),
        ([[1, 2], [1, 2]], "points"),
        ([[1, 2, math.inf], [1, 2, 3]], "points"),
        ("here", "points"),
    ],
)
def test_an_edge_without_an_extent_is_refused(points, field):
    with pytest.raises(pe.InputError) as error:
        pe.Edge("seam", points)
    assert error.value.field == field


def test_an_edge_cannot_have_the_name_of_one_of_every_vehicle_nor_two_edges_one_name():
    with pytest.raises(pe.InputError):
        pe.Edge("center line", [[0, 0, 0], [1, 0, 0]])
    twice = {"edge": [{"name": "a", "points": [[0, 0, 1], [0, 1, 1]]}] * 2}
    with pytest.raises(pe.InputError) as error:
        study([0, 0, 1.8], **twice)
    assert error.value.field.startswith("vehicle")


# --- positions ------------------------------------------------------------------------------------


def test_a_position_by_distances_by_hand():
    own = study(["0.3 m behind cabin front", "12 cm left of center line", "400 mm above cabin top"])
    assert own.rig["roof"].pose.position == (0.5, 0.12, 1.8)


def test_coordinates_that_depend_on_each_other_are_solved():
    """x is 0.5 behind an edge at x = 1 - |y| / 2; y is 0.3 left of one at y = 0.2 x."""
    seam = pe.Edge("seam", [[0, 0, 1], [10, 2, 1]])
    both = edges(ROUND, seam)
    place = both.position(
        [both.distance("hoop", "x", (0, 0, 0)), both.distance("seam", "y", (0, 0, 0)), 1.5]
    )
    x, y, _ = place
    assert both.at("hoop", "x", place) - x == pytest.approx(1.0)
    assert both.at("seam", "y", place) == pytest.approx(y)


def test_any_placement_comes_back_from_its_distances_to_the_bit():
    car = vehicle()
    found = VehicleEdges(car)
    rng = np.random.default_rng(5)
    names = {axis: found.names(axis) for axis in "xyz"}
    for _ in range(60):
        pose = rounded(pe.Pose(tuple(rng.uniform((-2, -1, 0), (2, 1, 2)))))
        own = {axis: str(rng.choice(names[axis])) for axis in "xyz"}
        written = found.coordinates(pose.position, own)
        assert any(not isinstance(each, float) for each in written)
        texts = [each if isinstance(each, float) else each.text for each in written]
        data = {"sensor": [{"name": "a", "model": "Velodyne VLP-16 Puck", "position": texts}]}
        again = study_from_dict(data, vehicle=car).rig["a"].pose.position
        assert again == pose.position


def test_a_study_keeps_the_edges_of_a_sensor_that_a_search_moves():
    own = study(["0.3 m behind cabin front", 0.1, "0.4 m above cabin top"])
    moved = own.rig["roof"].moved(pe.Pose((0.25, 0.0, 1.9)))
    data = study_to_dict(own.with_rig(pe.Rig([moved])))
    assert data["sensor"][0]["position"] == [
        "0.55 m behind cabin front",
        0.0,
        "0.5 m above cabin top",
    ]


def test_edges_of_a_file_come_back_and_change_no_fingerprint():
    plain = study([0.5, 0.0, 1.8])
    told = replace(plain, edges=(ROUND,))
    sensor = replace(plain.rig["roof"], measured_from={"x": "hoop", "y": "center line"})
    told = told.with_rig(pe.Rig([sensor]))
    again = study_from_dict(study_to_dict(told), vehicle=CAR)
    assert again.edges == told.edges
    assert again.rig["roof"].measured_from == sensor.measured_from
    assert again.rig["roof"].pose == sensor.pose
    assert fingerprint(told) == fingerprint(plain)


def test_a_position_that_no_distance_gives_exactly_stays_in_metres():
    own = replace(study([1 / 3, 0.0, 1.8]).rig["roof"], measured_from={"x": "front"})
    data = study_to_dict(study([0.0, 0.0, 1.8]).with_rig(pe.Rig([own])))
    assert data["sensor"][0]["position"] == [1 / 3, 0.0, 1.8]


@pytest.mark.parametrize(
    "text",
    [
        "0.3 m left of front",
        "-0.3 m behind front",
        "0.3 ft behind front",
        "0.3 m behind",
        "front",
        "0.3 m behind the moon",
        "0.3 m behind front axle",  # no wheels
        "99999 m behind front",
    ],
)
def test_a_wrong_distance_is_one_line_that_names_its_coordinate(text):
    with pytest.raises(pe.InputError) as error:
        study([text, 0.0, 1.8])
    assert error.value.field == "sensor[0].position[0]"
    assert "\n" not in str(error.value)


def test_a_sensor_takes_edges_of_axes_alone():
    with pytest.raises(pe.InputError):
        pe.Sensor("roof", shapes.small_lidar(), measured_from={"yaw": "front"})


# --- the command ----------------------------------------------------------------------------------


def answer(capsys, words):
    status = main([*map(str, words), "--json"])
    return status, json.loads(capsys.readouterr().out)


def test_explain_tells_a_sensor_from_edges_and_lists_them(capsys):
    own = pe.load_study(SEDAN)
    x, y, z = own.rig["roof_lidar"].pose.position
    at = own.vehicle_edges.at("windshield top", "x", (x, y, z))
    words = ["explain", SEDAN, "--sensor", "roof_lidar", "--from"]
    status, told = answer(capsys, [*words, "windshield top", "center line", "ground"])
    assert status == 0
    lengths = [float(text.split()[0]) for text in told["distances"]]
    assert lengths[0] == pytest.approx(at - x) and lengths[-2:] == pytest.approx([abs(y), z])
    status, told = answer(capsys, words)
    assert status == 0 and told["edges"] == {a: list(own.vehicle_edges.names(a)) for a in "xyz"}


@pytest.mark.parametrize(
    "words",
    [
        ["--from", "front"],
        ["--sensor", "roof_lidar", "--from", "the moon"],
        ["--sensor", "nobody", "--from", "front"],
    ],
)
def test_explain_refuses_what_is_no_edge_or_of_no_sensor(capsys, words):
    assert main(["explain", str(SEDAN), *words]) == 1
    assert len(capsys.readouterr().err.strip().splitlines()[-1:]) == 1


def test_a_position_is_typed_by_distances_in_set_and_told_in_the_score(tmp_path, capsys):
    pt.write_mesh(tmp_path / "car.npz", pe.Mesh(CAR.triangles, CAR.parts, CAR.part_names))
    path = tmp_path / "study.toml"
    path.write_text(SMALL, "utf-8")
    typed = 'sensor.roof.position=["0.7 m behind cabin front","3 cm left of center line",1.7]'
    assert main(["set", str(path), typed]) == 0
    capsys.readouterr()
    own = pe.load_study(path)
    assert own.rig["roof"].pose.position == (0.1, 0.03, 1.7)
    status, told = answer(capsys, ["score", path])
    assert status == 0
    placed = told["placements"]["after"]
    texts = ["0.7 m behind cabin front", "0.03 m left of center line"]
    assert placed["roof"]["distances"] == texts
    assert "distances" not in placed["tail"]
    same = answer(capsys, ["score", path, "--set", "sensor.roof.position=[0.1,0.03,1.7]"])[1]
    assert same["after"] == told["after"]
    assert same["study_sha256"] == told["study_sha256"]
    assert main(["score", str(path)]) == 0
    assert all(text in capsys.readouterr().out for text in texts[:1])


def test_all_edges_of_the_examples_can_be_measured():
    for name in ("city_bus", "delivery_shuttle", "truck_trailer"):
        own = pe.load_study(ROOT / "examples" / name / "decided.toml")
        for sensor, axis in itertools.product(own.rig, "xyz"):
            for edge in own.vehicle_edges.names(axis):
                told = own.vehicle_edges.distance(edge, axis, sensor.pose.position)
                assert abs(told.offset) < 20.0
