"""Which voxels the vehicle hides on the grid, against a ray to each of them."""

from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.geometry.poses import dot
from pe_core.geometry.ray_traversal import TriangleTree
from pe_core.geometry.raycast import VisibleTriangles
from pe_core.sensors.camera import grid_areas
from pe_core.sensors.camera.voxel_occlusion import VoxelOcclusion
from tests.engine import shapes
from tests.engine.kernels import on_grid

ASSETS = Path(pe.__file__).parents[1] / "blend_assets"
SPACE = pe.PerceptionSpace((-16, 16), (-8, 8), (0, 4), 0.2)
ALWAYS = -1
NEVER = np.inf
"""Rays from which on the cover is asked."""
ALL_ROUND = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])


def shipped(name):
    return pt.read_mesh(ASSETS / f"{name}.npz").triangles


def roof():
    """Two triangles a side: one quad, seen at a grazing angle."""
    corners = np.array([[-5.0, -1.2, 3.0], [5, -1.2, 3], [5, 1.2, 3], [-5, 1.2, 3]])
    return corners[[[0, 1, 2], [0, 2, 3]]]


def lattice():
    """Corners at even steps, so that rays to voxels run through corners and along edges."""
    return shapes.refined(shapes.box((-2.0, -1.0, 0.2), (2.0, 1.0, 1.4)), 3)


def turned():
    """The same with every other triangle wound the other way, and one missing on top."""
    triangles = lattice()
    triangles[::2] = triangles[::2, ::-1]
    return np.delete(triangles, np.argmax(triangles[:, :, 2].min(axis=1)), axis=0)


CASES = {
    "bonnet": (lambda: shipped("sedan"), (0.6, 0.0, 1.3), (0, 4, 0), 60),
    "bonnet below the picture": (lambda: shipped("sedan"), (0.6, 0.0, 1.5), (0, 4, 0), 60),
    "inside the sedan": (lambda: shipped("sedan"), (0.2, 0.3, 1.1), (0, 0, 90), 100),
    "mirror": (lambda: shipped("bus"), (2.9, 1.2, 1.8), (0, 3, 175), 60),
    "quad, along its side": (roof, (-4.9, 1.2, 3.05), (0, 2, 0), 60),
    "lattice": (lattice, (0.1, 0.1, 1.5), (0, 8, 0), 90),
    "lattice, on its side": (lattice, (-0.3, -0.1, 1.6), (90, 0, -75), 110),
    "turned": (turned, (0.1, 0.1, 1.5), (0, 15, 45), 100),
    "down": (lattice, (0.2, 0.2, 2.6), (10, 85, 5), 60),
    "from outside": (lattice, (-7.0, 5.0, 2.0), (0, 5, -40), 60),
}


def aimed(offsets):
    """What rays to voxels of SPACE aim at: by the tie rule, a little nearer along each axis."""
    nearer = 0.2e-8 * np.sqrt([5.0, 11.0, 26.0])
    return offsets - np.where(offsets > -1e-6, nearer, -nearer)


def hidden_by_rays(triangles, offsets):
    distance = np.sqrt(dot(offsets, offsets))
    seen = VisibleTriangles(TriangleTree(triangles), np.zeros(3))
    hits = seen.first_hit(offsets / distance[:, None])
    return hits.distance < distance


@pytest.mark.parametrize("case", CASES)
def test_hidden_voxels_are_those_whose_ray_is_stopped(case, monkeypatch):
    """Without the cover and with it, whose areas are the same to the bit."""
    mesh, position, rotation, hfov = CASES[case]
    vehicle = pe.Vehicle(mesh())
    sensor = shapes.camera(float(hfov), position, rotation)
    free = on_grid(sensor, SPACE, None, 20).reshape(-1)
    count = counted(monkeypatch)
    areas = []
    for many in (NEVER, ALWAYS):
        monkeypatch.setattr(grid_areas, "MANY_RAYS", many)
        count["evaluated"] = 0
        areas.append(on_grid(sensor, SPACE, vehicle, 20).reshape(-1))
        assert (count["evaluated"] == 8) == (many == ALWAYS)
    area = areas[0]
    assert area.tobytes() == areas[1].tobytes()
    seen = np.flatnonzero(free)
    index = np.stack(np.unravel_index(seen, SPACE.shape), axis=1)
    aims = aimed(SPACE.center_of(index) - np.asarray(position))
    origin = vehicle.seen_from(position).seen.origin
    hidden = hidden_by_rays(vehicle.triangles - origin, aims)
    assert 3 < hidden.sum() < len(hidden)
    assert (area[seen[hidden]] == 0).all()
    assert area[seen[~hidden]].tobytes() == free[seen[~hidden]].tobytes()


