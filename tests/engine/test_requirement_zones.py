"""Planes of a vehicle, samples of zones and their margins, held to figures by hand."""

import math
from itertools import starmap

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring.requirements import VehiclePlanes, Zone, margin_of, signed_distance
from tests.engine import shapes
from tests.engine.requirement_scene import van

LEFT = ((0.2, 0.97, 0.4), (1.3, 1.0, 2.0))
DOORS = {
    "driver's": ({"door_front_left": LEFT}, 0.2),
    "the foremost": (
        {"door_rear_left": ((-0.9, 0.97, 0.4), (0.15, 1.0, 2.0)), "door_l": LEFT},
        0.2,
    ),
    "both sides in one part": ({"doors_front": ((0.2, -1.0, 0.4), (1.3, 1.0, 2.0))}, 0.2),
    "passengers' side": ({"door_front": ((0.2, -1.0, 0.4), (1.3, -0.97, 2.0))}, None),
    "at the rear": ({"trailer_door_left": ((-2.5, 0.1, 0.5), (-2.45, 1.0, 2.3))}, None),
    "behind the axle": ({"door_side": ((-2.4, 0.97, 0.4), (-1.5, 1.0, 2.0))}, None),
    "all in one part": ({"doors_left": ((-1.0, 0.97, 0.4), (1.3, 1.0, 2.0))}, None),
}


def test_planes_leave_out_mirrors_and_what_is_above():
    """The widths are those of the body; a plane says how it was found."""
    planes = VehiclePlanes.of(van(mirrors=True), near_side="left")
    assert (planes.across["left"], planes.across["right"]) == (1.0, -1.0)
    assert (planes.across["near"], planes.across["off"]) == (1.0, -1.0)
    assert (planes.along["front"], planes.along["rear"]) == (2.5, -2.5)
    assert "mirror_left" in planes.found["left"]["parts"]
    assert signed_distance(np.array([[0.0, 0.0], [3.5, 2.0]]), planes.outline) == pytest.approx(
        [-1.0, math.hypot(1.0, 1.0)]
    )
    wedge = pe.Vehicle(
        np.array([[[0, 0, 0], [4, 0, 4], [0, 1, 0]], [[-2, 0, 0], [0, 1, 1], [0, 0, 0]]], float)
    )
    assert VehiclePlanes.of(wedge, below=1.0).along["front"] == 1.0


def nameless(*, welded=False, tyres=True):
    """A car in one part: body, four tyres of 12 sides, and two mirrors that stick out by 0.2 m."""
    low = np.array([-2.2, -0.9, 0.2])
    high = np.array([2.2, 0.9, 1.5])
    pieces = [shapes.box(low, high)]
    for side in (1.0, -1.0):
        start = np.array([0.6, side * (0.88 if welded else 0.91), 1.0])
        end = start + np.array([0.2, side * 0.2, 0.15])
        mirror = shapes.box(np.minimum(start, end), np.maximum(start, end))
        pieces.append(mirror)
        if welded:  # a triangle from a corner of the body to one of the mirror
            near = pieces[0].reshape(-1, 3)[np.argmax(pieces[0].reshape(-1, 3) @ [1, side, 1])]
            pieces.append(np.array([[near, mirror[0, 0], mirror[0, 1]]]))
        for x in (-1.3, 1.4) if tyres else ():
            turn = np.linspace(0.0, 2.0 * np.pi, 13)
            rim = np.stack([x + 0.3 * np.sin(turn), turn, 0.3 - 0.3 * np.cos(turn)], axis=1)
            inner = rim * (1, 0, 1) + (0, side * 0.65, 0)
            outer = rim * (1, 0, 1) + (0, side * 0.85, 0)
            pieces.append(np.stack([inner[:-1], inner[1:], outer[:-1]], axis=1))
            pieces.append(np.stack([outer[:-1], inner[1:], outer[1:]], axis=1))
    return pe.Vehicle(np.concatenate(pieces))


def test_a_mesh_without_names_has_its_axles_and_mirrors_by_shape():
    planes = VehiclePlanes.of(nameless())
    assert planes.along["rear_axle"] == pytest.approx(-1.3, abs=1e-6)
    assert planes.along["front_axle"] == pytest.approx(1.4, abs=1e-6)
    assert (planes.across["left"], planes.across["right"]) == (0.9, -0.9)
    assert planes.found["left"]["x"] == [0.6, 0.8]
    assert np.abs(planes.outline[:, 1]).max() == 0.9
    assert planes.found["rear_axle"] == planes.found["front_axle"] == {"code": "tyres"}


