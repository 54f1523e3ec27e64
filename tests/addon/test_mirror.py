"""Sensors mirrored to the other side: where they are, what they are called, and linked pairs."""

import bpy
import numpy as np
import pytest

import pe_core as pe
from blender_addon import document
from blender_addon.caches import consistency
from tests.addon import scenes

PLACE = {"location": (1.2, 0.7, 0.9), "rotation_euler": (0.1, 0.2, 0.7)}


@pytest.fixture
def left(car):
    """Return a camera on the left, turned and tilted."""
    return scenes.add_sensor("front_left", model="Camera 60 deg", **PLACE)


def mirror(linked=False):
    assert bpy.ops.pe.mirror_sensor(name="front_left", linked=linked) == {"FINISHED"}
    bpy.context.view_layer.update()
    consistency.repair_scenes()
    return bpy.context.object


def alike(one, other):
    """Whether two sensors are mirror images, by their axes: an oracle without angles."""
    plane = np.diag([1.0, -1.0, 1.0, 1.0])
    image = plane @ np.array(one.matrix_world) @ plane
    return np.abs(image - np.array(other.matrix_world)).max() < 2e-5


def moved(obj, **settings):
    """Move a sensor as a hand does, and let the add-on have its turn."""
    for name, value in settings.items():
        setattr(obj, name, value)
    bpy.context.view_layer.update()
    consistency.repair_scenes()
    bpy.context.view_layer.update()


def test_a_copy_on_the_other_side_looks_out_of_it(left):
    right = mirror()
    assert right.name == "front_right" and alike(left, right)
    assert right.perception_entropy.model == "Camera 60 deg"
    study = scenes.study()
    assert {s.name for s in study.rig} == {"front_left", "front_right", "roof"}


@pytest.mark.parametrize("model", ["Continental ARS408-21", "Parking module 2.5 m"])
def test_radars_and_ultrasonic_sensors_are_linked_pairs_too(car, model):
    left = scenes.add_sensor("front_left", model=model, **PLACE)
    right = mirror(linked=True)
    assert alike(left, right) and right.perception_entropy.model == model
    moved(left, location=(1.0, 0.8, 0.6))
    assert alike(left, right)
    study = scenes.study()
    one, other = (study.rig[name] for name in ("front_left", "front_right"))
    rng = np.random.default_rng(2)
    centers = np.array(one.pose.position) + rng.uniform(-2.0, 2.0, (4000, 3))
    flip = np.array([1.0, -1.0, 1.0])
    m = [pe.measure(s, c, 0.1) for s, c in ((one, centers), (other, centers * flip))]
    assert (m[0] > 0).any()
    assert np.quantile(np.abs(m[0] - m[1]), 0.99) < 1e-3  # but points at an edge of the field


@pytest.mark.parametrize(
    ("name", "other"),
    [
        ("front_left", "front_right"),
        ("Rear Right", "Rear Left"),
        ("cam.L", "cam.R"),
        ("side_r.001", "side_l.001"),
        ("LEFT", "RIGHT"),
        ("LiDAR", "LiDAR right"),
        ("Camera.001", "Camera.001 right"),
        ("curl", "curl right"),
        ("leftover", "leftover right"),
    ],
)
def test_names_by_left_and_right(name, other):
    assert document.mirrored_name(name, "right") == other


def test_a_linked_pair_moves_whichever_is_moved(left):
    right = mirror(linked=True)
    moved(left, location=(1.5, 0.9, 1.0))
    assert alike(left, right) and right.location.y == pytest.approx(-0.9)
    moved(right, location=(-1.0, -0.6, 1.2), rotation_euler=(0.0, 0.3, -2.0))
    assert alike(left, right) and left.location.x == pytest.approx(-1.0)


def test_no_mirror_image_is_put_in_the_air(car):
    """Beside its axis the vehicle is not where the image would be; nor without its other half."""
    scenes.add_sensor("corner_left", location=(1.9, 0.8, 1.0))
    for change in ("beside", "one-sided"):
        for obj in car.perception_entropy.vehicle.objects:
            obj.location.y += 0.77 if change == "beside" else -0.77
        if change == "one-sided":
            scenes.add_box(
                car.perception_entropy.vehicle, "arm", (0.1, 0.6, 0.1), location=(1.9, 1.5, 0.9)
            )
            car.objects["corner_left"].location.y = 2.1
        bpy.context.view_layer.update()
        with pytest.raises(RuntimeError, match="mirror image"):
            bpy.ops.pe.mirror_sensor(name="corner_left")
        assert "corner_right" not in car.objects
