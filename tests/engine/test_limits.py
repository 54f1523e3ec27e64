"""The least and the greatest values that are taken, and the next ones, which are not."""

import dataclasses
import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.base.values import numbers
from tests.engine import shapes

DEG = math.pi / 180.0
BOX = ("car", 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0)
OTHERS = {
    pe.ApCurve: {"a": 0.1, "b": 0.1},
    pe.Pose: {"position": (0, 0, 0)},
    pe.SurfaceMount: {"parts": ["a"]},
    pe.NoGo: {"name": "a"},
}
NEVER = [math.nan, np.float64("nan"), 10**400, 10**5000, True, np.True_, "1", "x" * 10**6]
"""What no setting takes, whatever it is of."""
FIGURE_LIMITS = (
    ("height", (1.0, True, None, {"value": 2.0, "kept": False}), (-1.0, False, {"kept": False})),
    ("entropy", (1.0, {"value": -2.0}), (True, math.nan, {"vale": 1.0}, {"value": 1.0, "kept": 1})),
    ("requirements", (True, None), (1.0, "keep", False)),
)


def lidar(**options):
    values = {"elevations": [0.0], "azimuth_count": 4, "max_range": 50.0} | options
    return pe.Lidar("mine", **values)


def camera(width=640, height=480, hfov=1.0):
    return pe.Camera("mine", width, height, hfov)


def cls(**changes):
    return dataclasses.replace(pe.Prior.road().classes[0], **changes)


def evaluator(**options):
    return pe.Evaluator(shapes.small_space(1.0), pe.Prior.uniform(), **options)


def space(**options):
    return pe.PerceptionSpace(
        **({"x": (0, 1), "y": (0, 1), "z": (0, 1), "interval": 0.5} | options)
    )


def vehicle(**options):
    return pe.Vehicle(shapes.box((0, 0, 0), (1, 1, 1)), **options)