def test_features_by_shape_are_told_as_missing_where_they_are_not_clear():
    """Mirrors that hang together with the body stay; a box on the ground has no axles."""
    welded = VehiclePlanes.of(nameless(welded=True, tyres=False))
    assert welded.across["left"] == pytest.approx(1.08)
    assert welded.found["left"] == {"code": "mesh"}
    assert "tyres alone on the ground" in welded.missing["front_axle"]
    one_side = nameless().triangles
    one_side = one_side[
        ~((one_side[..., 1].min(axis=1) > 0.9) & (one_side[..., 2].min(axis=1) > 0.9))
    ]
    assert VehiclePlanes.of(pe.Vehicle(one_side)).across["right"] == pytest.approx(-1.11)


def with_doors(doors, axles=True):
    """A van with more boxes by name, and where its axles are."""
    boxes = [van().triangles, *starmap(shapes.box, doors.values())]
    parts = np.repeat(np.arange(len(boxes)), [len(b) for b in boxes]).astype(np.int32)
    vehicle = pe.Vehicle(np.concatenate(boxes), parts, ("body", *doors), clearance=0.0)
    return vehicle, pe.Reference(-1.4, 0.3, 2.8) if axles else None


@pytest.mark.parametrize("name", DOORS)
def test_the_door_is_the_drivers(name):
    """A side door on his side, ahead of the rear axle; else what is needed is said."""
    doors, x = DOORS[name]
    planes = VehiclePlanes.of(*with_doors(doors))
    assert planes.along.get("door") == x
    if x is None:
        assert (
            all(part in planes.missing["door"] for part in doors)
            and "left" in planes.missing["door"]
        )
        return
    assert planes.found["door"] == {"code": "door", "parts": [[*doors][-1]]}
    kerb_left = VehiclePlanes.of(*with_doors(doors), near_side="left")
    assert kerb_left.along.get("door") == (x if "both" in name else None)
    assert "rear axle" in VehiclePlanes.of(*with_doors(doors, axles=False)).missing["door"]


def test_places_are_measured_outwards_from_outer_planes():
    planes = VehiclePlanes.of(van(), eyes=1.2)
    at = [
        planes.coordinate(axis, place, "right", "test", field="x")
        for axis, place in (
            (0, "front + 0.8"),
            (0, "rear + 0.3"),
            (0, "front - 6"),
            (0, "25 %"),
            (0, "eyes - 4"),
            (1, "left + 0.5"),
            (1, "near + 0.9"),
            (1, "off + 1"),
            (1, "75 % + 0.1"),
            (1, -1.5),
        )
    ]
    assert at == [3.3, -2.8, -3.5, -1.25, -2.8, 1.5, -1.9, 2.0, 0.6, -1.5]


def test_samples_cover_a_zone_at_its_step_and_none_is_in_the_vehicle():
    placed = Zone(x=("front - 1", "front + 1"), y=("right", "left"), step=0.15).placed(
        van(), None, "zone"
    )
    points, distance = placed.samples()
    inside = points[distance <= 1e-6]
    assert 2.5 < inside[:, 0].min() < 2.65 and inside[:, 0].max() == 3.5
    assert np.diff(np.unique(inside[:, 0])).max() <= 0.15 + 1e-6
    assert np.diff(np.unique(inside[:, 1])).max() <= 0.15 + 1e-6
    assert len(inside) == 7 * 15
    assert distance.max() <= placed.grow + 1e-6 and (distance > 0).sum() > 0
    ring = Zone(ring=(0.3, 1.0), step=0.2).placed(van(), None, "ring")
    points, distance = ring.samples(grown=False)
    away = signed_distance(points, np.array([(-2.5, -1), (2.5, -1), (2.5, 1), (-2.5, 1)], float))
    assert away.min() >= 0.3 - 1e-6 and away.max() <= 1.0 + 1e-6 and away.max() > 0.99


def test_margins_by_hand():
    """Rows of samples at 0.1 m: the zone has those at 0 and below."""
    distance = np.array([-0.2, -0.1, 0.0, 0.1, 0.2, 0.3])
    rows = {
        (1, 1, 1, 1, 1, 1): (0.6, True),  # as far as was looked
        (1, 1, 1, 1, 1, 0): (0.2, False),  # the row before is the last that is sure
        (1, 1, 1, 0, 1, 1): (0.0, False),
        (1, 1, 0, 1, 1, 1): (-0.1, False),
        (1, 0, 1, 1, 1, 1): (-0.2, False),
        (0, 1, 1, 1, 1, 1): (-0.3, False),  # nothing is left of it
    }
    found = {
        row: margin_of(distance, np.array(row, bool), wanted=1.0, step=0.1, looked=0.6)
        for row in rows
    }
    assert found == rows
    # half of the samples is enough: up to 0.2 m there are 3 of 5, all six are 3 of 6
    assert margin_of(
        distance, np.array([1, 1, 1, 0, 0, 0], bool), wanted=0.5, step=0.1, looked=0.6
    ) == (0.6, True)
    assert margin_of(
        distance, np.array([1, 1, 1, 0, 0, 0], bool), wanted=0.6, step=0.1, looked=0.6
    ) == (0.2, False)
