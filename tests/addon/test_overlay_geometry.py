"""Beams and frustums as arrays: right places, right counts, right colours. Needs no Blender."""

import importlib.util
import math
import sys
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe

OVERLAY = Path(__file__).resolve().parents[2] / "blender_addon" / "overlay"


def load_overlay():
    """Load the overlay's package on its own: the add-on around it would ask for bpy."""
    name = "overlay_alone"
    spec = importlib.util.spec_from_file_location(
        name, OVERLAY / "__init__.py", submodule_search_locations=[str(OVERLAY)]
    )
    sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules[name])
    modules = (
        importlib.import_module(f"{name}.{each}")
        for each in ("beams", "colors", "geometry", "kinds")
    )
    return tuple(modules)


beams, colors, geometry, kinds = load_overlay()

LENGTH_M = 15.0


def box(low, high):
    """Vehicle that is a box: (12, 3, 3) triangles."""
    corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, 8).T
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return pe.Vehicle(corners[np.array(faces)])


@pytest.fixture
def vehicle():
    """A car as a box, 4 m long, 2 m wide, up to 1.5 m."""
    return box((-2.0, -1.0, 0.3), (2.0, 1.0, 1.5))


def lidar(elevations_deg=(10, 0, -10, -25, -40), azimuths=720, max_range=100.0, fov_deg=None):
    fov = {} if fov_deg is None else {"horizontal_fov": tuple(np.radians(fov_deg))}
    return pe.Lidar("test", np.radians(elevations_deg), azimuths, max_range, **fov)


def sensor(model=None, position=(0.0, 0.0, 1.9), rotation=(0.0, 0.0, 0.0)):
    pose = pe.Pose.from_degrees(position, rotation)
    return pe.Sensor("roof", lidar() if model is None else model, pose)


def elevations_of(shown):
    return {round(v, 6) for v in np.degrees(np.arcsin(shown.directions[:, 2]))}


@pytest.mark.parametrize("budget", [1, 4, 5, 50, 401, 3600, 10_000])
def test_no_more_beams_than_the_budget(budget, vehicle):
    for body in (vehicle, None):
        shown = beams.shown_beams(sensor(), body, budget)
        assert 0 < len(shown.ends) <= budget


def test_budget_above_all_beams_shows_each_once(vehicle):
    shown = beams.shown_beams(sensor(), vehicle, 10_000)
    assert len(shown.ends) == sensor().model.beam_count
    assert len(np.unique(shown.directions.round(9), axis=0)) == len(shown.ends)


def test_every_channel_shows(vehicle):
    shown = beams.shown_beams(sensor(), vehicle, 40)
    assert elevations_of(shown) == {10.0, 0.0, -10.0, -25.0, -40.0}


def test_azimuths_are_thinned_evenly():
    numbers = beams.spread(lidar(), 5 * 8).reshape(5, 8)
    np.testing.assert_array_equal(numbers % 720, np.tile(np.arange(8) * 90, (5, 1)))


def test_edges_of_a_limited_field_of_view_show():
    model = lidar(fov_deg=(-45, 45))
    numbers = beams.spread(model, 5 * 4).reshape(5, 4) % len(model.azimuth_steps)
    assert numbers[:, 0].tolist() == [0] * 5
    assert numbers[:, -1].tolist() == [len(model.azimuth_steps) - 1] * 5


def test_channels_are_thinned_when_there_are_too_many():
    channels = beams.spread(lidar(), 3) // 720
    assert channels.tolist() == [0, 2, 4]


def test_same_input_same_arrays(vehicle):
    first, second = (beams.shown_beams(sensor(), vehicle, 500) for _ in range(2))
    np.testing.assert_array_equal(first.directions, second.directions)
    np.testing.assert_array_equal(first.ends, second.ends)


def test_agrees_with_the_engine_beam_by_beam(vehicle):
    mounted = sensor(position=(-0.3, 0.2, 1.8), rotation=(0, 5, 30))
    shown = beams.shown_beams(mounted, vehicle, 10_000)
    field = pe.beam_field(mounted, vehicle)
    assert shown.stopped.sum() == (field.stopped_by >= 0).sum() > 0
    np.testing.assert_allclose(np.sort(shown.ends), np.sort(field.ends), rtol=0, atol=1e-9)


def test_few_stopped_beams_are_not_lost():
    """A post 4 cm wide stops 1 of 1,000 beams; the even choice of 60 would show hardly one."""
    post = box((2.0, -0.02, 0.5), (2.04, 0.02, 2.5))
    mounted = sensor(lidar(azimuths=7200))
    shown = beams.shown_beams(mounted, post, 60)
    field = pe.beam_field(mounted, post)
    assert 0 < (field.stopped_by >= 0).mean() < 0.005
    assert 10 <= shown.stopped.sum() <= 20


def lines_of(mounted, vehicle, budget=2000):
    shown = beams.shown_beams(mounted, vehicle, budget)
    lines = geometry.beam_lines(mounted, shown, LENGTH_M)
    ends = lines.points.reshape(-1, 2, 3)
    is_free = np.arange(len(ends)) < (~shown.stopped).sum()
    return shown, ends, lines.colors.reshape(-1, 2, 4), is_free


def test_all_lines_begin_at_the_sensor(vehicle):
    _, ends, _, _ = lines_of(sensor(), vehicle)
    np.testing.assert_allclose(ends[:, 0] - [0.0, 0.0, 1.9], 0.0, atol=1e-6)


