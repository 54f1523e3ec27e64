"""*Where?* in Blender: the same places and figures as on the command line, colours, and a click."""

import json

import bpy
import numpy as np

from blender_addon import panels, where_map
from blender_addon.engine import catalog, jobs, pe
from tests.addon import scenes
from tests.addon.command_line import pe_here, run_here
from tests.addon.layouts import Window, drawn

MODEL = "Camera 60 deg"


def asked(car, **options):
    given = {"model": MODEL, "places": 40, **options}
    assert bpy.ops.pe.where(**given) == {"FINISHED"}
    return where_map.maps.get(car.name)


def test_the_operator_finds_what_the_engine_finds(car):
    found = asked(car)
    sensor = pe.Sensor("Camera", catalog.load(MODEL))
    job = jobs.WhereJob(scenes.study(), sensor, count=40)
    assert list(job)[-1].stage == "done"
    assert found.places == job.found.places and found.base == job.found.base
    assert found.error == job.found.error > 0.0


def test_blender_and_pe_say_the_same(car, tmp_path):
    path = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    assert run_here(path, "export", "-o", tmp_path / "study").returncode == 0
    inside = run_here(path, "where", "--model", MODEL, "--places", "30", "--json")
    outside = pe_here(
        "where", tmp_path / "study" / "study.toml", "--model", MODEL, "--places", "30", "--json"
    )
    assert inside.stdout == outside.stdout and inside.returncode == outside.returncode == 0
    assert len(json.loads(inside.stdout)["places"]) == 30


def test_a_click_puts_the_sensor_there_and_the_score_is_the_promised_one(car):
    found = asked(car)
    best = found.best()[0]
    before = set(car.objects)
    assert bpy.ops.pe.take_place(point=best.point) == {"FINISHED"}
    (added,) = set(car.objects) - before
    assert added == bpy.context.active_object and added.perception_entropy.model == MODEL
    study = scenes.study()
    assert study.rig[added.name].pose == best.pose
    assert study.evaluator().entropy(study.rig) == best.value


def test_the_layer_colours_the_body_and_its_legend_has_units_and_reasons(car):
    found = asked(car, places=120)
    shape = scenes.drawn(car)["where"][""]
    assert len(shape.faces.points) > 3 * len(found.surface)
    grey = np.isclose(shape.faces.colors[:, :3].std(axis=1), 0.0, atol=1e-3)
    assert 0.02 < grey.mean() < 0.6
    title = shape.legend.title
    assert title.startswith(f"Entropy with {MODEL} here [nats]") and "± " in title
    reasons = [text for _, text in shape.legend.classes]
    assert reasons == [f"forbidden: {why} ({n})" for why, n in found.reasons().items()][:3]
    scenes.add_sensor("late", model=MODEL, location=(0.0, 0.0, 2.0))
    assert "before the last change" in scenes.drawn(car)["where"][""].legend.title
    bpy.ops.pe.dismiss(answer="PLACES")
    assert "where" not in scenes.drawn(car)


def test_the_panel_offers_it_and_another_file_has_no_places(car):
    asked(car)
    operators = drawn(panels.main.main, **vars(Window(car))).texts("operator")
    assert {"pe.where", "pe.take_place"} <= set(operators)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert where_map.maps.get(bpy.context.scene.name) is None
