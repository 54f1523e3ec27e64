"""Blind ground by hand, and the regions and outlines that it is made of."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.geometry.grids import GroundGrid
from pe_core.scoring.sight import Sight
from pe_core.scoring.sight.blind_ground import (
    BODY_M,
    NARROW_M,
    SECTOR_RADIUS_M,
    SECTOR_RING_M,
    SIDES,
    STEP_M,
    TOO_FAR_M,
    BlindSearch,
    blind_ground,
    sector_cells,
    shown_end,
    shown_reach,
    shown_start,
)
from pe_core.scoring.sight.ground_cells import GroundCells, gauss, opened, outlines, without_specks
from pe_core.sensors import CAMERA, GroundView
from pe_core.sensors.kernels import DefinedGround
from tests.engine import shapes

SPACE = pe.PerceptionSpace((-15, 15), (-15, 15), (0, 2), 0.1)
BOX = pe.Vehicle(shapes.box((-2.0, -0.5, 0.0), (2.0, 0.5, 1.0)))
X = Y = np.linspace(-5.0, 5.0, 101)


def cone_lidar(lowest_deg=-45.0, height=2.0, position=(0.013, 0.017)):
    """Channels a quarter of a degree apart from the lowest one up: no gap on the ground nearby."""
    elevations = np.radians(np.arange(lowest_deg, 0.0, 0.25))
    model = pe.Lidar("cone", elevations, 720, 60.0)
    return pe.Sensor("cone", model, pe.Pose((*position, height)))


@pytest.mark.parametrize("height", [0.0, 0.07, 0.1, 0.5, 0.55, 1.0, 1.1, 1.5, 1.93])
def test_under_a_lidar_is_a_circle_as_wide_as_arithmetic_has_it(height):
    """45 degrees down from 2 m the lowest channel is at a height h where it is 2 - h away."""
    blind = Sight(SPACE, pe.Prior.road()).blind(pe.Rig([cone_lidar()]), height, within=3.0)
    radius = 2.0 - height
    if radius < BODY_M / 2.0:  # a body is wider
        assert blind.area == 0.0
        return
    (ring,) = blind.outlines
    away = np.hypot(*(ring - (0.013, 0.017)).T)
    assert radius <= away.min() + 1e-9 and away.max() <= radius + TOO_FAR_M
    assert signed_area(ring) == pytest.approx(blind.area, rel=0.02)
    assert math.pi * radius**2 <= blind.area <= math.pi * (radius + TOO_FAR_M) ** 2
    for way, (axis, sign) in SIDES.items():  # from a square of 2 m that stands for a body
        exact = max(radius + sign * (0.013, 0.017)[axis] - 1.0, 0.0)
        assert exact <= blind.zone[way] <= exact + TOO_FAR_M or exact < NARROW_M > blind.zone[way]
        assert blind.seen_from[way] == blind.zone[way]
        assert (blind.nearest[way] is None) == (blind.zone[way] == 0.0)


def test_of_what_is_taller_less_is_blind_without_steps():
    """Area shrinks evenly with height: no layer of voxels shows."""
    own = Sight(SPACE, pe.Prior.road())
    rig = pe.Rig([cone_lidar()])
    areas = [own.blind(rig, height=h, within=2.0).area for h in np.arange(0.3, 1.3, 0.04)]
    assert (np.diff(areas) < 0.0).all()
    exact = [math.pi * (2.0 - h) ** 2 for h in np.arange(0.3, 1.3, 0.04)]
    assert np.ptp(np.sqrt(areas) - np.sqrt(exact)) < 0.06


def test_what_stands_stands_on_the_ground():
    """In a space that begins below the ground nothing is asked of what is under it."""
    deep = pe.PerceptionSpace((-15, 15), (-15, 15), (-1, 2), 0.1)
    rig = pe.Rig([cone_lidar()])
    for height in (0.0, 1.0):
        areas = [Sight(s, pe.Prior.road()).blind(rig, height, 3.0).area for s in (SPACE, deep)]
        assert areas[0] == areas[1] > 1.0
    flat, under = (Sight(deep, pe.Prior.road()).blind(rig, h, 3.0) for h in (0.0, -0.5))
    assert under.area == flat.area and under.height == -0.5


def test_what_is_seen_at_its_foot_alone_is_seen():
    """Beams from 20 to 45 degrees down pass under 1.5 m from 1.4 m on; all round it stays seen."""
    elevations = np.radians(np.arange(-45.0, -20.0, 0.25))
    model = pe.Lidar("low", elevations, 720, 60.0)
    rig = pe.Rig([pe.Sensor("low", model, pe.Pose((0.013, 0.017, 2.0)))])
    blind = Sight(SPACE, pe.Prior.road()).blind(rig, height=1.5, within=2.5)
    assert math.pi * 0.5**2 <= blind.area <= math.pi * (0.5 + TOO_FAR_M) ** 2
    assert set(blind.zone.values()) == {0.0}


def test_a_camera_s_shadow_before_a_bonnet():
    """Over the box's front edge (x = 2, z = 1) from 2 m the ground shows from x = 4 on."""
    eye = pe.Camera("wide", 1920, 1080, math.radians(90.0))
    rig = pe.Rig([pe.Sensor("eye", eye, pe.Pose.from_degrees((0.0, 0.0, 2.0), (0, 30, 0)))])
    blind = Sight(SPACE, pe.Prior.road(), BOX).blind(rig)
    assert 2.0 <= blind.seen_from["front"] <= 2.0 + TOO_FAR_M
    assert blind.seen_from["rear"] is None and blind.seen_from["left"] is None
    nearest = blind.nearest["front"]
    assert nearest.distance == 0.0 and nearest.point == pytest.approx((2.0, 0.0), abs=0.06)
    assert blind.nearest["left"].point == pytest.approx((0.0, 0.5), abs=0.06)
    assert blind.nearest["right"].point == pytest.approx((0.0, -0.5), abs=0.06)
    assert blind.nearest["rear"].point == pytest.approx((-2.0, 0.0), abs=0.06)


