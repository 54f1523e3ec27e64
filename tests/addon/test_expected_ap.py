"""Expected AP in traffic as the objective: the panel, headless Blender, `pe` and a job agree."""

import json

import bpy
import pytest

import pe_core as pe
import pe_tools as pt
from blender_addon import best_so_far, bridge
from blender_addon.operators import compare_variants
from blender_addon.panels import main, search_panels
from pe_tools.jobs import result_dict
from tests.addon import layouts, scenes
from tests.addon.command_line import pe_here, run_here
from tests.addon.test_best_so_far import lines_while_running

OPTIONS = ("--objective", "expected_ap", "--evaluations", "12", "--seed", "4", "--json")
ALONE = ("run", "inputs")


@pytest.fixture
def settings(car):
    """Settings of a scene whose search goes by expected AP, on few scenes."""
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(0.0, 0.0, 1.7))
    found = car.perception_entropy
    found.objective, found.scenes, found.method = "expected_ap", 8, "portfolio"
    found.evaluations, found.search_samples, found.score_samples, found.seed = 12, 1024, 1024, 4
    found.keep_blind_ground = found.keep_blind_sector = (
        False  # this car has no higher AP with as little of it
    )
    return found


def test_a_job_the_command_lines_and_the_panel_find_the_same_bits(settings, tmp_path):
    blend = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    inside, study, outside = (tmp_path / name for name in ("inside", "study", "outside"))
    answer = run_here(blend, "optimize", "--no-review", *OPTIONS, "-o", inside)
    assert answer.returncode == 0, answer.stderr
    settings = bpy.context.scene.perception_entropy
    study.mkdir()
    assert bpy.ops.pe.export_study(filepath=str(study / "study.toml")) == {"FINISHED"}
    job = pt.OptimizeJob(pe.load_study(study / "study.toml"))
    list(job)
    answer = pe_here("optimize", "--no-review", study / "study.toml", *OPTIONS, "-o", outside)
    assert answer.returncode == 0, answer.stderr
    assert "expected AP 0." in answer.stderr
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    panel = {**json.loads(settings.result_json), "after": job.outcome.after.to_dict()}
    found = [
        result_dict(job.outcome),
        json.loads((outside / "result.json").read_text("utf-8")),
        json.loads((inside / "result.json").read_text("utf-8")),
        panel,
    ]
    assert found[0]["expected_ap"]["after"]["ap"] > found[0]["expected_ap"]["before"]["ap"]
    for each in found[1:]:
        own = {name: each[name] for name in each if name not in ALONE}
        assert own == {name: found[0][name] for name in found[0] if name not in ALONE}
    assert (inside / "history.csv").read_bytes() == (outside / "history.csv").read_bytes()
    first, last = (each.ap for each in job.outcome.in_traffic)
    told = [settings.result.figures[which]["traffic"]["ap"] for which in ("before", "after")]
    assert told == [first, last]


def test_the_curve_of_a_running_search_is_an_ap_that_rises(settings, monkeypatch):
    job = pt.OptimizeJob(scenes.study(), 1)
    scene = bpy.context.scene
    texts = lines_while_running(scene, job, monkeypatch)
    assert best_so_far.searches.pop(scene.name) == tuple(job.best.rig)
    assert any(", best AP ≈ 0." in text for text in texts)


def test_the_panels_show_what_an_objective_needs_and_found(settings):
    scene = bpy.context.scene

    def props(cls):
        notes = layouts.drawn(cls, **vars(layouts.Window(scene))).notes
        return [name for kind, name in notes if kind == "prop"]

    assert "objective" in props(search_panels.search)
    assert "scenes" in props(search_panels.search)
    assert "search_samples" not in props(search_panels.search)
    settings.evaluations = 2
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    shown = layouts.drawn(main.main, **vars(layouts.Window(scene))).texts("label")
    first, last = (settings.result.figures[w]["traffic"]["ap"] for w in ("before", "after"))
    row = shown.index("AP in traffic")
    was, now = f"{first:.3f}", f"{last:.3f}"
    assert shown[row + 1] == now and (shown[row + 2] == f"({was})") == (was != now)
    settings.objective = "entropy"
    assert "scenes" not in props(search_panels.search)
    assert "search_samples" in props(search_panels.search)
    assert bpy.ops.pe.score() == {"FINISHED"}


def test_choices_by_ap_are_variants_with_their_figures(settings):
    for model, price in (("Velodyne VLP-16 Puck", 2.0), ("Pandar40", 9.0)):
        row = bpy.data.objects["roof"].perception_entropy.options.add()
        row.model, row.price = model, price
    assert bpy.ops.pe.choose_sensors() == {"FINISHED"}
    assert [row.figures.split()[::2] for row in settings.front.rows] == [
        ["price", "ap", "entropy"] for _ in settings.front.rows
    ]
    front = settings.front
    assert front.note == "" and "front of price, expected AP; 2 " in front.told
    settings.objective = "entropy"
    assert bpy.ops.pe.choose_sensors() == {"FINISHED"}
    assert len(settings.front.rows) == 2 and settings.front.note == pt.advice.OTHER_HARDWARE


def test_variants_with_other_hardware_are_compared_with_a_note(settings):
    scene, roof = bpy.context.scene, bpy.data.objects["roof"]
    bpy.ops.pe.save_variant()
    roof.location.z += 0.2
    bpy.context.view_layer.update()
    bpy.ops.pe.save_variant()
    bpy.ops.pe.compare_variants()
    assert compare_variants.hardware_note(scene) == ""
    roof.perception_entropy.model = "Pandar40"
    bpy.ops.pe.save_variant()
    bpy.ops.pe.compare_variants()
    assert len(compare_variants.compared_variants(scene)) == 3
    assert compare_variants.hardware_note(scene) == pt.advice.OTHER_HARDWARE
    assert bridge.hardware_note([]) == ""
