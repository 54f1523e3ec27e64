"""The scene leaves Blender as other programs' files; Blender reads its glTF back as it stood."""

import bpy
import numpy as np
import pytest
from mathutils import Vector

from blender_addon.engine import outputs
from tests.addon import scenes


@pytest.fixture
def seen(car):
    place = {"location": (1.5, 0.1, 1.3), "rotation_euler": (0.1, 0.2, -2.0)}
    scenes.add_sensor("eye", "Autoware sample kit", **place)
    settings = car.perception_entropy
    settings.axles_known = True
    settings.rear_axle_x = -1.31
    settings.rear_axle_z = 0.33
    settings.wheelbase = 2.8
    return car


def exported(tmp_path, name, **options):
    path = tmp_path / outputs.scene_output(name).file
    done = bpy.ops.pe.export_file(filepath=str(path), format=name, **options)
    assert done == {"FINISHED"}
    return path


@pytest.mark.usefixtures("small_pictures")
@pytest.mark.parametrize("name", [*outputs.scene_outputs()])
def test_every_output_of_the_panel_is_that_of_the_engine(seen, tmp_path, name):
    path = exported(tmp_path, name, range_m=5.0)
    if name == "picture":  # Blender's has the figures of a score above it
        assert path.read_bytes().startswith(b"<svg")
        return
    files, _ = outputs.scene_files(scenes.study(), name, 5.0)
    for file, data in files.items():
        assert (path / file if path.is_dir() else path).read_bytes() == data


def test_blender_imports_sensors_where_they_stood(seen, tmp_path):
    path = exported(tmp_path, "gltf")
    rig = scenes.study().rig
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
