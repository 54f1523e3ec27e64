"""AP curves of objects from scans: from the panel to a study and a file, and back."""

import json

import bpy
import pytest

from blender_addon import result_staleness
from blender_addon.panels import scoring_panels, search_panels
from pe_tools import advice
from tests.addon import layouts, scenes
from tests.addon.command_line import run_here


@pytest.fixture
def settings(car):
    """Settings of a scene with a LiDAR of few beams that is scored on objects, by scans' curves."""
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck")
    found = car.perception_entropy
    found.targets, found.traffic, found.scenes, found.ap_model = "objects", True, 8, "scans"
    return found


@pytest.mark.parametrize(
    ("key", "first", "then"), [("ap_model", "scans", "paper"), ("returns", "all", "road")]
)
def test_panel_and_headless_blender_score_by_what_is_chosen(settings, tmp_path, key, first, then):
    """A change makes the stored score stale; the panel says which returns and curves it is of."""
    blend = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    assert bpy.ops.pe.score() == {"FINISHED"}
    before = json.loads(settings.result_json)
    setattr(settings, key, then)
    assert result_staleness.fingerprint(bpy.context.scene).text != settings.result_signature
    assert bpy.ops.pe.score() == {"FINISHED"}
    after = json.loads(settings.result_json)
    assert (before[key], after[key]) == (first, then)
    assert after["after"]["objects"]["ap"] != before["after"]["objects"]["ap"]
    codes = [row.code for row in settings.result_warnings]
    assert ("returns" in codes) == (key == "returns") and "returns" in drawn(scoring_panels.targets)
    del settings  # the file is opened again
    answer = run_here(blend, "score", f"--{key.replace('_', '-')}", then, "--json")
    assert answer.returncode == 0, answer.stderr
    by_option = json.loads(answer.stdout)
    assert by_option[key] == then
    assert by_option["after"]["objects"] == after["after"]["objects"]
    assert by_option["after"]["entropy"] == after["after"]["entropy"]


def test_a_range_term_and_the_floor_are_those_of_the_panel_and_of_headless_blender(
    settings, tmp_path
):
    """Each makes the stored score stale, and the panel tells both."""
    settings.ap_model, settings.targets = "paper", "voxels"
    blend, before = tmp_path / "car.blend", result_staleness.fingerprint(bpy.context.scene).text
    bpy.ops.pe.own_curves()
    row = settings.curves["lidar"]
    row.own, row.c = True, 0.25
    after = result_staleness.fingerprint(bpy.context.scene).text
    settings.protocol_floor = 0.1
    assert len({before, after, result_staleness.fingerprint(bpy.context.scene).text}) == 3
    model = scenes.study().model
    assert model.lidar.c == 0.25 and model.protocol_floor == pytest.approx(0.1, abs=1e-7)
    assert bpy.ops.pe.score() == {"FINISHED"}
    told = {row.text for row in settings.result_warnings}
    warned = advice.curve_warnings(scenes.study())
    assert len(warned) == 2 and {each.text for each in warned} <= told
    stored = json.loads(settings.result_json)
    assert "c" in drawn(scoring_panels.advanced)
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    answer = run_here(blend, "score", "--json")
    assert answer.returncode == 0, answer.stderr
    assert json.loads(answer.stdout)["after"]["entropy"] == stored["after"]["entropy"]


@pytest.mark.parametrize(
    ("panel", "targets"), [(scoring_panels.targets, "objects"), (search_panels.search, "")]
)
def test_it_is_drawn_where_objects_count(settings, panel, targets):
    settings.targets, settings.objective = targets or "voxels", "expected_ap"
    assert "ap_model" in drawn(panel)
    settings.targets, settings.objective = "voxels", "entropy"
    assert "ap_model" not in drawn(panel)


def drawn(panel):
    """The properties that a panel draws."""
    notes = layouts.drawn(panel, **vars(layouts.Window(bpy.context.scene))).notes
    return [name for kind, name in notes if kind == "prop"]
