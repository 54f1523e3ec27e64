"""What Blender's own exporters write with their default settings scores as the scene does."""

import importlib.util
from dataclasses import replace

import bpy
import pytest

import pe_core as pe
from tests.addon import scenes

EXPORTS = {
    "glb": lambda path: bpy.ops.export_scene.gltf(filepath=path),
    "obj": lambda path: bpy.ops.wm.obj_export(filepath=path),
    "ply": lambda path: bpy.ops.wm.ply_export(filepath=path),
    "stl": lambda path: bpy.ops.wm.stl_export(filepath=path),
    **dict.fromkeys(("usdc", "usdz"), lambda path: bpy.ops.wm.usd_export(filepath=path)),
}
if hasattr(bpy.ops.wm, "collada_export") and bpy.app.version < (5, 0, 0):
    EXPORTS["dae"] = lambda path: bpy.ops.wm.collada_export(filepath=path)
LIBRARIES = {"dae": "collada", "usdc": "pxr", "usdz": "pxr"}
SPACE = pe.PerceptionSpace((-20.0, 20.0), (-10.0, 10.0), (0.0, 3.0), 0.5)


def test_exports_score_as_the_scene(addon, tmp_path):
    """To six digits: coordinates in files are rounded. Also for a car that nobody turned right."""
    study = replace(scenes.shipped_study("sedan"), space=SPACE)
    expected = study.evaluator().entropy(study.rig)
    data = pe.study_to_dict(study)
    for suffix, export in EXPORTS.items():
        if suffix in LIBRARIES and importlib.util.find_spec(LIBRARIES[suffix]) is None:
            continue  # of the extra meshes
        assert export(str(tmp_path / f"car.{suffix}")) == {"FINISHED"}
        data["vehicle"] = {"mesh": f"car.{suffix}"}
        again = pe.study_from_dict(data, folder=tmp_path)
        found = again.evaluator().entropy(again.rig)
        assert found == pytest.approx(expected, rel=2e-6), suffix
        assert f"car.{suffix}: " in again.vehicle_line and "faces +x" in again.vehicle_line
