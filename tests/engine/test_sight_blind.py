"""Blind ground: cones and shadows that a hand can work out, gaps, sides."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.sight import Sight
from tests.engine import shapes
from tests.engine.test_sight_outline import signed_area

SPACE = pe.PerceptionSpace((-15, 15), (-15, 15), (0, 2), 0.1)
BOX = pe.Vehicle(shapes.box((-2.0, -0.5, 0.0), (2.0, 0.5, 1.0)))


def cone_lidar(lowest_deg=-45.0, height=2.0, position=(0.013, 0.017)):
    """Channels a quarter of a degree apart from the lowest one up: no gap on the ground."""
    elevations = np.radians(np.arange(lowest_deg, 0.0, 0.25))
    model = pe.Lidar("cone", elevations, 720, 60.0)
    return pe.Sensor("cone", model, pe.Pose((*position, height)))


def test_under_a_lidar_is_a_circle():
    """45 degrees down from 2 m the lowest channel enters the voxels of the ground at 1.9 m.

    Columns are seen as soon as it meets a corner of them: the middles of those that are not lie 5
    to 7 cm nearer.
    """
    blind = Sight(SPACE, pe.Prior.road()).blind(pe.Rig([cone_lidar()]), within=9.0)
    (ring,) = blind.outlines
    assert np.hypot(*ring.T) == pytest.approx(1.84, abs=0.1)
    assert signed_area(ring) == pytest.approx(math.pi * 1.84**2, rel=0.02)
    assert blind.area == pytest.approx(math.pi * 1.84**2, rel=0.02)
    for side in ("front", "rear", "left", "right"):  # from a square of 2 m that stands for a body
        assert blind.nearest[side].distance == 0.0
        assert blind.seen_from[side] == pytest.approx(0.9, abs=0.11)
        assert blind.zone[side] == blind.seen_from[side]


def test_of_what_is_tall_less_is_blind():
    """The top of what is 1 m tall, the layer up to 1.1 m, is entered at 0.9 m: so 0.84 m."""
    own, rig = Sight(SPACE, pe.Prior.road()), pe.Rig([cone_lidar()])
    blind = own.blind(rig, height=1.0)
    assert blind.height == 1.0
    assert blind.area == pytest.approx(math.pi * 0.84**2, rel=0.05)
    areas = [own.blind(rig, height=h).area for h in (0.0, 0.5, 1.0, 1.8)]
    assert areas == sorted(areas, reverse=True) and areas[0] > areas[-1]


def test_what_stands_stands_on_the_ground():
    """In a space that begins below the ground nothing is asked of what is under it."""
    deep = pe.PerceptionSpace((-15, 15), (-15, 15), (-1, 2), 0.1)
    rig = pe.Rig([cone_lidar()])
    for height in (0.0, 1.0):
        areas = [Sight(s, pe.Prior.road()).blind(rig, height).area for s in (SPACE, deep)]
        assert areas[0] == pytest.approx(areas[1], rel=0.03) and areas[0] > 1.0


def test_what_is_seen_at_its_foot_alone_is_seen():
    """Beams from 20 to 45 degrees down pass under 1.5 m from 1.4 m on; all round it stays seen."""
    elevations = np.radians(np.arange(-45.0, -20.0, 0.25))
    model = pe.Lidar("low", elevations, 720, 60.0)
    rig = pe.Rig([pe.Sensor("low", model, pe.Pose((0.013, 0.017, 2.0)))])
    blind = Sight(SPACE, pe.Prior.road()).blind(rig, height=1.5, within=3.0)
    assert blind.area < 1.0 and set(blind.zone.values()) == {0.0}


def test_a_camera_s_shadow_before_a_bonnet():
    """Over the box's front edge (x = 2, z = 1) from 2 m: voxels at 5 cm show from x = 3.9 on."""
    eye = pe.Camera("wide", 1920, 1080, math.radians(90.0))
    rig = pe.Rig([pe.Sensor("eye", eye, pe.Pose.from_degrees((0.0, 0.0, 2.0), (0, 30, 0)))])
    blind = Sight(SPACE, pe.Prior.road(), BOX).blind(rig)
    assert blind.seen_from["front"] == pytest.approx(1.9, abs=0.11)
    assert blind.seen_from["rear"] is None and blind.seen_from["left"] is None
    nearest = blind.nearest["front"]
    assert nearest.distance == 0.0 and nearest.point == pytest.approx((2.0, 0.0), abs=0.06)
    assert blind.nearest["left"].point == pytest.approx((0.0, 0.5), abs=0.06)
    assert blind.nearest["right"].point == pytest.approx((0.0, -0.5), abs=0.06)
    assert blind.nearest["rear"].point == pytest.approx((-2.0, 0.0), abs=0.06)


