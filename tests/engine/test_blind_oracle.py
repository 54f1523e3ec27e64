"""Blind ground against rays: test bodies placed one by one, by code that shares none with it.

A body is an upright cylinder. Beams are lines from a LiDAR that end on a triangle of the vehicle;
the low part of one, from above, comes as near to a body's axis as a hand would work it out. A
camera sees a body where a ray to one of many points of it meets no triangle first.
"""

import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring.sight import Sight, blind_ground
from pe_core.scoring.sight.blind_ground import body_rectangle
from pe_core.scoring.sight.ground_cells import GroundCells, dilated, squares_touching, widened
from pe_tools.graphics import simplified
from pe_tools.verify import oracle
from tests.engine import shapes

ASSETS = Path(__file__).parents[2] / "blend_assets"
SPACE = pe.PerceptionSpace((-12, 12), (-10, 10), (0, 3), 0.1)
WITHIN_M = 2.5
RADIUS = 0.15
PLACES = 80
SURE_RADIUS = 0.07
"""What is blind lies within `FAR_M` of a hole in which nothing is seen, at least so large."""
FAR_M = 0.15 + SURE_RADIUS * math.sqrt(2.0)
VAN_RIG = [
    shapes.lidar_on_roof(shapes.small_lidar(24, 360), (0.37, 0.21, 2.63), (0.0, 3.0, 11.0), "roof"),
    shapes.camera(100.0, (2.53, 0.0, 0.93), (0.0, 18.0, 0.0), "front"),
    shapes.camera(120.0, (0.11, 1.02, 1.87), (0.0, 55.0, 90.0), "left"),
]
SEDAN_RIG = [
    shapes.lidar_on_roof(shapes.small_lidar(32, 360), (-0.43, 0.0, 1.8), name="roof"),
    shapes.camera(90.0, (-2.36, 0.0, 1.02), (0.0, 25.0, 180.0), "rear"),
]
BUS_RIG = [
    shapes.lidar_on_roof(shapes.small_lidar(16, 240), (3.03, 1.01, 0.91), (0.0, 1.2, 0.0), "a"),
    shapes.lidar_on_roof(shapes.small_lidar(16, 240), (-3.03, -1.01, 1.7), (2.0, 0.0, 30.0), "b"),
]
DISC = np.array(
    [(r * math.cos(a), r * math.sin(a)) for r in (0.0, 0.08, 0.155) for a in np.arange(0, 6.2, 0.5)]
)
"""Points of a body from above, a hair wider than it is."""
DISC_FINE = np.array(
    [
        (r * math.cos(a), r * math.sin(a))
        for r in np.linspace(0, 1, 6)
        for a in np.arange(0, 6.2, 0.5)
    ]
)
"""Places in a disc of radius 1."""
BEARINGS = np.arange(0.0, 360.0, 0.5)
FINE = pe.Lidar("fine", np.radians([-6.0, -4.5, -3.5, -2.5, -1.5, 0.0]), 2400, 60.0)
"""Its beams are 5 cm apart, 20 m away, so that no gap between them is blind."""
END_M = FAR_M + 0.01  # The circle is looked up at points 1 cm apart
SLANTED = {"picture's lower side"}
"""Cases with an edge that crosses the circle at a slant."""


def van():
    """A box 5 m long, 2 m wide and 2.4 m tall, with a bonnet before it."""
    return pe.Vehicle(
        np.concatenate(
            [
                shapes.box((-2.5, -1.0, 0.25), (1.6, 1.0, 2.4)),
                shapes.box((1.6, -1.0, 0.25), (2.5, 1.0, 1.1)),
            ]
        ),
        clearance=0.0,
    )


def from_assets(name):
    """An example vehicle of few triangles: rays are tested against each of them."""
    with np.load(ASSETS / f"{name}.npz") as file:
        few, _ = simplified(pe.Vehicle(file["triangles"]), 1000)
    a, b, c = few.triangles.transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return pe.Vehicle(few.triangles[area > 1e-9], clearance=0.0)


class LowBeams:
    """A LiDAR's beams from above, where they are between the ground and a height."""

    def __init__(self, sensor, height, vehicle, reach=20.0):
        way = sensor.model.directions @ oracle.rotation(sensor.pose.rpy).T
        self.start = np.array(sensor.pose.position)
        x, y, z = way.T
        with np.errstate(divide="ignore"):
            ends = np.sort([-self.start[2] / z, (height - self.start[2]) / z], axis=0)
        self.first = np.maximum(ends[0], 0.0)
        self.last = np.minimum(ends[1], 60.0)
        low = np.flatnonzero((self.first <= self.last) & (self.first * np.hypot(x, y) < reach))
        self.way = way[low]
        self.first = self.first[low]
        self.last = self.last[low]
        self.triangles = vehicle.triangles
        self.hits = np.full(len(low), np.nan)

    def away(self, points):
        """How far each point (N, 2) is from the nearest; beams are cast where it matters."""
        flat = self.way[:, None, :2]
        offset = points[None] - self.start[:2]
        length = (flat**2).sum(axis=-1)
        along = (offset * flat).sum(axis=-1) / np.maximum(length, 1e-12)
        near = np.hypot(*np.moveaxis(offset - along[..., None] * flat, -1, 0)) < 0.3
        new = np.flatnonzero(near.any(axis=1) & np.isnan(self.hits))
        self.hits[new] = oracle.first_hits(self.start, self.way[new], self.triangles)[0]
        last = np.fmin(self.last, self.hits)[:, None]
        on = np.minimum(np.maximum(along, self.first[:, None]), last)
        away = np.hypot(*np.moveaxis(offset - on[..., None] * flat, -1, 0))
        away[~near | (last < self.first[:, None])] = np.inf
        return away.min(axis=0)


