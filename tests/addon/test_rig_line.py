"""A rig as one line of text: copied from a scene, pasted into another, and read by `pe`."""

import bpy
import pytest

import pe_core as pe
from blender_addon.engine import catalog, studies
from tests.addon import scenes
from tests.addon.command_line import pe_here


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


def test_the_line_is_a_study_file_and_pe_writes_one_of_it(car, tmp_path):
    line = copied(car)
    (tmp_path / "line.toml").write_text(line)
    assert line_of(pe.load_study(tmp_path / "line.toml").rig) == line
    assert pe_here("new", "--rig", line, "-o", tmp_path / "study.toml").returncode == 0
    assert line_of(pe.load_study(tmp_path / "study.toml").rig) == line
    export = pe_here("export", tmp_path / "study.toml", "--to", "line")
    assert export.stdout.strip() == line


def test_a_sensor_of_ones_own_travels_with_its_figures(car):
    own = catalog.from_table(
        "mine", {"kind": "camera", "width": 320, "height": 240, "hfov_deg": 70.0}
    )
    rig = pe.Rig([pe.Sensor("eye", own, pe.Pose((1.0, 0.0, 1.5)))])
    assert line_of(studies.read_rig_line(line_of(rig))) == line_of(rig)
    bpy.ops.pe.paste_rig(text=studies.rig_line(rig))
    (found,) = scenes.study().rig
    assert catalog.to_table(found.model) == catalog.to_table(own) and found.pose == rig["eye"].pose


@pytest.mark.parametrize("text", ["hello", "sensor = []", "sensor = [{ name = 'a' }]"])
def test_other_text_is_refused_and_changes_nothing(car, text):
    before = scenes.study().rig
    with pytest.raises(RuntimeError, match="clipboard"):
        bpy.ops.pe.paste_rig(text=text)
    assert line_of(scenes.study().rig) == line_of(before)
