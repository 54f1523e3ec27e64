"""First hits to the bit those of every triangle tested, one ray after the other."""

from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.geometry import ray_traversal, raycast
from pe_core.geometry.poses import cross, dot
from pe_core.geometry.ray_traversal import TriangleTree
from pe_core.geometry.raycast import VisibleTriangles
from tests.engine import shapes
from tests.thorough import tries

ASSETS = Path(pe.__file__).parents[1] / "blend_assets"
RAYS = tries(150, 600)


def every_triangle(triangles, directions):
    """The definition: nearest of all triangles, of equals the lowest; rays from the origin."""
    a, b, c = (triangles[:, i] for i in range(3))
    edges = (cross(a, b), cross(b, c), cross(c, a))
    normal = cross(b - a, c - a)
    offset = dot(normal, a)
    best = np.full(len(directions), np.inf)
    which = np.full(len(directions), -1)
    for number, d in enumerate(directions):
        sides = np.stack([dot(e, d) for e in edges])
        toward = dot(normal, d)
        met = ((sides >= 0).all(axis=0) | (sides <= 0).all(axis=0)) & (toward != 0)
        distance = np.where(met, offset / np.where(toward == 0, 1.0, toward), np.inf)
        distance[distance <= 0] = np.inf
        if np.isfinite(distance).any():
            which[number] = np.argmin(distance)
            best[number] = distance[which[number]]
    return best, which


def directions_of(points):
    """Unit vectors to points that are not the origin."""
    size = np.sqrt(dot(points, points))
    return points[size > 0] / size[size > 0, None]


def rays_at(triangles, rng, count=RAYS):
    """All round; to corners, along edges, to their middles, and into the triangles."""
    some = triangles[rng.choice(len(triangles), min(count, len(triangles)), replace=False)]
    corner = some[:, 0]
    ahead = some[:, 1]
    aims = [
        rng.normal(size=(2 * count, 3)),
        corner,
        (corner + ahead) / 2,
        ahead - corner,
        some.mean(axis=1),
        corner * [1, 1, 0],
    ]
    axes = np.concatenate([np.eye(3), -np.eye(3), [[1, 1, 1], [1, -1, 0], [-1, 1, 1]]])
    return directions_of(np.concatenate([*aims, axes]))


def soup(rng):
    return rng.normal(0, 2, (300, 1, 3)) + rng.normal(0, 0.7, (300, 3, 3))


def slivers(rng):
    """Long thin triangles, down to a thinness of 1e-12."""
    start, along = rng.normal(0, 3, (2, 300, 3))
    aside = rng.normal(size=(300, 3)) * 10.0 ** rng.uniform(-12, -1, (300, 1))
    return np.stack([start, start + along, start + aside], axis=1)


def coincident(rng):
    """Each triangle three times: turned, and with its corners moved round."""
    one = soup(rng)[:80]
    return np.concatenate([one, one[:, ::-1], one[:, [1, 2, 0]]])


def edge_on(rng):
    """Triangles in planes that hold the origin, among others."""
    flat = rng.normal(0, 2, (90, 3, 3))
    for axis in range(3):
        flat[30 * axis : 30 * axis + 30, :, axis] = 0.0
    spread = rng.normal(size=(30, 3, 2)) @ rng.normal(size=(30, 2, 3))
    return np.concatenate([flat, spread, soup(rng)[:50]])


def lattice(rng):
    """A box of even steps: rays to its corners and edges are told apart by rounding alone."""
    return shapes.refined(shapes.box((-1.0, -0.6, -0.5), (1.4, 0.8, 0.7)), 3)


MESHES = {f.__name__: f for f in (soup, slivers, coincident, edge_on, lattice)}


