"""Sensors stood upright: by the button, and when they come from the asset browser."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

from blender_addon.operators import upright
from blender_addon.view.housing import housing_mesh

TAIL = Vector((-2.0, 0.3, 0.6))


def axes(obj):
    """Return where a sensor looks, and its up, each (3,)."""
    bpy.context.view_layer.update()
    turned = np.array(obj.matrix_world)[:3, :3]
    return turned[:, 0], turned[:, 2]


def dropped(name, model, point, normal):
    """Return a sensor as Blender leaves an asset that was dropped onto a surface."""
    obj = bpy.data.objects.new(name, housing_mesh(model))
    bpy.context.scene.collection.objects.link(obj)
    obj.perception_entropy.model = model
    obj.perception_entropy.is_sensor = obj.perception_entropy.stands_when_dropped = True
    up = Vector(normal)
    turn = up.to_track_quat("Z", "Y").to_matrix().to_4x4()
    low = np.min(obj.bound_box, axis=0)
    high = np.max(obj.bound_box, axis=0)
    base = Vector(((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]))
    obj.matrix_world = Matrix.Translation(point) @ turn @ Matrix.Translation(-base)
    bpy.context.view_layer.update()
    return obj


def reach_into(obj, point, normal):
    """How far a sensor's body reaches through a surface; negative where it is clear of it [m]."""
    corners = [obj.matrix_world @ Vector(each) for each in obj.bound_box]
    return max(-(corner - Vector(point)).dot(Vector(normal)) for corner in corners)


@pytest.mark.parametrize(
    ("model", "point", "normal", "ahead"),
    [
        ("Camera 60 deg", TAIL, (-0.98, 0.0, 0.199), (-0.99, 0.14, 0.0)),
        ("Camera 60 deg", (0.1, 0.9, 0.6), (0.0, 1.0, 0.0), (0.05, 0.999, 0.0)),
        ("Velodyne VLP-16 Puck", (-0.3, 0.0, 1.5), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
    ],
)
def test_an_asset_dropped_on_a_surface_stands_on_it_once(car, model, point, normal, ahead):
    sensor = dropped("new", model, point, normal)
    upright.place_dropped()
    looks, up = axes(sensor)
    assert up == pytest.approx((0, 0, 1), abs=1e-6)
    assert looks == pytest.approx(ahead, abs=0.2) and looks[2] == pytest.approx(0.0, abs=1e-6)
    assert reach_into(sensor, point, normal) == pytest.approx(0.0, abs=1e-3), "not on the surface"
    sensor.rotation_euler = (0.5, 0.0, 0.0)  # whoever turns it now wants that
    upright.place_dropped()
    assert axes(sensor)[1][2] == pytest.approx(math.cos(0.5), abs=1e-6)
