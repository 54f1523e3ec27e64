"""A lens in the panel: a line with the keys of a study, there and back, and refused in one line."""

import bpy
import pytest

from blender_addon.document.own_sensors import add_own_sensor, lens_text, read_line, table_of
from blender_addon.engine import catalog


@pytest.mark.parametrize("name", ["PandaSet wide", "WoodScape surround view", "Camera 60 deg"])
def test_a_preset_s_lens_comes_back_from_its_line(name):
    table = catalog.to_table(catalog.load(name))
    kept = {k: v for k, v in table.items() if k not in ("kind", "width", "height", "hfov_deg")}
    assert read_line(lens_text(table), "distortion") == kept


def test_an_own_camera_has_the_lens_that_is_typed(car):
    scene = bpy.context.scene
    table = catalog.to_table(catalog.load("PandaSet wide"))
    name = add_own_sensor(scene, "mine", table)
    row = scene.perception_entropy.own_sensors[-1]
    assert table_of(row) == table
    assert catalog.load(name).lens == catalog.load("PandaSet wide").lens
    row.lens = "fx = 930, cx = -4, cy = 530"
    assert "mine: cx: expected a place in the picture" in row.problem
    row.lens = "what is this"
    assert "distortion: expected a table" in row.problem
    row.lens = "max_range_m = 6"
    assert not row.problem and catalog.load(name).max_range == 6.0