def assert_same(triangles, directions):
    """Of rays followed one by one from the start, and of sorted ones: face by face, all at once."""
    mesh = VisibleTriangles(TriangleTree(triangles), np.zeros(3))
    distance, face = every_triangle(triangles, directions)
    for followed, on_a_strip in ((raycast.MANY, 0), (0, 0), (0, raycast.MANY)):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(raycast, "MAX_FOLLOWED", followed)
            patch.setattr(raycast, "MAX_ON_A_STRIP", on_a_strip)
            hits = mesh.first_hit(directions)
        assert hits.distance.tobytes() == distance.tobytes()
        assert hits.face.tolist() == face.tolist()
    return hits


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("seed", range(tries(1, 3)))
def test_hits_are_those_of_every_triangle_tested(mesh, seed):
    rng = np.random.default_rng(seed)
    triangles = MESHES[mesh](rng)
    hits = assert_same(triangles, rays_at(triangles, rng))
    assert np.count_nonzero(hits.face >= 0) > 50


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("few", [3, 10**9])
def test_rays_followed_by_themselves_hit_the_same(mesh, few, monkeypatch):
    """Some of the rays into some of the boxes, and all into all; many at once and one by one."""
    monkeypatch.setattr(raycast, "FINE", 0)
    monkeypatch.setattr(raycast, "FEW_RAYS", few)
    monkeypatch.setattr(raycast, "MIN_BOXES_TO_SORT", 2)
    monkeypatch.setattr(ray_traversal, "PAIRS_AT_ONCE", 100 if few == 3 else 1 << 11)
    rng = np.random.default_rng(4)
    triangles = MESHES[mesh](rng)[:283]  # no multiple of what a box holds
    hits = assert_same(triangles, rays_at(triangles, rng, 150))
    assert np.count_nonzero(hits.face >= 0) > 50


@pytest.mark.parametrize("distance", [0.03, 80.0])
def test_followed_rays_leave_no_gap_in_a_fine_mesh(distance):
    """More than ten triangles a ray; straight down is a corner, between boxes that end there."""
    rng = np.random.default_rng(6)
    triangles = shapes.refined(shapes.box((-2.0, -1.0, 0.0), (2.0, 1.0, 1.5)), 5)
    seen = triangles - [0.5, 0.25, 1.5 + distance]
    directions = rays_at(seen, rng, 60)
    assert len(triangles) > raycast.FINE * len(directions)
    hits = assert_same(seen, directions)
    assert np.count_nonzero(hits.face >= 0) > 100
    assert np.isfinite(hits.distance[(directions == [0.0, 0.0, -1.0]).all(axis=1)]).all()


def test_no_rays_and_no_triangles():
    none = VisibleTriangles(TriangleTree(np.zeros((0, 3, 3))), np.zeros(3))
    assert none.first_hit(np.eye(3)).face.tolist() == [-1, -1, -1]
    assert not len(none.first_hit(np.zeros((0, 3))).face)


@pytest.mark.parametrize("mesh", ["sedan", "bus"])
@pytest.mark.parametrize("up", [0.03, 0.4, -0.6, 8.0])
def test_a_frame_at_a_shipped_vehicle_is_that_of_every_triangle(mesh, up):
    """Of a Pandar64's beams some are tested; all are cast together, as a frame is."""
    vehicle = pe.Vehicle(pt.read_mesh(ASSETS / f"{mesh}.npz").triangles)
    seen = vehicle.seen_from(np.array([-0.4, 0.02, vehicle.bounds[1][2] + up]))
    directions = pe.catalog.load("Pandar64").directions
    hits = seen.first_hit(directions)
    some = np.random.default_rng(3).choice(len(directions), tries(100, 400), replace=False)
    own = vehicle.triangles - seen.seen.origin
    distance, face = every_triangle(own, directions[some])
    assert hits.distance[some].tobytes() == distance.tobytes()
    assert hits.face[some].tolist() == face.tolist()


def test_boxes_near_a_point_miss_no_triangle():
    rng = np.random.default_rng(0)
    triangles = soup(rng)
    tree = TriangleTree(triangles)
    for point in rng.normal(0, 2, (20, 3)):
        low = triangles.min(axis=1)
        high = triangles.max(axis=1)
        gap = np.maximum(np.maximum(low - point, point - high), 0.0)
        near = np.flatnonzero(dot(gap, gap) <= 0.3**2)
        assert set(near) <= set(tree.near(point, 0.3).tolist())
        assert len(tree.near(point, 0.3)) < 200


def test_a_vehicle_of_one_triangle_is_hit():
    """Its centre has no extent; the tree of its boxes is made all the same."""
    vehicle = pe.Vehicle(np.array([[(1.0, -1.0, -1.0), (1.0, 1.0, -1.0), (1.0, 0.0, 2.0)]]))
    hits = vehicle.first_hit((0.0, 0.0, 0.0), np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]))
    assert hits.distance.tolist() == [1.0, np.inf] and hits.face.tolist() == [0, -1]
