"""Lenses that bend: the definition against dense rays, grid and sample against the definition."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.camera.lens_models import BrownConrady, FTheta, KannalaBrandt, Pinhole
from pe_core.sensors.camera.pixel_area import bent_pixel_area
from pe_core.sensors.camera.sample_areas import bent_pixel_areas
from pe_core.sensors.camera.tie_rules import axes_of
from tests.engine import shapes

RAYS = 1
"""Along a side of a pixel."""
SMALL = {
    "brown": BrownConrady(
        232.0, 232.0, 240.0, 135.0, k1=-0.25, k2=0.12, p1=1e-3, p2=-2e-3, k3=-0.02
    ),
    "fisheye": KannalaBrandt(110.0, 112.0, 250.0, 150.0, None, -0.02, 0.001),
    "circle": KannalaBrandt(70.0, 70.0, 250.0, 150.0, math.radians(190.0), -0.02, 0.001),
    "f-theta": FTheta(1.0, 1.0, 240.0, 135.0, None, 127.0, -12.0, 18.0, -2.7),
}
POSE = (2.1, 0.3, 1.1), (3.0, 20.0, 50.0)
CAR = shapes.box_car()
SPACE = pe.PerceptionSpace((-5, 6), (-4, 4), (0, 2), 0.25)


def camera(lens, scale=1.0, **options):
    return pe.Camera("mine", round(480 * scale), round(270 * scale), lens=lens, **options)


def sensor(lens, **options):
    return pe.Sensor("eye", camera(SMALL[lens], **options), pe.Pose.from_degrees(*POSE))


def by_rays(model, offsets, side):
    """Pixels of cubes by rays through RAYS x RAYS places of every pixel."""
    u, v = (np.arange(n * RAYS) + 0.5 for n in (model.width, model.height))
    places = [w.ravel() / RAYS for w in np.meshgrid(u, v)]
    rays = model.projection.unproject(*places)
    rays = rays[~np.isnan(rays[:, 0])]
    found = []
    for offset in offsets:
        least = math.cos(math.asin(min(1.0, side * 0.87 / np.linalg.norm(offset))))
        near = rays[rays @ offset >= least * np.linalg.norm(offset)]
        t0, t1 = (offset - side / 2) / near, (offset + side / 2) / near
        enter, leave = np.minimum(t0, t1).max(axis=1), np.maximum(t0, t1).min(axis=1)
        found.append(np.count_nonzero((enter < leave) & (leave > 0.0)))
    return np.array(found) / RAYS**2


@pytest.mark.parametrize("lens", SMALL)
def test_areas_are_those_of_dense_rays(lens):
    """Within 2 % of a cube from two sides on, cut or not, and 0.3 % of all: rays miss as much."""
    model, rng = camera(SMALL[lens]), np.random.default_rng(8)
    way = rng.normal(size=(8, 3))
    way[:, 0] = np.abs(way[:, 0]) + 0.5
    offsets = way / np.linalg.norm(way, axis=1)[:, None] * rng.uniform(2.0, 5.0, (8, 1))
    area, rays = bent_pixel_area(model, np.eye(3), offsets, 1.0), by_rays(model, offsets, 1.0)
    seen = rays > 600.0
    assert np.count_nonzero(seen) > 3
    np.testing.assert_allclose(area[seen], rays[seen], rtol=0.02)
    assert area.sum() == pytest.approx(rays.sum(), rel=0.003)


def test_a_lens_that_bends_nothing_is_a_pinhole():
    straight = Pinhole(232.0, 240.0, 250.0, 120.0)
    bent = Pinhole(232.0, 240.0, 250.0, 120.0, math.radians(150.0))
    index = np.stack(np.unravel_index(np.arange(SPACE.size), SPACE.shape), axis=1)
    centers, pose = SPACE.center_of(index), pe.Pose.from_degrees(*POSE)
    one, other = (
        pe.measure(pe.Sensor("eye", camera(lens), pose), centers, SPACE.interval, CAR)
        for lens in (straight, bent)
    )
    ahead = one > 0.0  # the pinhole leaves out what a corner of is behind
    assert np.count_nonzero(ahead) > 300
    np.testing.assert_allclose(other[ahead], one[ahead], rtol=1e-6, atol=1e-4)


def test_a_camera_sees_between_its_ranges_alone():
    """A depth camera of 6 m: voxel centres at 6.05 m are out, at 5.95 m in."""
    model = pe.Camera("depth", 640, 480, math.radians(90.0), min_range=0.4, max_range=6.0)
    own = pe.Sensor("eye", model, pe.Pose((0.0, 0.0, 0.0)))
    centers = [[0.35, 0.0, 0.0], [0.45, 0.0, 0.0], [5.95, 0.0, 0.0], [6.05, 0.0, 0.0]]
    assert (pe.measure(own, centers, 0.1) > 0.0).tolist() == [False, True, True, False]


def by_patches(model, axes, offset, side, count=100):
    """Pixels of a cube by its sides in count x count patches, each as its projected corners.

    A patch counts where its middle is in the picture and in the field.
    """
    lens, ends, found = model.projection, np.linspace(-0.5, 0.5, count + 1) * side, 0.0
    for axis in np.flatnonzero(np.abs(offset) > side / 2.0):
        a, b = np.meshgrid(ends, ends, indexing="ij")
        points = np.empty((*a.shape, 3))
        points[..., axis] = offset[axis] - np.sign(offset[axis]) * side / 2.0
        points[..., (axis + 1) % 3] = offset[(axis + 1) % 3] + a
        points[..., (axis + 2) % 3] = offset[(axis + 2) % 3] + b
        corners = points @ axes
        x, y = lens.project(*np.moveaxis(corners, -1, 0))
        across = (x[1:, 1:] - x[:-1, :-1], y[1:, 1:] - y[:-1, :-1])
        other = (x[:-1, 1:] - x[1:, :-1], y[:-1, 1:] - y[1:, :-1])
        areas = np.abs(across[0] * other[1] - across[1] * other[0]) / 2.0
        middle = (corners[1:, 1:] + corners[:-1, :-1]) / 2.0
        u, v = lens.project(*np.moveaxis(middle, -1, 0))
        theta = np.arctan2(np.hypot(middle[..., 1], middle[..., 2]), middle[..., 0])
        seen = (theta < lens.edge) & (u > 0) & (u < model.width) & (v > 0) & (v < model.height)
        found += float(areas[seen].sum())
    return found


CATALOGUE = ("WoodScape surround view", "PandaSet front", "PandaSet wide")
OFF, CUT_OFF = 0.005, 0.001
"""How far areas may be off: of themselves, and of a face on the lens's axis where they are cut."""


