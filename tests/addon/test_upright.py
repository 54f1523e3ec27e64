"""Sensors stood upright by the button."""

import math

import bpy
import numpy as np
import pytest

from tests.addon import scenes


def axes(obj):
    """Return where a sensor looks, and its up, each (3,)."""
    bpy.context.view_layer.update()
    turned = np.array(obj.matrix_world)[:3, :3]
    return turned[:, 0], turned[:, 2]


def turned_over(name, model, location=(0.0, 0.9, 0.5)):
    """Return a sensor on the car's left side that lies on its own."""
    return scenes.add_sensor(name, model=model, location=location, rotation_euler=(1.2, 0.4, -0.7))


@pytest.mark.parametrize(
    ("model", "ahead"),
    [
        ("Camera 60 deg", (0.0, 1.0, 0.0)),  # away from the vehicle's middle
        ("Hesai AT128E2X", (0.0, 1.0, 0.0)),  # 120 degrees wide: as a camera
        ("Pandar64", (math.cos(-0.7), math.sin(-0.7), 0.0)),  # all around: keeps its heading
    ],
)
def test_the_button_turns_and_does_not_move(car, model, ahead):
    sensor = turned_over("it", model)
    place = sensor.location.copy()
    assert bpy.ops.pe.stand_upright(name="it") == {"FINISHED"}
    looks, up = axes(sensor)
    assert looks == pytest.approx(ahead, abs=1e-5) and up == pytest.approx((0, 0, 1), abs=1e-6)
    assert (sensor.location - place).length < 1e-5


def test_the_button_takes_all_that_are_selected_and_no_other(car):
    first, second = turned_over("first", "Camera 60 deg"), turned_over("second", "Camera 60 deg")
    third = turned_over("third", "Camera 60 deg")
    for obj in bpy.context.scene.objects:
        obj.select_set(obj in (first, second))
    bpy.context.view_layer.objects.active = second
    bpy.ops.pe.stand_upright()
    assert [axes(each)[1][2] > 0.999 for each in (first, second, third)] == [True, True, False]


def test_of_no_sensor_one_line_is_said(car):
    for obj in bpy.context.scene.objects:
        obj.select_set(False)
    bpy.context.view_layer.objects.active = car.objects["body"]
    with pytest.raises(RuntimeError, match="expected at least one sensor"):
        bpy.ops.pe.stand_upright()
