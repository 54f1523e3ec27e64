"""Self-occlusion, the height map, glass, and mounting clearance."""

import numpy as np
import pytest

import pe_core as pe
from pe_tools.verify import oracle
from tests.engine import shapes


def random_directions(rng, count):
    d = rng.normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


@pytest.mark.parametrize(
    "position", [(0, 0, 2.0), (-0.3, 0.2, 1.1), (3.0, 1.0, 0.5), (0, 0, 40.0), (-0.3, 0.1, 1.43)]
)
def test_first_hits_equal_brute_force(position):
    rng = np.random.default_rng(7)
    vehicle = shapes.box_car(times=2)
    directions = random_directions(rng, 4000)
    hits = vehicle.first_hit(position, directions)
    distance, face = oracle.first_hits(np.array(position, float), directions, vehicle.triangles)
    assert (np.isfinite(hits.distance) == np.isfinite(distance)).all()
    found = np.isfinite(distance)
    np.testing.assert_allclose(hits.distance[found], distance[found], atol=1e-4)
    assert (hits.face[~found] == -1).all()
    # an edge or corner belongs to several triangles: the distance, not the index, must agree there
    assert np.count_nonzero(hits.face[found] != face[found]) <= 2


def test_rays_on_shared_edges_do_not_leak():
    vehicle = pe.Vehicle(shapes.refined(shapes.box((-1, -1, 0), (1, 1, 2)), 3))
    edges = vehicle.triangles[:, [0, 1, 2]] + vehicle.triangles[:, [1, 2, 0]]
    aimed = (edges / 2).reshape(-1, 3) - [0.1, 0.2, 1.3]
    directions = aimed / np.linalg.norm(aimed, axis=1, keepdims=True)
    assert np.isfinite(vehicle.first_hit((0.1, 0.2, 1.3), directions).distance).all()


def test_the_part_that_stops_a_beam_is_reported():
    vehicle = shapes.box_car()
    sensor = shapes.lidar_on_roof(position=(0.6, 0.0, 1.6))
    stopped = pe.beam_field(sensor, vehicle).occluded_count(vehicle.part_names)
    assert set(stopped) == {"body", "cabin"}
    down = vehicle.first_hit((0, 0, 3.0), [[0, 0, -1.0]])
    assert vehicle.part_names[vehicle.parts[down.face[0]]] == "cabin"
    assert down.distance[0] == pytest.approx(1.6)


def test_cameras_see_through_glass_and_lidars_do_not():
    wall = shapes.box((1.0, -5.0, 0.0), (1.1, 5.0, 5.0))
    vehicle = pe.Vehicle(wall, None, ("windshield",), glass=("windshield",))
    camera = shapes.camera(60.0, (0.0, 0.0, 1.0))
    assert pe.measure(camera, [[6.0, 0.0, 1.0]], 0.1, vehicle)[0] > 0
    lidar = shapes.lidar_on_roof(position=(0.0, 0.0, 1.0))
    assert pe.measure(lidar, [[6.0, 0.0, 1.0]], 0.1, vehicle)[0] == 0


@pytest.mark.parametrize("height", [-0.001, 0.0, 0.001])
def test_a_flush_sensor_is_not_blind(height):
    """1 mm under the skin, on it, or 1 mm above: it sees as if it stood proud by the clearance."""
    vehicle = shapes.box_car(times=1)
    proud = pe.beam_field(shapes.lidar_on_roof(position=(-0.4, 0.03, 1.4 + 0.02)), vehicle)
    flush = pe.beam_field(shapes.lidar_on_roof(position=(-0.4, 0.03, 1.4 + height)), vehicle)
    assert (flush.occluded_by == proud.occluded_by).mean() > 0.999
    assert (flush.occluded_by < 0).mean() > 1 / 3


def test_a_sensor_deep_inside_is_blind():
    field = pe.beam_field(shapes.lidar_on_roof(position=(-0.4, 0.0, 1.2)), shapes.box_car())
    assert (field.occluded_by >= 0).all()


def test_the_height_map_needs_no_closed_mesh():
    roof_only = np.array(
        [[[-1, -1, 1.0], [1, -1, 1.0], [1, 1, 2.0]], [[-1, -1, 1.0], [1, 1, 2.0], [-1, 1, 2.0]]]
    )
    space = shapes.small_space(0.5)
    top = pe.Vehicle(roof_only).top(space)
    inside = np.isfinite(top)
    assert inside.sum() == 16
    i, j = np.nonzero(inside)
    np.testing.assert_allclose(top[inside], 1.5 + space.centers(1)[j] / 2, atol=1e-12)
    assert (np.abs(space.centers(0)[i]) < 1).all()


def test_glass_must_name_a_part():
    with pytest.raises(pe.InputError, match=r"glass.*body, cabin.*'window'"):
        car = shapes.box_car()
        pe.Vehicle(car.triangles, car.parts, car.part_names, glass=("window",))
