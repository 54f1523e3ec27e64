"""A rig as one line of text: copied from a scene, pasted into another, and read by `pe`."""

import bpy
import pytest

from blender_addon.engine import studies
from tests.addon import scenes


def line_of(rig):
    """Models are compared by their values."""
    return studies.rig_line(rig)


def copied(car):
    assert bpy.ops.pe.copy_rig() == {"FINISHED"}
    return studies.rig_line(scenes.study().rig)


def test_what_is_pasted_is_what_was_copied_to_the_bit(car):
    scenes.add_sensor("eye", model="Camera 60 deg", location=(1.23456, -0.4, 1.7))
    car.objects["eye"].perception_entropy.fusion = "front"
    bpy.context.view_layer.update()
    before = scenes.study().rig
    line = copied(car)
    assert "\n" not in line
    car.objects["eye"].location.x += 1.0
    bpy.context.view_layer.update()
    assert bpy.ops.pe.paste_rig(text=line) == {"FINISHED"}
    assert line_of(scenes.study().rig) == line_of(before)
    assert car.perception_entropy.variants[-1].name == "Pasted"


@pytest.mark.parametrize("text", ["hello", "sensor = []", "sensor = [{ name = 'a' }]"])
def test_other_text_is_refused_and_changes_nothing(car, text):
    before = scenes.study().rig
    with pytest.raises(RuntimeError, match="clipboard"):
        bpy.ops.pe.paste_rig(text=text)
    assert line_of(scenes.study().rig) == line_of(before)
