"""Rigs of other programs leave the scene and come into it; axles stand where wheels are."""

import json
from pathlib import Path

import bpy
import pytest

from blender_addon import document
from blender_addon.engine import pe, studies
from blender_addon.operators import exports
from pe_tools.cli.verbs import main
from tests.addon import scenes
from tests.engine.test_merging import CARLA

AXLE = pe.Reference(-1.31, 0.33, 2.8)


def wheel(name, x):
    """A part of the car that is called a wheel."""
    car = bpy.context.scene.perception_entropy.vehicle
    return scenes.add_box(car, name, (0.3, 0.1, 0.3), location=(x, 0.8, 0.3))


@pytest.fixture
def axled(car):
    place = {"location": (1.5, 0.1, 1.3), "rotation_euler": (0.0, 0.1, 0.2)}
    scenes.add_sensor("eye", "Front 120 deg 8 MP", **place)
    document.put(car.perception_entropy, document.REFERENCE, studies.write(AXLE))
    return car


def test_the_suffix_of_a_rig_s_file_chooses_the_format(axled, tmp_path):
    """`prius.urdf` became a CSV: the dialog's format is a default, what is typed is meant."""
    path = tmp_path / "prius.urdf"
    assert bpy.ops.pe.export_file(filepath=str(path)) == {"FINISHED"}
    assert path.read_text().startswith("<?xml")
    with pytest.raises(RuntimeError, match=r"other\.urdf: format: "):
        bpy.ops.pe.export_file(filepath=str(tmp_path / "other.urdf"), format="csv")
    assert not (tmp_path / "other.urdf").exists()


def test_axles_are_found_by_wheels_and_refused_without(car):
    with pytest.raises(RuntimeError, match="parts named as wheels, front and rear"):
        bpy.ops.pe.guess_axles()
    wheel("wheel_front_left", 1.5)
    wheel("wheel_rear_left", -1.3)
    bpy.context.view_layer.update()
    assert bpy.ops.pe.guess_axles() == {"FINISHED"}
    found = scenes.study().reference
    assert (found.rear_axle_x, found.rear_axle_z, found.wheelbase) == (-1.3, 0.3, 2.8)


def test_a_bad_file_changes_nothing(car, tmp_path):
    (tmp_path / "objects.json").write_text("{")
    before = scenes.study().rig
    with pytest.raises(RuntimeError, match="valid JSON"):
        bpy.ops.pe.import_file(filepath=str(tmp_path / "objects.json"))
    assert [s.pose for s in scenes.study().rig] == [s.pose for s in before]
    assert not car.perception_entropy.variants


def test_what_a_file_has_besides_its_rig_stays_in_it(axled, tmp_path, capfd):
    """A collision sensor is named, and is in the file into which the rig goes: by the dialog that
    replaces it, by `into`, and by the command."""
    objects = tmp_path / "objects.json"
    objects.write_text(json.dumps(CARLA))
    assert bpy.ops.pe.import_file(filepath=str(objects)) == {"FINISHED"}
    line = "left out: 1 collision sensor (collision)"
    assert line in capfd.readouterr().out
    assert line in document.active_variant(axled).note
    assert {s.name for s in scenes.study().rig} == {"rgb_front", "lidar", "radar_front"}
    study = tmp_path / "study" / "study.toml"
    study.parent.mkdir()
    assert bpy.ops.pe.export_file(filepath=str(study)) == {"FINISHED"}
    out = tmp_path / "out.json"
    options = {"filepath": str(out), "format": "carla", "into": str(objects)}
    assert bpy.ops.pe.export_file(**options) == {"FINISHED"}
    assert json.loads(out.read_text()) == CARLA
    assert bpy.ops.pe.export_file(filepath=str(objects)) == {"FINISHED"}
    assert json.loads(objects.read_text()) == CARLA
    main(["export", str(study), "--into", str(objects), "-o", str(tmp_path / "command.json")])
    assert (tmp_path / "command.json").read_bytes() == out.read_bytes()


def test_a_name_that_the_dialog_proposed_for_another_format_is_changed(axled, tmp_path):
    """The format is chosen in the dialog, after the name was proposed; a name that a person typed
    gets the suffix that it lacks."""
    for name in ("urdf", "csv", "study", "footprints", "carla"):
        folder = tmp_path / name
        folder.mkdir()
        wanted = exports.FORMATS[name].file
        for proposed in (exports.FORMATS["kitti"].file, "rig"):
            given = str(folder / proposed)
            assert bpy.ops.pe.export_file(filepath=given, format=name) == {"FINISHED"}
        typed = f"rig{Path(wanted).suffix}"
        assert {wanted, typed} <= {each.name for each in folder.iterdir()}, name
        assert not (folder / exports.FORMATS["kitti"].file).exists()