def counted(monkeypatch):
    """Count how often the cover is asked, and how many rays are cast."""
    count = {"evaluated": 0, "cast": 0}
    evaluator = VoxelOcclusion.classify
    hidden = grid_areas.hidden

    def count_evaluated(*args):
        count["evaluated"] += 1
        return evaluator(*args)

    def count_cast(seen, offsets):
        count["cast"] += len(offsets)
        return hidden(seen, offsets)

    monkeypatch.setattr(VoxelOcclusion, "classify", count_evaluated)
    monkeypatch.setattr(grid_areas, "hidden", count_cast)
    return count


def shade_of(triangles, position, corners):
    """Over the whole space, with the picture's corners given."""
    offsets = [SPACE.centers(k) - position[k] for k in range(3)]
    seen = pe.Vehicle(triangles, clearance=0.0).seen_from(position)
    flags = VoxelOcclusion(offsets, seen, corners).classify(slice(0, 160), slice(0, 80))
    grid = np.stack(np.meshgrid(*offsets, indexing="ij"), axis=-1).reshape(-1, 3)
    return flags, grid


@pytest.mark.parametrize("mesh", [roof, lattice, turned, lambda: shipped("bus")])
@pytest.mark.parametrize("position", [(0.05, 0.15, 3.05), (0.1, 0.1, 1.5), (-3.3, 1.4, 2.0)])
def test_what_is_sure_is_so_all_round(mesh, position):
    """Every voxel of the space, in view or not."""
    triangles = mesh()
    flags, grid = shade_of(triangles, position, ALL_ROUND)
    hidden = hidden_by_rays(triangles - np.array(position), grid)
    sure = flags.hidden.reshape(-1)
    unsure = flags.unsure.reshape(-1)
    assert hidden[sure].all()
    assert not hidden[~sure & ~unsure].any()
    assert not (sure & unsure).any()


def fan(corner):
    """Six triangles round a corner, level, 0.2 m to their outer ones."""
    angle = np.linspace(0.0, 2.0 * np.pi, 7)[:-1]
    rim = np.round(np.stack([0.2 * np.cos(angle), 0.2 * np.sin(angle), 0.0 * angle], axis=1), 2)
    rim = corner + rim
    return np.stack([np.broadcast_to(corner, (6, 3)), rim, np.roll(rim, -1, axis=0)], axis=1)


@pytest.mark.parametrize("corner", [(1.9, 0.6, -0.4), (0.6, 1.9, -0.4), (-1.9, 0.6, -0.4)])
def test_rays_that_slip_between_triangles_at_a_corner_are_not_overlooked(corner):
    """Some rays through the corner itself meet none of the six, by rounding: so they are cast."""
    tenths = [np.arange(-200, 201), np.arange(-200, 201), np.arange(-50, 0)]
    offsets = [np.round(0.1 * n, 1) for n in tenths]
    aligned = np.round(np.multiply.outer(np.arange(2, 11), corner), 1)
    slips = ~hidden_by_rays(fan(corner), aligned)
    seen = pe.Vehicle(fan(corner), clearance=0.0).seen_from((0.0, 0.0, 0.0))
    flags = VoxelOcclusion(offsets, seen, ALL_ROUND).classify(slice(0, 401), slice(0, 401))
    i, j, k = (np.searchsorted(w, aligned[:, a] - 0.05) for a, w in enumerate(offsets))
    assert flags.unsure[i, j, k].all() and not flags.hidden[i, j, k].any()
    assert flags.hidden.sum() > 1000
    assert slips.any() or corner != (1.9, 0.6, -0.4)
