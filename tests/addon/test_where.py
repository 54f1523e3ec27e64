"""*Where?* in Blender: the same places and figures as on the command line, colours, and a click."""

import bpy

from blender_addon.engine import catalog, jobs, pe
from blender_addon.queries import where_map
from tests.addon import scenes
from tests.addon.command_line import same_in_both

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
    told = same_in_both(tmp_path, "where", ["--model", MODEL, "--places", "30"])
    assert len(told["places"]) == 30


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