def test_stopped_beams_end_on_the_vehicle(vehicle):
    shown, ends, _, is_free = lines_of(sensor(), vehicle)
    stopped = ends[~is_free, 1]
    assert len(stopped) == shown.stopped.sum() > 0
    np.testing.assert_allclose(stopped[:, 2], 1.5, atol=1e-6)  # from above, only its roof is hit
    assert (np.abs(stopped[:, 0]) <= 2.0).all()
    assert (np.abs(stopped[:, 1]) <= 1.0).all()


def test_free_beams_end_at_the_ground_or_the_length(vehicle):
    _, ends, _, is_free = lines_of(sensor(), vehicle)
    free = ends[is_free]
    length = np.linalg.norm(free[:, 1] - free[:, 0], axis=1)
    at_ground = np.abs(free[:, 1, 2]) < 1e-5
    np.testing.assert_allclose(length[~at_ground], LENGTH_M, rtol=1e-6)
    assert (length[at_ground] < LENGTH_M).all()
    assert (free[:, 1, 2] > -1e-5).all()
    assert at_ground.any()
    # 1.9 m down at 10 degrees: 1.9 / sin(10 deg)
    assert any(abs(length[at_ground] - 1.9 / math.sin(math.radians(10))) < 1e-4)


def test_free_beams_end_at_a_short_range(vehicle):
    _, ends, _, is_free = lines_of(sensor(lidar(elevations_deg=(10,), max_range=3.0)), vehicle)
    np.testing.assert_allclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), 3.0, rtol=1e-6)
    assert is_free.all()


def test_colours_say_free_or_stopped(vehicle):
    _, _, found, is_free = lines_of(sensor(), vehicle)
    assert (found[is_free, :, :3] == np.float32(colors.VIEWPORT.free[:3])).all()
    expected = np.float32(colors.VIEWPORT.stopped)
    assert (found[~is_free] == expected).all()


def test_free_beams_fade_with_distance(vehicle):
    _, ends, found, is_free = lines_of(sensor(), vehicle)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    alpha = found[is_free, :, 3]
    np.testing.assert_allclose(
        alpha[:, 1], alpha[:, 0] * (1.0 - length[is_free] / LENGTH_M), atol=1e-5
    )
    assert (alpha[:, 0] > 0.0).all()


def test_dense_channels_are_fainter():
    mounted = sensor(lidar(elevations_deg=(20, 0.2, 0.1, 0.0, -20)))
    shown = beams.shown_beams(mounted, None, 100)
    by_elevation = dict(zip(np.degrees(np.arcsin(shown.directions[:, 2])), shown.room, strict=True))
    room = [by_elevation[key] for key in sorted(by_elevation)]
    assert room[0] == pytest.approx(room[-1], rel=0.02) and room[len(room) // 2] < room[0] / 50


# A square picture with 90 degrees: its corners stand at one along each axis, sqrt(3) away.
SQUARE = pe.Camera("square", 1000, 1000, math.pi / 2)


def test_frustum_corners():
    mounted = sensor(SQUARE, position=(1.0, 2.0, 3.0))
    points = geometry.frustum_points(mounted, math.sqrt(3.0))
    expected = [(1, 2, 3), (2, 3, 4), (2, 1, 4), (2, 1, 2), (2, 3, 2)]
    np.testing.assert_allclose(points[:5], expected, atol=1e-12)
    assert (points[5:, 2] > 4.0).all()  # the mark is above the upper edge


def test_frustum_of_a_turned_camera():
    """Yaw 90 degrees looks to the left, pitch 90 degrees straight down."""
    left = geometry.frustum_points(sensor(SQUARE, (0, 0, 0), (0, 0, 90)), math.sqrt(3.0))
    np.testing.assert_allclose(left[1:5, 1], 1.0, atol=1e-12)
    down = geometry.frustum_points(sensor(SQUARE, (0, 0, 0), (0, 90, 0)), math.sqrt(3.0))
    np.testing.assert_allclose(down[1:5, 2], -1.0, atol=1e-12)


def test_frustum_is_as_wide_as_the_picture():
    camera = pe.Camera("wide", 1920, 1080, math.radians(60))
    points = geometry.frustum_points(sensor(camera, (0, 0, 0)), 2.0)
    assert points[1, 1] / points[1, 0] == pytest.approx(math.tan(math.radians(30)))
    assert points[1, 2] / points[1, 1] == pytest.approx(1080 / 1920)
    np.testing.assert_allclose(np.linalg.norm(points[1:5], axis=1), 2.0)


def test_a_camera_is_a_frustum_and_a_lidar_is_lines(vehicle):
    camera = kinds.sensor_geometry(sensor(SQUARE), vehicle, 100, LENGTH_M)
    assert camera.lines.points.shape == (22, 3) and camera.faces.points.shape == (12, 3)
    mounted = kinds.sensor_geometry(sensor(), vehicle, 100, LENGTH_M)
    assert len(mounted.lines.points) <= 200 and mounted.faces.points.shape == (0, 3)
    for each in (camera.lines, camera.faces, mounted.lines, mounted.faces):
        assert each.points.dtype == each.colors.dtype == np.float32
        assert each.colors.shape == (len(each.points), 4)


def test_buried_lidar_shows_only_stopped_beams(vehicle):
    shown = beams.shown_beams(sensor(position=(0.0, 0.0, 0.9)), vehicle, 200)
    assert shown.stopped.all() and 0 < len(shown.ends) <= 200
