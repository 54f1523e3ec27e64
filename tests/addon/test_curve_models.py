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


def test_the_panel_and_headless_blender_score_by_it(settings, tmp_path):
    """A change makes the stored score stale; a provisional curve is told in the panel."""
    blend = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    assert bpy.ops.pe.score() == {"FINISHED"}
    stored = json.loads(settings.result_json)
    assert stored["ap_model"] == "scans"
    told = [row.text for row in settings.result_warnings if row.code == advice.PROVISIONAL]
    assert told == [each.text for each in advice.curve_warnings(scenes.study().model)]
    settings.ap_model = "paper"
    assert result_staleness.fingerprint(bpy.context.scene).text != settings.result_signature
    assert bpy.ops.pe.score() == {"FINISHED"}
    paper = json.loads(settings.result_json)
    assert paper["after"]["objects"]["ap"] < stored["after"]["objects"]["ap"]
    del settings  # the file is opened again
    answer = run_here(blend, "score", "--ap-model", "paper", "--json")
    assert answer.returncode == 0, answer.stderr
    by_option = json.loads(answer.stdout)
    assert by_option["ap_model"] == "paper"
    assert by_option["after"]["objects"]["ap"] == paper["after"]["objects"]["ap"]


def test_returns_as_on_the_road_are_those_of_the_panel_and_of_headless_blender(settings, tmp_path):
    """A change makes the stored score stale, and the panel says which returns it is of."""
    blend = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    assert bpy.ops.pe.score() == {"FINISHED"}
    paper = json.loads(settings.result_json)
    assert paper["returns"] == "all"
    settings.returns = "road"
    assert result_staleness.fingerprint(bpy.context.scene).text != settings.result_signature
    assert bpy.ops.pe.score() == {"FINISHED"}
    road = json.loads(settings.result_json)
    assert "returns" in [row.code for row in settings.result_warnings]
    assert road["returns"] == "road"
    assert road["after"]["objects"]["ap"] != paper["after"]["objects"]["ap"]
    assert "returns" in drawn(scoring_panels.targets)
    del settings  # the file is opened again
    answer = run_here(blend, "score", "--returns", "road", "--json")
    assert answer.returncode == 0, answer.stderr
    by_option = json.loads(answer.stdout)
    assert by_option["returns"] == "road"
    assert by_option["after"]["entropy"] == road["after"]["entropy"]
    assert by_option["after"]["objects"] == road["after"]["objects"]


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