def around_the_edge(lens, side, rng):
    """Directions (24, 3) to cubes 1 m away: in the field, on and across its edge, level by it.

    Where the picture ends before the field does, as far from the axis as its corner.
    """
    corner = float(lens.unproject(np.zeros(1), np.zeros(1))[0, 0])
    edge = lens.edge if math.isnan(corner) else math.acos(corner)
    inside, across = rng.uniform(0.0, edge, 6), edge + rng.uniform(-1.5, 0.7, 6) * side
    level = edge - np.linspace(0.01, 0.25, 12)
    theta = np.r_[inside, across, level]
    turn = np.r_[rng.uniform(0.0, 2.0 * math.pi, 12), np.tile([0.0, math.pi], 6)]
    aside = np.sin(theta)
    return np.stack([np.cos(theta), aside * np.cos(turn), aside * np.sin(turn)], axis=1)


@pytest.mark.parametrize("name", CATALOGUE)
@pytest.mark.parametrize("away", [1.5, 6.0, 15.1, 30.0])
def test_areas_keep_to_the_tolerance_that_the_page_states(name, away):
    """Definition and sample, in the field and across its edge, near a fold as well."""
    model, rng = pe.catalog.load(name), np.random.default_rng(int(away))
    pose = pe.Pose.from_degrees((0.0, 0.0, 0.0), rng.uniform(-180.0, 180.0, 3))
    axes, side = axes_of(pose), 1.0 / away
    offsets = around_the_edge(model.projection, side, rng) @ axes.T
    exact = np.array([by_patches(model, axes, offset, side) for offset in offsets])
    defined = bent_pixel_area(model, axes, offsets, side)
    sampled = bent_pixel_areas(model, pose, offsets, side, None)
    assert np.count_nonzero(exact) >= 3
    lens = model.projection
    face = lens.fx * lens.fy * float(lens.slope(np.array(1e-6))) ** 2 * side**2
    for found in (defined, sampled):
        np.testing.assert_allclose(found, exact, rtol=OFF, atol=CUT_OFF * face)
