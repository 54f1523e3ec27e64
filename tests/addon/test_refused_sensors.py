"""A sensor that is refused says what fixes it, and a button does; a typed model is understood."""

import bpy
import numpy as np
import pytest

import pe_core as pe
from blender_addon import document
from tests.addon import scenes


@pytest.fixture
def roof(car):
    return bpy.data.objects["roof"]


def refusal(obj):
    """Return the line that a sensor is refused with, nothing where it is not."""
    bpy.context.view_layer.update()
    try:
        document.sensor_from_object(obj, scenes.depsgraph())
    except pe.InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("scale", [(2.0, 2.0, 2.0), (1.0, -1.0, 1.0), (-0.5, 1.0, 3.0)])
def test_scale_and_mirroring_are_mended_by_the_button(roof, scale):
    roof.rotation_euler = (0.1, 0.2, 0.7)
    bpy.context.view_layer.update()
    before = np.array(roof.matrix_world)
    roof.scale = scale
    said = refusal(roof)
    assert "Ctrl-A > Scale" in said
    assert bpy.ops.pe.fix_warning(fix="apply_scale", subject="roof") == {"FINISHED"}
    assert refusal(roof) == "" and tuple(roof.scale) == pytest.approx((1, 1, 1), abs=1e-6)
    after = np.array(roof.matrix_world)
    assert after[:3, 3] == pytest.approx(before[:3, 3], abs=1e-6)
    looks = before[:3, 0] * np.sign(scale[0])  # mirrored along x it looks the other way
    assert after[:3, 0] == pytest.approx(looks, abs=1e-6)
    assert after[:3, 2] == pytest.approx(before[:3, 2], abs=1e-6)
