"""The shipped example of mounts: the four corners of the shuttle."""

import contextlib
import io
import json
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

import pe_core as pe
import pe_tools as pt
from blender_addon import bridge
from blender_addon.commands import main
from pe_tools.cli.verbs import main as pe_main
from tests.addon import scenes

CORNERS = scenes.ASSETS / "examples" / "four_corners"
FAST = (
    *("--samples", "1024", "--search-samples", "1024", "--method", "random", "--candidates", "1"),
    *("--workers", "1"),
)


def test_the_four_corners_of_file_study_and_variant_are_one(addon, tmp_path):
    """Headless Blender on the .blend, its sweep over a variant and `pe` give the same bits.

    Requirements are not kept in this search: a short one meets none, and what stands against each
    would be searched for.
    """
    bpy.ops.wm.open_mainfile(filepath=str(CORNERS / "four_corners.blend"))
    settings, there = bpy.context.scene.perception_entropy, pe.load_study(CORNERS / "study.toml")
    settings.keep_blind_sector = False  # the study does not name it
    here = scenes.study()
    assert here.search == there.search
    for one, other in zip(here.rig, there.rig, strict=True):
        assert (one.name, one.model.name, one.pose) == (other.name, other.model.name, other.pose)
    assert there.search.requirements == "keep"
    settings.keep_requirements = False
    for row in settings.requirements:
        row.enabled = False
    plain = replace(there, requirements=(), search=replace(there.search, requirements=None))
    pt.export_study(plain, tmp_path / "study.toml")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "corners.blend"))
    out = {name: tmp_path / name for name in ("blender", "pe")}
    search = ["optimize", "--no-review", "-o", str(out["blender"]), *FAST]
    assert main(search, "pe", io.StringIO()) == 0
    alone = ["optimize", "--no-review", str(tmp_path / "study.toml"), "-o", str(out["pe"]), *FAST]
    with contextlib.redirect_stdout(io.StringIO()):
        assert pe_main(alone) == 0
    first, *others = (result(folder) for folder in out.values())
    assert len(first["history"]) > 1 and len(first["mounts"]) == 2
    for other in others:
        for key in ("history", "after", "mounts"):
            assert other[key] == first[key], key


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
