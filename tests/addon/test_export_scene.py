"""The scene leaves Blender as other programs' files; Blender reads its glTF back as it stood."""

import bpy
import numpy as np
import pytest
from mathutils import Vector

from blender_addon.engine import outputs
from tests.addon import scenes
from tests.addon.command_line import run_here


@pytest.fixture
def seen(car):
    place = {"location": (1.5, 0.1, 1.3), "rotation_euler": (0.1, 0.2, -2.0)}
    scenes.add_sensor("eye", "Autoware sample kit", **place)
    return car


def exported(tmp_path, name, **options):
    path = tmp_path / outputs.scene_output(name).file
    done = bpy.ops.pe.export_scene(filepath=str(path), output=name, **options)
    assert done == {"FINISHED"}
    return path


@pytest.mark.parametrize("name", [*outputs.scene_outputs()])
def test_every_output_of_the_panel_is_that_of_the_engine(seen, tmp_path, name):
    path = exported(tmp_path, name, range_m=5.0)
    files, _ = outputs.scene_files(scenes.study(), name, 5.0)
    for file, data in files.items():
        assert (path / file if path.is_dir() else path).read_bytes() == data


def test_blender_imports_sensors_where_they_stood(seen, tmp_path):
    path, rig = exported(tmp_path, "gltf"), scenes.study().rig
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    bpy.context.view_layer.update()
    for sensor in rig:
        matrix = bpy.data.objects[sensor.name].matrix_world
        assert tuple(matrix.translation) == pytest.approx(sensor.pose.position, abs=1e-5)
        turned = np.array(matrix.to_3x3()) - sensor.pose.ground_from_sensor
        assert np.abs(turned).max() < 1e-5
    view = bpy.data.objects["eye view"]
    ahead = view.matrix_world.to_3x3() @ Vector((0.0, 0.0, -1.0))
    up = view.matrix_world.to_3x3() @ Vector((0.0, 1.0, 0.0))
    forward, _, above = rig["eye"].pose.ground_from_sensor.T
    assert tuple(ahead) == pytest.approx(forward, abs=1e-5)
    assert tuple(up) == pytest.approx(above, abs=1e-5)
    assert view.data.angle_y == pytest.approx(rig["eye"].model.vfov, abs=1e-5)


def test_blender_imports_the_vehicle_and_closed_solids_where_they_were(seen, tmp_path):
    """The folder of solids is replaced only when that is asked for."""
    import bmesh  # there once bpy is

    exported(tmp_path, "solids", range_m=3.0)
    with pytest.raises(RuntimeError, match="an existing file"):
        exported(tmp_path, "solids", range_m=6.0)
    folder = exported(tmp_path, "solids", range_m=6.0, replace=True)
    low, high = scenes.study().vehicle.bounds
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.import_scene.gltf(filepath=str(folder / "solids.glb"))
    names = {each.name for each in bpy.data.objects if each.type == "MESH"}
    assert {"roof_free", "eye_free", "blind_volume"} <= names
    corners = [o.matrix_world @ Vector(c) for o in parts(names) for c in o.bound_box]
    assert np.min(corners, axis=0) == pytest.approx(low, abs=1e-5)
    assert np.max(corners, axis=0) == pytest.approx(high, abs=1e-5)

    bpy.ops.object.select_all(action="DESELECT")
    bpy.ops.wm.stl_import(filepath=str(folder / "roof_field.stl"))
    (solid,) = bpy.context.selected_objects
    mesh = bmesh.new()
    mesh.from_mesh(solid.data)
    assert all(edge.is_manifold and edge.is_contiguous for edge in mesh.edges)
    assert mesh.calc_volume(signed=True) > 0.0
    places = np.array([solid.matrix_world @ vertex.co for vertex in mesh.verts])
    mesh.free()
    assert np.hypot(*(places[:, :2] - (-0.43, 0.0)).T).max() == pytest.approx(6.0, abs=1e-3)


def parts(names):
    """Objects that are none of ours: those of the vehicle."""
    ours = ("_free", "_hidden", "blind_volume")
    return [bpy.data.objects[name] for name in names if not name.endswith(ours)]


def test_the_command_in_blender_writes_the_same(seen, tmp_path):
    path, blend = exported(tmp_path, "gltf", range_m=5.0), tmp_path / "car.blend"
    again = tmp_path / "again.glb"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    answer = run_here(blend, "export", "--to", "gltf", "--range", "5", "-o", again)
    assert answer.returncode == 0, answer.stderr
    assert again.read_bytes() == path.read_bytes()