@pytest.mark.parametrize(("rows", "zone"), [(1, 0.0), (2, 0.1), (3, 0.15)])
def test_a_speck_along_the_body_is_no_blind_ground_to_a_side(rows, zone):
    """Rows of 5 cm before the bonnet: narrower than 10 cm is none, and the rest is as it is."""
    cells = GroundCells.of(SPACE, 0.05)
    blind = np.zeros((len(cells.x), len(cells.y)), bool)
    blind[(cells.x > 2.0) & (cells.x < 2.0 + 0.05 * rows)] = True
    found = blind_ground(cells, blind, ((-2.0, 2.0), (-0.5, 0.5)), height=0.5, within=15.0)
    assert (found.zone["front"], found.seen_from["front"]) == (zone, zone)
    assert (found.nearest["front"] is None) == (zone == 0.0)


@pytest.mark.parametrize("side", [0.1, 0.25, 1.0])
def test_all_ground_within_is_searched_with_voxels_of_any_size(side):
    """A camera that looks up sees none of it; at most a column of voxels more is searched."""
    space = pe.PerceptionSpace((-15, 15), (-15, 15), (0, 2), side)
    up = (0.0, -90.0, 0.0)
    rig = pe.Rig([shapes.camera(position=(0.0, 0.0, 1.1), rotation=up)])
    area = Sight(space, pe.Prior.road(), BOX).blind(rig, 0.5, within=3.37).area
    exact, most = ((4.0 + 2.0 * far) * (1.0 + 2.0 * far) for far in (3.37, 3.37 + side))
    assert exact - 4.0 <= area <= most - 4.0, "without what is below the box"


@pytest.mark.parametrize(("gap", "is_blind"), [(0.14, False), (0.31, True), (0.6, True)])
def test_a_gap_between_rings_is_none_until_a_body_fits_in(gap, is_blind):
    """Rings on the ground 5 cm apart, and two that are farther from each other, 3 m away."""
    near = np.arange(0.5, 3.01, 0.05)
    far = np.arange(3.0 + gap, 9.0, 0.05)
    elevations = -np.arctan(2.0 / np.concatenate([near, far]))
    model = pe.Lidar("gap", elevations, 720, 60.0)
    rig = pe.Rig([pe.Sensor("gap", model, pe.Pose((0.013, 0.017, 2.0)))])
    blind = Sight(SPACE, pe.Prior.road()).blind(rig, within=4.0)
    assert (blind.seen_from["front"] > 1.5) == is_blind
    assert (blind.area >= math.pi * ((3.0 + gap) ** 2 - 9.0) + 0.5) == is_blind
    assert blind.zone["front"] < 0.5  # the gap is beyond what is blind at the body