# what is made, the option, values that are taken, values that are not
LIMITS = [
    (lidar, "azimuth_count", (1, 360_000, 1800.0), (0, -1, 360_001, 180.7, True, "4", None)),
    (lidar, "max_range", (1e-3, 1e5), (0.0, 1e-6, -1.0, 1.1e5, math.inf, math.nan, True, "50")),
    (lidar, "elevations", ([90 * DEG], [-90 * DEG]), ([90.001 * DEG], [-91 * DEG], [math.nan], [])),
    (
        lidar,
        "azimuth_offsets",
        ([180 * DEG], [-180 * DEG]),
        ([180.001 * DEG], [-181 * DEG], [math.inf], [0.0, 0.0]),
    ),
    (
        lidar,
        "horizontal_fov",
        ((-720 * DEG, 720 * DEG), (0.0, 0.0)),
        ((-721 * DEG, 0.0), (0.0, 721 * DEG), (0.1, 0.2), (0.0,), (0.0, math.nan), 1.0),
    ),
    (camera, "width", (1, 1_000_000), (0, 1_000_001, 100.9, True, -5)),
    (camera, "height", (1, 1_000_000), (0, 1_000_001, 100.9, True, -5)),
    (camera, "hfov", (0.0011 * DEG, 179.999 * DEG), (0.0009 * DEG, math.pi, 4.0, -1.0, math.nan)),
    (pe.ApCurve, "a", (1e-12, 1e3), (9e-13, 0.0, -1.0, 1.1e3, math.inf, math.nan, True, "x")),
    (pe.ApCurve, "b", (-1e3, 0.0, 1e3), (-1.1e3, 1.1e3, math.inf, math.nan, True, None)),
    (cls, "laplace_share", (0.0, 1.0), (-0.001, 1.001, math.nan)),
    (cls, "share", (0.0, 1e9), (-0.001, 1.1e9, math.inf)),
    (cls, "decay_x", (1e-6, 1e9), (0.0, -1.0, 1.1e9)),
    (cls, "lanes", ((-1e9,), (0.0, 1e9)), ((), (1.1e9,), (math.nan,))),
    (cls, "size", ((1.0, 1.0, 1.0),), ((1.0, 1.0), (1.0, 1.0, 0.0), (1.0, 1.0, 1.0, 1.0))),
    (pe.Focus, "factor", (0.0, 1e9), (-1.0, 1.1e9, math.inf, math.nan)),
    (evaluator, "samples", (0, 1024), (-1, 1, 1023, 2**24 + 1, 2000.5, True)),
    (pe.Search, "samples", (0, 1024, 2**24), (-1, 1023, 2**24 + 1, 2000.5, True)),
    (pe.Search, "seed", (0, 2**63 - 1), (-1, 2**63, 1.5)),
    (evaluator, "workers", (1, 1024), (-1, 1025, 1.5)),
    (evaluator, "shift", ((0.0, 0.0, 0.999),), ((0.0, 0.0, 1.0), (-0.1, 0.0, 0.0), (0.5, 0.5))),
    (space, "interval", (1e-3, 1.0), (9e-4, 0.3, 0.0, -0.5, math.nan, True)),
    (space, "x", ((-1e6, -1e6 + 1.0), (0, 1)), ((-1.1e6, 0), (1, 1), (2, 1), (0.0, math.inf))),
    (vehicle, "clearance", (0.0, 0.999), (-0.001, 1.0, math.nan)),
    (vehicle, "parts", ([0] * 12,), ([0] * 11, [1] * 12, [-1] * 12)),
    (pe.Schedule, "candidates", (1, 10_000_000), (0, 10_000_001, 2.5, True)),
    (pe.Pose, "position", ((0, 0, 1),), ((math.nan, 0, 0), (0, 0), (10**400, 0, 0))),
    (pe.Pose, "rpy", ((0, 0, 1),), ((math.nan, 0, 0), (0, 0))),
    (pe.Vehicle, "triangles", (np.zeros((1, 3, 3)),), ([[[math.nan] * 3] * 3], [[[10**400] * 3]])),
    (pe.Boxes.of, "table", ([BOX],), ([("car", math.nan, *BOX[2:])], [("car", True, *BOX[2:])])),
    (pe.Search, "limits", ({"a": {"x": (0, 1)}},), ({"a": {"x": (0, math.nan)}},)),
    (pe.SurfaceMount, "standoff", (0.0,), (-1.0, math.nan)),
    (pe.NoGo, "x", ((-1e9, 0.0),), ((-1e9, math.nan), (1.0, 0.0))),
    (pe.Mounting, "groups", ([],), ([1], [["a"]])),
    *((pe.Mounting, key, ({},), (1, math.nan)) for key in ("mounts", "on")),
    (pe.Mounting, "pairs", ([],), (1,)),
]


def is_taken(make, **options):
    try:
        make(**options)
    except pe.InputError as error:
        line = str(error)
        assert line.isprintable() and len(line) < 300
        return False
    return True


def test_limits():
    offenders = [
        (key, value)
        for make, key, good, bad in LIMITS
        for values, taken in ((good, True), ((*bad, *NEVER), False))
        for value in values
        if is_taken(make, **OTHERS.get(make, {}) | {key: value}) is not taken
    ]
    assert offenders == []


@pytest.mark.parametrize(("key", "good", "bad"), FIGURE_LIMITS)
def test_a_limit_is_a_number_true_or_a_table_of_both(key, good, bad):
    assert [value for value in good if not is_taken(pe.Limits, **{key: value})] == []
    assert [value for value in bad if is_taken(pe.Limits, **{key: value})] == []


def test_numbers_of_an_array():
    assert numbers([1, 2.5]).tolist() == [1.0, 2.5]
    assert numbers(np.array([[1, 2]], np.uint8)).tolist() == [[1.0, 2.0]]
    mixed = numbers([1, None, "2", True, 10**400])
    assert mixed[0] == 1.0 and np.isnan(mixed[1:4]).all()
    assert numbers(["1", "2"]) is None and numbers([True, False]) is None
    assert numbers([[1.0], [1.0, 2.0]]) is None and numbers([1j]) is None


def test_the_least_is_below_the_most():
    with pytest.raises(pe.InputError, match="small: min_range: expected a length below max_range"):
        shapes.small_lidar(max_range=5.0, min_range=5.0)
