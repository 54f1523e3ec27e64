"""All presets on one vehicle: the panel, headless Blender and `pe check` have the same bits."""

import json

import bpy
import numpy as np
import pytest

import pe_tools as pt
from blender_addon import document
from pe_core.study import requirement_file
from tests.addon import scenes
from tests.addon.command_line import pe_here, run_here
from tests.thorough import THOROUGH

HALF_WIDTH = 0.9
MIRROR_OUT = 1.12
TYRES_X = (-1.3, 1.4)


def foreign_glb(path) -> None:
    """Write a car as another program would: one nameless mesh, y up, mirrors and tyres in it."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for x in TYRES_X:
        for y in (-0.75, 0.75):
            turned = {"rotation": (np.pi / 2.0, 0.0, 0.0), "location": (x, y, 0.3)}
            bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=0.3, depth=0.2, **turned)
    boxes = [((0.0, 0.0, 0.5), (4.4, 2.0 * HALF_WIDTH, 0.6)), ((-0.4, 0.0, 1.1), (2.4, 1.5, 0.6))]
    boxes += [((0.6, s * (MIRROR_OUT - 0.1), 1.0), (0.15, 0.2, 0.15)) for s in (-1.0, 1.0)]
    for location, size in boxes:
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=location)
        bpy.context.object.scale = size
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.transform_apply(location=False, rotation=True, scale=True)
    bpy.ops.object.join()
    bpy.context.object.name = "Object_7"
    bpy.ops.export_scene.gltf(filepath=str(path))


def imported(path):
    """Open a new file with the glTF in it, as the vehicle; a LiDAR and a camera on it."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    car = bpy.data.collections.new("car")
    bpy.context.scene.collection.children.link(car)
    for obj in [each for each in bpy.data.objects if each.type == "MESH"]:
        for each in obj.users_collection:
            each.objects.unlink(obj)
        car.objects.link(obj)
    bpy.context.scene.perception_entropy.vehicle = car
    scenes.add_sensor("roof", "Pandar64", location=(-0.4, 0.0, 1.6))
    scenes.add_sensor("rear", "Camera 120 deg", location=(-2.2, 0.0, 0.9))
    bpy.data.objects["rear"].rotation_euler = (0.0, 0.35, np.pi)
    bpy.context.view_layer.update()


@pytest.fixture(params=["foreign", "bus"] if THOROUGH else ["foreign"])
def vehicle(request, addon, tmp_path):
    """The bus has more parts that presets ask for."""
    if request.param == "bus":
        bpy.ops.wm.open_mainfile(filepath=str(scenes.ASSETS / "bus.blend"))
        if not document.sensor_objects(bpy.context.scene):
            scenes.add_sensor("roof", "Pandar64", location=(-0.4, 0.0, 1.8))
    else:
        foreign_glb(tmp_path / "car.glb")
        imported(tmp_path / "car.glb")
    bpy.context.scene.perception_entropy.requirements.clear()
    return request.param


def test_all_presets_have_the_same_bits_everywhere(vehicle, tmp_path):
    blend = tmp_path / "car.blend"
    study = tmp_path / "study.toml"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    pt.export_study(scenes.study(), study)
    headless = run_here(blend, ["check", "--preset", "all", "--json"])
    alone = pe_here(["check", study, "--preset", "all", "--json"])
    assert headless.returncode == alone.returncode == 3, headless.stderr + alone.stderr
    assert json.loads(headless.stdout) == json.loads(alone.stdout)
    found = json.loads(headless.stdout)
    verdicts = {each["preset"]: each for each in found["requirements"]}
    assert bpy.ops.pe.add_row(rows="requirements", kind="ALL") == {"FINISHED"}
    assert bpy.ops.pe.check_requirements() == {"FINISHED"}
    rows = {document.preset_of(r): r for r in bpy.context.scene.perception_entropy.requirements}
    assert rows.keys() == verdicts.keys()
    assert rows.keys() | found["unchecked"].keys() == requirement_file.presets().keys()
    for preset, row in rows.items():
        told = verdicts[preset]
        kept = json.loads(row.verdict)
        assert kept.pop("name") == row.name
        assert kept == {key: told[key] for key in kept}, preset
    if vehicle == "foreign":
        check_planes(verdicts, found["unchecked"])


def check_planes(verdicts, unchecked):
    """The figures of the foreign car by hand: axles, width without mirrors; no door is found."""
    planes = verdicts["r151_close"]["planes"]
    assert planes["front_axle"] == {"code": "tyres"}
    assert planes["near"]["x"] == [0.53, 0.68]
    assert set(unchecked) == {"ncap26_dooring", "r46_class_I", "r46_class_III"}
    assert "name has the word door" in unchecked["ncap26_dooring"]
    x, y = verdicts["park_aid_front"]["worst"]
    assert x > 2.4 and abs(y) <= HALF_WIDTH