def test_the_nearest_place_is_before_the_middle_of_the_body():
    aside = pe.Vehicle(shapes.box((1.0, 0.2, 0.0), (3.0, 1.2, 1.0)))
    up = pe.Lidar("up", np.radians([80.0, 85.0]), 36, 60.0)
    rig = pe.Rig([pe.Sensor("up", up, pe.Pose((2.0, 0.7, 1.9)))])
    blind = Sight(SPACE, pe.Prior.road(), aside).blind(rig)
    points = {side: spot.point for side, spot in blind.nearest.items()}
    assert points["front"] == pytest.approx((3.0, 0.7), abs=0.06)
    assert points["left"] == pytest.approx((2.0, 1.2), abs=0.06)
    assert set(blind.seen_from.values()) == set(blind.zone.values()) == {None}


def test_the_vehicle_s_own_footprint_is_not_blind():
    """A ring of LiDARs round the box sees everything up to its skin."""
    places = ((2.3, 0.0), (-2.3, 0.0), (0.0, 0.8), (0.0, -0.8), (2.3, 0.8), (-2.3, -0.8))
    lidars = [cone_lidar(-89.0, 0.5, place) for place in (*places, (-2.3, 0.8), (2.3, -0.8))]
    rig = pe.Rig(
        [pe.Sensor(f"lidar {n}", lidar.model, lidar.pose) for n, lidar in enumerate(lidars)]
    )
    blind = Sight(SPACE, pe.Prior.road(), BOX).blind(rig, within=1.0)
    assert blind.area == 0.0 and blind.outlines == ()
    assert set(blind.nearest.values()) == {None}
    assert set(blind.seen_from.values()) == set(blind.zone.values()) == {0.0}


def test_a_gap_between_rings_is_none_until_an_object_fits_in():
    """Two channels that meet the layer of the ground 3 m away, this far apart."""
    for gap, is_blind in ((0.15, False), (0.6, True)):
        ends = [3.0, 3.0 + 0.15 + gap]
        elevations = [-math.atan(2.0 / at) for at in ends]
        every = np.concatenate([elevations, -np.arctan(2.0 / np.arange(1.0, 2.9, 0.1))])
        further = -np.arctan(2.0 / np.arange(ends[1] + 0.1, 12.0, 0.1))
        model = pe.Lidar("gap", np.concatenate([every, further]), 720, 60.0)
        rig = pe.Rig([pe.Sensor("gap", model, pe.Pose((0.013, 0.017, 2.0)))])
        blind = Sight(SPACE, pe.Prior.road()).blind(rig, within=6.0)
        assert (blind.seen_from["front"] > 1.5) == is_blind
        assert blind.zone["front"] < 0.5  # the gap is beyond what is blind at the body


def test_mirrored_rigs_have_mirrored_blind_ground():
    own = Sight(SPACE, pe.Prior.road(), BOX)
    left = own.blind(pe.Rig([cone_lidar(-30.0, 1.5, (1.013, 0.217))]))
    right = own.blind(pe.Rig([cone_lidar(-30.0, 1.5, (1.013, -0.217))]))
    assert left.area == right.area > 0.0
    assert left.seen_from["left"] == pytest.approx(right.seen_from["right"])
    assert left.seen_from["right"] == pytest.approx(right.seen_from["left"])
    assert left.seen_from["left"] == pytest.approx(2.42 + 0.217 - 0.5, abs=0.15)
    assert left.seen_from["right"] == pytest.approx(2.42 - 0.217 - 0.5, abs=0.15)


@pytest.mark.parametrize(
    ("asked", "line"),
    [
        ({"height": 2.0}, "sight: height: expected a height in the space"),
        ({"step": -0.1}, "sight: step: expected a length above 0 m, found -0.1"),
        ({"within": -1.0}, "sight: within: expected a length above 0 m, found -1"),
    ],
)
def test_what_cannot_be_looked_at_is_told_in_a_line(asked, line):
    with pytest.raises(pe.InputError, match=line):
        Sight(SPACE, pe.Prior.road()).blind(pe.Rig([cone_lidar()]), **asked)