def test_a_lens_that_bends_and_a_definition_alone_see_the_same_ground():
    """The same pinhole as a lens of a round field; and a kind that has no kernel for ground."""
    pose = pe.Pose.from_degrees((2.1, 0.0, 0.9), (0, 25, 0))
    wide = pe.Camera("wide", 1920, 1080, math.radians(90.0))
    lens = pe.Pinhole(960.0, 960.0, 960.0, 540.0, fov=math.radians(175.0))
    round_ = pe.Camera("round", 1920, 1080, lens=lens)
    view = GroundView(GroundGrid((1.0, -2.0), (60, 80), 0.05), 0.5, BOX)
    one, other = (
        CAMERA.on_ground(view).mark(pe.Sensor("eye", model, pose)).marked
        for model in (wide, round_)
    )
    assert 500 < one.sum() < 4000 and np.array_equal(one, other)
    defined = DefinedGround(CAMERA.measure, view).mark(pe.Sensor("eye", wide, pose)).marked
    first = one[1::2, 1::2]  # where nothing is at an edge, every other square is asked about
    assert np.mean(first != defined[1::2, 1::2]) < 0.03


def test_shown_distances_are_rounded_to_the_worse_side():
    assert [shown_start(d) for d in (0.0, 1.29, 1.3)] == [0.0, 1.2, 1.3]
    assert [shown_end(d) for d in (0.0, 1.21, 1.3)] == [0.0, 1.3, 1.3]
    assert [shown_reach(d) for d in (0.0, 37.96, 38.0 - 1e-12)] == [0, 37, 38]


def flooded(flags):
    """Pieces connected by sides, found cell by cell."""
    left = {tuple(cell) for cell in np.argwhere(flags).tolist()}
    while left:
        todo = [left.pop()]
        piece = list(todo)
        while todo:
            i, j = todo.pop()
            for cell in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
                if cell in left:
                    left.remove(cell)
                    todo.append(cell)
                    piece.append(cell)
        yield piece


@pytest.mark.parametrize("radius", [0.0, 0.9, 1.0, 1.5, 2.3])
def test_opening_is_the_union_of_discs_that_fit(radius):
    rng = np.random.default_rng(2)
    flags = rng.random((15, 18)) < 0.85
    whole = np.pad(flags, 6, mode="edge")
    i, j = np.indices(whole.shape)
    union = np.zeros_like(whole)
    for at in np.argwhere(whole[3:-3, 3:-3]) + 3:
        disc = (i - at[0]) ** 2 + (j - at[1]) ** 2 <= radius**2
        if whole[disc].all():
            union |= disc
    assert np.array_equal(opened(flags, radius), union[6:-6, 6:-6])


@pytest.mark.parametrize("share", [0.3, 0.5, 0.6, 0.8])
def test_specks_are_pieces_of_few_cells(share):
    rng = np.random.default_rng(int(share * 10))
    for least in (0.5, 2, 5, 20):
        flags = rng.random((23, 31)) < share
        expected = np.zeros_like(flags)
        for piece in flooded(flags):
            if len(piece) >= least:
                expected[tuple(np.transpose(piece))] = True
        assert np.array_equal(without_specks(flags, least), expected)


def test_a_long_way_round_is_one_piece():
    """A spiral: its ends know nothing of each other but through all of it."""
    flags = np.zeros((41, 41), bool)
    i = j = 0
    for turn, length in enumerate(n for k in range(40, 1, -2) for n in (k, k)):
        di, dj = ((0, 1), (1, 0), (0, -1), (-1, 0))[turn % 4]
        for _ in range(length):
            flags[i, j] = True
            i = i + di
            j = j + dj
    assert len(list(flooded(flags))) == 1
    assert np.array_equal(without_specks(flags, flags.sum()), flags)
    assert not without_specks(flags, flags.sum() + 1).any()