class SeenPoints:
    """What a pinhole camera sees of bodies, point by point."""

    def __init__(self, sensor, height, vehicle):
        self.sensor = sensor
        self.vehicle = vehicle
        self.heights = np.linspace(0.0, height, 1 + math.ceil(height / 0.1))

    def sees(self, points):
        """Whether any point over (N, 2) up to the height is seen."""
        camera = self.sensor.model
        start = np.array(self.sensor.pose.position)
        z = np.broadcast_to(self.heights[:, None, None], (len(self.heights), len(points), 1))
        there = np.concatenate([np.broadcast_to(points, (*z.shape[:2], 2)), z], axis=-1)
        rays = there.reshape(-1, 3) - start
        depth, left, up = (rays @ oracle.rotation(self.sensor.pose.rpy)).T
        with np.errstate(divide="ignore", invalid="ignore"):
            wide = np.abs(left / depth) <= math.tan(camera.hfov / 2.0)
            tall = np.abs(up / depth) <= math.tan(camera.hfov / 2.0) * camera.height / camera.width
        asked = np.flatnonzero((depth > 0.0) & wide & tall)
        distance = np.sqrt((rays[asked] ** 2).sum(axis=1))
        hits, _ = oracle.first_hits(start, rays[asked] / distance[:, None], self.vehicle.triangles)
        seen = np.zeros(len(rays), bool)
        seen[asked] = hits >= distance
        return seen.reshape(len(self.heights), -1).any(axis=0)


class Oracle:
    """All sensors of a rig."""

    def __init__(self, rig, height, vehicle, *reach):
        beams = partial(LowBeams, reach=reach[0]) if reach else LowBeams
        kinds = {"lidar": beams, "camera": SeenPoints}
        self.looks = [kinds[s.kind](s, height, vehicle) for s in rig]

    def unseen(self, centers, radius):
        """Whether bodies of a radius at centres (N, 2) are seen by none."""
        found = np.ones(len(centers), bool)
        places = centers[:, None] + DISC * (radius / RADIUS)
        for look in self.looks:
            if isinstance(look, LowBeams):
                found &= look.away(centers) >= radius
            else:
                found &= ~look.sees(places.reshape(-1, 2)).reshape(len(centers), -1).any(axis=1)
        return found


class BlindMap:
    """What is told of blind ground: its squares, and those of the vehicle."""

    def __init__(self, vehicle, rig, height):
        view = Sight(SPACE, pe.Prior.road(), vehicle)
        self.told = view.blind(rig, height, WITHIN_M)
        body = body_rectangle(vehicle)
        cells = GroundCells.of(SPACE, blind_ground.STEP_M, widened(body, WITHIN_M))
        look = blind_ground.BlindSearch.of(cells, height, vehicle, {})
        self.blind = look.blind(rig)
        own = look.own[look.margin : -look.margin, look.margin : -look.margin]
        self.near_own = dilated(own, squares_touching(blind_ground.PARTLY_VISIBLE))
        self.own = own
        self.cells = cells
        assert self.told.area == pytest.approx(self.blind.sum() * blind_ground.STEP_M**2)

    def some_places(self, rng, count):
        """Places that are not the vehicle's; most of them along edges of what is blind."""
        edges = dilated(self.blind, [4] * 5) & dilated(~self.blind, [4] * 5)
        found = []
        for where, share in ((~self.own, 5), (edges & ~self.own, 1.25)):
            where = np.argwhere(where)
            i, j = where[rng.integers(len(where), size=int(count / share))].T
            found.append(np.stack([self.cells.x[i], self.cells.y[j]], axis=1))
        found = np.concatenate(found)
        return rng.permutation(found + rng.uniform(-0.025, 0.025, found.shape))

    def _at(self, flags, points):
        i, j = (
            np.floor((w - low[0]) / blind_ground.STEP_M).astype(int)
            for w, low in zip(points.T, (self.cells.x0, self.cells.y0), strict=True)
        )
        inside = (i >= 0) & (j >= 0) & (i < flags.shape[0]) & (j < flags.shape[1])
        return np.where(inside, flags[np.where(inside, i, 0), np.where(inside, j, 0)], True)

    def is_blind(self, points):
        """Whether points (N, 2) are told to be blind; those beyond are."""
        return self._at(self.blind, points)

    def beside_body(self, points):
        """Whether points are not the vehicle's, nor in the strip beside it."""
        return ~self._at(self.near_own, points)


