"""*Best Way* in Blender: the arrow of the active sensor, its ghost, and the key that goes there."""

import bpy
import pytest

from blender_addon import panels
from blender_addon.engine import advice
from blender_addon.operators import shortcuts, shown_way
from blender_addon.overlay.layers import LAYERS
from tests.addon import scenes
from tests.addon.layouts import Window, drawn


@pytest.fixture
def skyward(car):
    """The car's scene with a camera before the cabin that looks back at it and too high, active,
    with Best Way on: a little to the left it would look past the cabin."""
    car.objects["roof"].location.z = 1.6
    eye = scenes.add_sensor("eye", "Camera 60 deg", location=(0.9, 0.65, 1.1))
    eye.perception_entropy.ground_rotation = (0.0, -0.45, 3.14159)
    settings = car.perception_entropy
    settings.space_x = (-10.0, 10.0)
    settings.space_y = (-6.0, 6.0)
    for layer in LAYERS:
        setattr(settings.view, f"show_{layer.name}", layer.name == "steepest")
    bpy.context.view_layer.update()
    return car


def test_the_layer_shows_what_the_engine_finds(skyward):
    shape = scenes.drawn(skyward)["steepest"][""]
    study = scenes.study()
    found = advice.steepest_way(
        advice.places_of(study, "eye", anywhere=True),
        study.evaluator(65_536),
        screen=advice.screen_of(study),
    )
    assert shape.found.to_dict() == found.to_dict()
    assert found.better is not None
    assert len(shape.labels) > len(found.clear_turns) and len(shape.through.points)


def test_the_operator_moves_the_sensor_to_the_ghost(skyward):
    assert not bpy.ops.pe.take_better_place.poll()  # nothing is shown yet
    found = scenes.drawn(skyward)["steepest"][""].found
    window = Window(skyward, bpy.data.objects["eye"])
    texts = drawn(panels.selected_object.sensor, **vars(window)).notes
    assert ("prop", "show_steepest") in texts
    assert found.better.pose.position[1] > 0.65
    assert bpy.ops.pe.take_better_place() == {"FINISHED"}
    at = bpy.data.objects["eye"].matrix_world.translation
    assert tuple(at) == pytest.approx(found.better.pose.position, abs=1e-5)
    assert shown_way(bpy.context) is None  # it has moved since
    assert not bpy.ops.pe.take_better_place.poll()


def test_m_moves_the_sensor_in_object_mode():
    row = next(each for each in shortcuts.SHORTCUTS if each.operator == "pe.take_better_place")
    assert row.key == "M" and not row.modifiers and row.keymap == shortcuts.IN_OBJECT_MODE
    steering = {layer.name for layer in LAYERS if layer.lane != "behind"}
    assert steering == {"steepest"}  # maps keep no other layer waiting