def test_smoothing_is_a_gauss_curve_both_ways():
    values = np.zeros((21, 25))
    values[9, 12] = 1.0
    found = gauss(values, 2.0)
    i, j = np.indices(values.shape)
    square = (i - 9) ** 2 + (j - 12) ** 2
    near = (abs(i - 9) <= 4) & (abs(j - 12) <= 4)
    assert found == pytest.approx(np.where(near, np.exp(-square / 8.0), 0.0))
    assert np.array_equal(gauss(values, 0.4), values)


def signed_area(ring):
    x = ring[:, 0]
    y = ring[:, 1]
    return float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) / 2.0)


def lines_of(flags):
    return outlines(
        np.asarray(flags, dtype=float),
        0.5,
        np.arange(flags.shape[0], dtype=float),
        np.arange(flags.shape[1], dtype=float),
    )


def test_a_cone_is_cut_in_a_circle():
    cone = 3.0 - np.hypot(X[:, None], Y)
    (ring,) = outlines(cone, 1.0, X, Y)
    assert np.hypot(*ring.T) == pytest.approx(2.0, abs=0.003)
    assert np.array_equal(ring[0], ring[-1])
    assert signed_area(ring) == pytest.approx(4 * np.pi, rel=0.003)


def test_a_middle_that_is_inside_joins_two_corners():
    field = np.array([[-1.0, 3.0], [3.0, -1.0]])
    assert len(outlines(field, 0.0, np.arange(2.0), np.arange(2.0))) == 1
    assert len(outlines(-field, 0.0, np.arange(2.0), np.arange(2.0))) == 2
    hardly = np.array([[-1.0, 1.1], [1.1, -1.0]])
    assert len(outlines(hardly, 0.0, np.arange(2.0), np.arange(2.0))) == 1


def test_of_any_region_the_rings_are_closed_and_bound_its_area():
    """Of unit squares with corners cut off: each cell's area but for an eighth a corner or more."""
    rng = np.random.default_rng(5)
    for _ in range(30):
        flags = rng.random((12, 17)) < rng.random()
        padded = np.pad(flags, 2)
        rings = lines_of(padded)
        steps = [np.diff(ring, axis=0) for ring in rings]
        assert all(np.array_equal(ring[0], ring[-1]) for ring in rings)
        assert all((np.hypot(*step.T) < 1.01).all() for step in steps)
        area = sum(map(signed_area, rings))
        total = padded.astype(float)
        squares = total[:-1, :-1] + total[1:, :-1] + total[1:, 1:] + total[:-1, 1:]
        diagonal = (squares == 2) & (total[:-1, :-1] == total[1:, 1:])
        share = np.array([0.0, 0.125, 0.5, 0.875, 1.0])[squares.astype(int)]
        share[diagonal] = 0.25
        assert area == pytest.approx(share.sum())


@pytest.mark.parametrize("at", [(0.0, 0.0), (17.0, 3.0), (-30.0, 0.0)])
def test_near_the_circle_a_search_of_its_ring_finds_what_a_search_of_all_finds(at):
    """From within the ring's hole, from the ring itself, and from beyond it across the hole."""
    pose = pe.Pose((*at, 1.4), (0.03, 0.3, 0.4))
    rig = pe.Rig([pe.Sensor("a", pe.catalog.load("Pandar64"), pose)])
    cells = sector_cells()
    ring = SECTOR_RADIUS_M - SECTOR_RING_M, SECTOR_RADIUS_M + SECTOR_RING_M
    everywhere = BlindSearch.of(cells, 0.5, BOX, {}).blind(rig)
    near = BlindSearch.of(cells, 0.5, BOX, {}, ring=ring).blind(rig)
    on_circle = np.abs(np.hypot(cells.x[:, None], cells.y) - SECTOR_RADIUS_M) < 2.0 * STEP_M
    assert 0 < everywhere[on_circle].sum() < on_circle.sum()
    assert np.array_equal(near[on_circle], everywhere[on_circle])
