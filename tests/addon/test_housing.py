"""Sensors with a body: true to size, closed, and never in the way of their own beams."""

import bpy
import numpy as np
import pytest

import pe_core as pe
from blender_addon.view import housing as surfaces
from blender_addon.view.housing import KEY, model_surface
from tests.addon import scenes
from tests.engine.surfaces import volume

MODELS = ["Pandar64", "Velodyne HDL-32E", "Hesai QT128C2X", "Hesai AT128E2X", "Camera 60 deg"]


def triangles_of(surface):
    """(F, 3, 3) triangles of a surface, faces cut from their first corner."""
    rows = [(f[0], f[k], f[k + 1]) for f in surface.faces for k in range(1, len(f) - 1)]
    return surface.points[np.array(rows)]


@pytest.mark.parametrize("name", [n for n in pe.catalog.names() if pe.catalog.housing(n)])
def test_it_is_as_large_as_the_catalogue_says_about_the_optical_centre(name):
    housing = pe.catalog.housing(name)
    points = model_surface(name).points
    low = points.min(axis=0)
    high = points.max(axis=0)
    assert high - low == pytest.approx(housing.size, abs=1e-9)
    assert low[2] == pytest.approx(-housing.optical_center[2], abs=1e-9)
    assert low[:2] + high[:2] == pytest.approx([0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("name", MODELS)
def test_its_surface_is_closed_and_looks_outwards(name):
    surface = model_surface(name)
    triangles = triangles_of(surface)
    assert scenes.open_edges(triangles) == 0
    assert volume(triangles) > 0.5 * np.prod(np.ptp(surface.points, axis=0)) / 2.0
    assert len(surface.faces) == len(surface.made_of)
    assert {surfaces.BODY, surfaces.GLASS, surfaces.MARK} <= set(surface.made_of)


@pytest.fixture
def car(car):
    """Return the car with a Pandar64 on its roof: its size is known from a table of its maker."""
    car.objects["roof"].perception_entropy.model = "Pandar64"
    bpy.context.view_layer.update()
    return car


def test_adding_a_sensor_gives_it_its_body_where_a_size_is_known(car):
    roof = car.objects["roof"]
    assert roof.type == "MESH" and roof.data[KEY] == "Pandar64"
    assert tuple(roof.dimensions) == pytest.approx((0.118, 0.118, 0.116), abs=1e-6)
    camera = scenes.add_sensor("camera", "Camera 60 deg")
    assert camera.type == "EMPTY"
    bpy.ops.pe.add_sensor(model="Pandar64", housing=False)
    assert bpy.context.object.type == "EMPTY"


def test_a_mesh_of_the_user_s_own_is_left_alone(car):
    """A sensor may be any object: only our housings are exchanged."""
    own = scenes.add_box(car.collection, "own housing", (0.05, 0.05, 0.05))
    own.perception_entropy.is_sensor = True
    mesh = own.data
    own.perception_entropy.model = "Velodyne VLP-16 Puck"
    assert own.data == mesh
