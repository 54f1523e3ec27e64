"""The shipped examples of mounts: the sedan's painted roof, and the shuttle's four corners."""

import contextlib
import io
import json
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from blender_addon import bridge
from blender_addon.commands import main
from pe_tools.cli.verbs import main as pe_main
from tests.addon import scenes

BASE_M, MODEL = 0.04, "Pandar64"
CORNERS = scenes.ASSETS / "examples" / "four_corners"
FAST = (
    *("--samples", "1024", "--search-samples", "1024", "--method", "random", "--candidates", "1"),
    *("--workers", "1"),
)


def test_the_sedan_s_roof_lidar_optimized_on_the_painted_roof_stands_on_it(addon):
    bpy.ops.wm.open_mainfile(filepath=str(scenes.ASSETS / "sedan.blend"))
    scene, roof = bpy.context.scene, bpy.data.objects["roof"]
    settings = scene.perception_entropy
    settings.score_samples, settings.search_samples, settings.candidates = 1024, 1024, 3
    settings.method = "random"
    scenes.paint(roof, "painted", lambda co: float(abs(co.y) < 0.5 and -0.8 < co.x < 0.3))
    scenes.add_mount(scene, "roof", faces="GROUP", group="painted", standoff=BASE_M)
    assert bpy.ops.pe.mount_sensor(name="roof_lidar", mount="roof") == {"FINISHED"}
    bpy.data.objects["roof_lidar"].perception_entropy.free = [False] * 6  # its place on it alone
    before = pose_of("roof_lidar")
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    found, housing = pose_of("roof_lidar"), pe.catalog.housing(MODEL)
    assert found != before
    study = scenes.study()
    assert found.rpy == (0.0, 0.0, 0.0)
    base = np.array(found.position) - found.ground_from_sensor @ housing.optical_center
    rays = np.random.default_rng(0).normal(size=(4000, 3))
    rays[:, 2] = -np.abs(rays[:, 2]) - 1.0
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    hits = study.vehicle.first_hit_from(base, rays)
    nearest = int(np.argmin(hits.distance))
    assert study.vehicle.part_names[study.vehicle.parts[hits.face[nearest]]] == "roof"
    assert hits.distance[nearest] == pytest.approx(BASE_M, abs=1e-3)
    area = study.search.mounting.mounts["roof"].area.triangles.reshape(-1, 3)
    low, high = area.min(axis=0) - BASE_M, area.max(axis=0) + BASE_M
    assert np.all((base[:2] >= low[:2]) & (base[:2] <= high[:2]))
    assert pe.cuts_body(found, housing, study.vehicle) == ()


def pose_of(name):
    return bridge.pose_of(bpy.data.objects[name], scenes.depsgraph())


def test_the_four_corners_of_the_file_and_of_the_study_are_one(addon, tmp_path):
    """Headless Blender on the .blend and `pe` on the study give the same bits.

    Requirements are not kept in this search: a short one meets none, and what stands against each
    would be searched for.
    """
    bpy.ops.wm.open_mainfile(filepath=str(CORNERS / "four_corners.blend"))
    here, there = scenes.study(), pe.load_study(CORNERS / "study.toml")
    settings = bpy.context.scene.perception_entropy
    settings.keep_blind_sector = False  # the study does not name it
    here = scenes.study()
    assert here.search == there.search
    for one, other in zip(here.rig, there.rig, strict=True):
        assert (one.name, one.model.name, one.pose) == (other.name, other.model.name, other.pose)
    assert there.search.requirements == "keep"
    bpy.context.scene.perception_entropy.keep_requirements = False
    study = tmp_path / "study.toml"
    pt.export_study(replace(there, search=replace(there.search, requirements=None)), study)
    out = tmp_path / "blender"
    assert main(["optimize", "--no-review", "-o", str(out), *FAST], "pe", io.StringIO()) == 0
    with contextlib.redirect_stdout(io.StringIO()):
        assert (
            pe_main(["optimize", "--no-review", str(study), "-o", str(tmp_path / "pe"), *FAST]) == 0
        )
    inside, outside = (result(tmp_path / name) for name in ("blender", "pe"))
    assert inside["history"] == outside["history"] and len(inside["history"]) > 1
    assert inside["after"] == outside["after"]
    assert inside["mounts"] == outside["mounts"]


def test_a_variant_of_the_four_corners_is_searched_with_its_mounts(addon, tmp_path):
    """`blender --command pe sweep VARIANT --optimize` is the search of the scene, to the bit."""
    bpy.ops.wm.open_mainfile(filepath=str(CORNERS / "four_corners.blend"))
    for row in bpy.context.scene.perception_entropy.requirements:
        row.enabled = False  # not kept in this search: their verdicts alone would take long
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "corners.blend"))
    swept, alone = tmp_path / "swept", tmp_path / "alone"
    options = ["--optimize", "--set", "optimize.seed=0", "-o", str(swept), *FAST]
    assert main(["sweep", "Variant", *options], "pe", io.StringIO()) == 0
    search = ["optimize", "--no-review", "-o", str(alone), *FAST]
    assert main(search, "pe", io.StringIO()) == 0
    (run,) = (path.parent for path in swept.rglob("result.json"))
    variant, scene = result(run), result(alone)
    assert variant["mounts"] == scene["mounts"] and len(variant["mounts"]) == 2
    assert variant["history"] == scene["history"] and len(scene["history"]) > 1
    assert variant["after"] == scene["after"]


def result(folder: Path) -> dict:
    return json.loads((folder / "result.json").read_text("utf-8"))


def test_the_four_corners_stay_on_their_areas_and_mirror_each_other(addon):
    study = pe.load_study(CORNERS / "study.toml")
    coding, rng = study.coding(), np.random.default_rng(1)
    kept = 0
    for _ in range(40):
        vector = [rng.uniform(u.low, u.high) for u in coding.variables]
        rig = coding.candidate(vector).rig
        if not coding.allowed(rig):
            continue
        kept += 1
        for kind in ("lidar", "camera"):
            left, right = (rig[f"{kind}_{side}"].pose for side in ("left", "right"))
            assert right == bridge.mirrored_pose(left) and left.position[1] >= 0.3
        assert rig["lidar_left"].pose.position[0] > 1.2
        assert rig["camera_left"].pose.position[0] < -2.4
    assert kept
