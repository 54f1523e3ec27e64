"""Variants without a window: listed, scored, exported, compared; the file is not changed."""

import json

import bpy
import pytest

from blender_addon.engine import pe
from tests.addon import scenes
from tests.addon.command_line import run_here

FEW = ("--samples", "4096")


@pytest.fixture
def blend(car, tmp_path):
    """Return a file with the variants "Low", scored, and "High", of which "High" stands."""
    settings = car.perception_entropy
    for name, z in (("Low", 1.75), ("High", 2.25)):
        car.objects["roof"].location.z = z
        bpy.context.view_layer.update()
        bpy.ops.pe.save_variant()
        settings.variants[-1].name = name
        if name == "Low":
            bpy.ops.pe.score()
    path = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_variants_are_listed(blend):
    answer = run_here(blend, ["variants"])
    assert answer.returncode == 0, answer.stderr
    entropy = bpy.context.scene.perception_entropy.variants["Low"].entropy
    assert answer.stdout.splitlines() == [f"  Low  {entropy:.3f} nats", "* High  not scored"]
    listed = json.loads(run_here(blend, ["variants", "--json"]).stdout)
    assert [row["name"] for row in listed] == ["Low", "High"]
    assert [row["active"] for row in listed] == [False, True]
    assert listed[0]["sensors"] == ["roof"] and listed[1]["entropy"] is None


def variant(name):
    """Return a variant of the file that is open."""
    return bpy.context.scene.perception_entropy.variants[name]


def test_a_variant_is_scored_and_exported_as_the_window_would(blend, tmp_path):
    before = blend.read_bytes()
    answer = run_here(blend, ["score", *FEW, "--variant", "Low", "--json"])
    assert answer.returncode == 0, answer.stderr
    kept = json.loads(variant("Low").score_json)
    del kept["figures"]  # beside it in result.json
    del kept["scatter"]  # for the error of a difference: no part of result.json
    assert json.loads(answer.stdout)["after"] == {
        **kept,
        "per_sensor": json.loads(answer.stdout)["after"]["per_sensor"],
    }
    assert run_here(blend, ["export", "--variant", "Low", "-o", tmp_path / "out"]).returncode == 0
    study = pe.load_study(tmp_path / "out" / "study.toml")
    bpy.ops.pe.switch_variant(key=variant("Low").key)
    assert [s.pose for s in study.rig] == [s.pose for s in scenes.study().rig]
    assert blend.read_bytes() == before


def test_a_search_keeps_its_start_and_its_result_in_the_file_that_it_leaves(blend, tmp_path):
    out = tmp_path / "out"
    answer = run_here(
        blend,
        [
            "optimize",
            "--no-review",
            *FEW,
            "--method",
            "random",
            "--set",
            "optimize.samples=4096",
            "--set",
            "optimize.candidates=8",
            "-o",
            out,
        ],
    )
    assert answer.returncode == 0, answer.stderr
    bpy.ops.wm.open_mainfile(filepath=str(out / "optimized.blend"))
    rows = bpy.context.scene.perception_entropy.variants
    assert [row.name for row in rows] == ["Low", "High", "Optimized, seed 0"]
    assert rows["High"].has_result and rows[-1].entropy < rows["High"].entropy