CASES = {
    ("van", 0.0): (van, VAN_RIG),
    ("van", 0.5): (van, VAN_RIG),
    ("van", 1.2): (van, VAN_RIG),
    ("sedan", 0.5): (lambda: from_assets("sedan"), SEDAN_RIG),
    ("bus", 0.8): (lambda: from_assets("bus"), BUS_RIG),
}


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]} {case[1]:g} m")
def test_no_unseen_body_stands_where_nothing_is_reported_and_no_edge_is_far_out(case, monkeypatch):
    monkeypatch.setattr(blind_ground, "MIN_AREA_M2", 0.0)
    vehicle = CASES[case][0]()
    rig = pe.Rig(CASES[case][1])
    height = case[1]
    rng = np.random.default_rng(7)
    told = BlindMap(vehicle, rig, height)
    truth = Oracle(rig, height, vehicle)
    centers = told.some_places(rng, PLACES)
    unseen = centers[truth.unseen(centers, RADIUS)]
    assert PLACES / 20 < len(unseen) < PLACES * 0.95
    inside = (unseen[:, None] + DISC[None] * (0.149 / RADIUS)).reshape(-1, 2)
    assert told.is_blind(inside[told.beside_body(inside)]).all()
    blind_places = centers[told.is_blind(centers)]
    near = (blind_places[:16, None] + FAR_M * DISC_FINE).reshape(-1, 2)
    holes = truth.unseen(near, SURE_RADIUS) | ~told.beside_body(near)
    assert holes.reshape(16, -1).any(axis=1).all()


SECTORS = {
    "picture's lower side": (
        van,
        [shapes.camera(100.0, (2.53, 0.0, 1.5), (4.0, -32.0, 0.0), "front")],
        0.5,
    ),
    "cameras": (van, VAN_RIG[1:], 0.5),
    "lidar behind a box": (van, [shapes.lidar_on_roof(FINE, (1.8, 0.3, 1.4))], 1.0),
    "lidars at corners": (
        lambda: from_assets("bus"),
        [
            shapes.lidar_on_roof(FINE, (3.1, y, 1.7), name=name)
            for y, name in ((1.1, "a"), (0, "b"))
        ],
        1.5,
    ),
}


@pytest.mark.parametrize("case", SECTORS)
def test_the_widest_blind_sector_is_that_of_bodies_on_the_circle(case):
    """It is no smaller than the run of bearings at which a body is unseen; an unseen body can stand
    near both of its ends."""
    make, rig, height = SECTORS[case]
    vehicle = make()
    rig = pe.Rig(rig)
    found = {s.height: s for s in Sight(SPACE, pe.Prior.road(), vehicle).blind_sectors(rig)}
    truth = Oracle(rig, height, vehicle, blind_ground.SECTOR_RADIUS_M + 1.0)
    around = np.radians(BEARINGS)
    centers = blind_ground.SECTOR_RADIUS_M * np.stack([np.cos(around), np.sin(around)], axis=1)
    unseen = truth.unseen(centers, RADIUS)
    assert unseen.any() and not unseen.all()
    first = int(np.argmin(unseen))  # a body that is seen: runs do not go over the end
    runs = "".join("x" if each else " " for each in np.roll(unseen, -first)).split()
    step = BEARINGS[1]
    width = found[height].width
    longest = max(map(len, runs))
    assert (longest - 1) * step <= width
    assert width <= (longest + 1) * step + 2.0 or case in SLANTED
    middle = math.radians(found[height].bearing)
    for end in (middle - math.radians(width / 2.0), middle + math.radians(width / 2.0)):
        at = blind_ground.SECTOR_RADIUS_M * np.array([math.cos(end), math.sin(end)])
        assert truth.unseen(at + END_M * DISC_FINE / np.abs(DISC_FINE).max(), SURE_RADIUS).any()
    there = blind_ground.SECTOR_RADIUS_M * np.array([[math.cos(middle), math.sin(middle)]])
    assert truth.unseen(there, RADIUS - 0.01).all()


def test_a_rig_that_sees_all_round_has_no_blind_sector_and_one_that_sees_nothing_only_that():
    top = shapes.lidar_on_roof(FINE, (0.0, 0.0, 1.6), name="top")
    up = shapes.camera(60.0, (0.0, 0.0, 3.0), (0.0, -90.0, 0.0), "up")
    look = Sight(SPACE, pe.Prior.road())
    assert [s.width for s in look.blind_sectors(pe.Rig([top]))] == [0.0] * 3
    assert [s.width for s in look.blind_sectors(pe.Rig([up]))] == [360.0] * 3
