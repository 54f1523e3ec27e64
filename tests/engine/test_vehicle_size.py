"""Sizes that no vehicle has are refused, with the factor that would make one; others are not."""

import numpy as np
import pytest

import pe_core as pe
from tests.engine import shapes

CAR = np.array([4.5, 1.8, 1.5])
ROBOTS = {  # longest side first, as their makers print them [m]
    "TurtleBot3 Burger": (0.138, 0.178, 0.192),
    "Jackal": (0.508, 0.430, 0.250),
    "ANYmal": (0.93, 0.53, 0.89),
    "T 284 mining truck": (15.7, 9.7, 8.0),
    "bi-articulated bus": (30.0, 2.55, 3.3),
    "road train": (53.5, 2.5, 4.6),
}


def body(size, floor=None):
    """A study of a box of this size on the ground, perhaps on a floor so long."""
    low, high = np.array([-0.5, -0.5, 0.0]) * size, np.array([0.5, 0.5, 1.0]) * size
    triangles = shapes.box(low, high)
    parts, names = np.zeros(len(triangles), np.int32), ["body"]
    if floor is not None:
        ground = shapes.box((-floor / 2, -floor / 2, -0.1), (floor / 2, floor / 2, 0.0))
        triangles = np.concatenate([triangles, ground])
        parts, names = np.append(parts, np.ones(len(ground), np.int32)), ["body", "floor"]
    rig = pe.Rig([shapes.lidar_on_roof()])
    return pe.Study(rig, pe.Vehicle(triangles, parts, names), mesh="body.npz")


@pytest.mark.parametrize("size", ROBOTS.values(), ids=ROBOTS)
def test_real_vehicles_of_all_sizes_are_taken(size):
    assert body(np.array(size)).vehicle is not None


@pytest.mark.parametrize(
    ("unit", "metres", "factor"),
    [
        ("inches", 0.0254, "0.0254"),
        ("centimetres", 0.01, "0.01"),
        ("millimetres", 0.001, "0.001"),
    ],
)
def test_other_units_are_reported_with_their_factor(unit, metres, factor):
    with pytest.raises(pe.InputError) as caught:
        body(CAR / metres)
    assert f"; scale = {factor} if {unit} (4.50 m)" in str(caught.value)
    assert body(CAR / metres * float(factor)).vehicle is not None


def test_too_small_too_large_and_too_wide():
    """The car of a unit cube, the suv of a hangar's size, and a body as wide as it is long."""
    with pytest.raises(pe.InputError, match=r"0\.045 x .*scale = 100 if units of 100 m \(4\.5"):
        body(CAR / 100)
    with pytest.raises(pe.InputError, match=r"found 44\.00 x 84\.00 x 36\.00 m"):
        body(np.array([44.0, 84.0, 36.0]))
    with pytest.raises(pe.InputError, match="and up to 25 m wide"):
        body(np.array([50.0, 40.0, 10.0]))
    with pytest.raises(pe.InputError, match="all of it is one point"):
        body(np.zeros(3))


def test_a_floor_under_a_vehicle_does_not_make_it_one_too_large():
    assert body(CAR, floor=100.0).vehicle is not None
    with pytest.raises(pe.InputError, match="found 9000 x 9000 x"):
        body(CAR * 100, floor=9000.0)  # what of it is the floor cannot be told


def test_no_weight_outside_the_vehicle_names_the_mesh():
    space = pe.PerceptionSpace((-1.0, 1.0), (-0.5, 0.5), (0.0, 1.0), 0.5)
    study = body(CAR)
    study = pe.Study(study.rig, study.vehicle, space, mesh="body.npz")
    with pytest.raises(pe.InputError, match=r"none; body\.npz: 4\.50 x 1\.80 x 1\.50 m"):
        study.evaluator()
