"""Scenarios in the panel: added, checked by the engine's numbers, shown, kept by a study."""

import json

import bpy
import pytest

from blender_addon.operators.compare_variants import pending_variants
from blender_addon.panels.condition_panel import conditions
from pe_core.motion import RATE_HZ, scenarios
from tests.addon import layouts, scenes


@pytest.fixture
def car(addon):
    scene = bpy.context.scene
    scene.perception_entropy.vehicle = scenes.add_car(scene)
    scenes.add_sensor("roof", location=(0.0, 0.0, 2.5))
    return scene


def test_a_scenario_is_added_checked_and_shown(car):
    settings = car.perception_entropy
    assert bpy.ops.pe.add_row(rows="scenarios", kind="cyclist_from_right") == {"FINISHED"}
    assert bpy.ops.pe.add_row(rows="scenarios", kind="crossing_child") == {"FINISHED"}
    settings.scenarios[0].speed_kmh = 20.0
    study = scenes.study()
    assert [each.name for each in study.scenarios] == ["cyclist_from_right", "crossing_child"]
    assert (
        study.scenarios[0].speed_kmh == 20.0 and study.scenarios[1] == scenarios()["crossing_child"]
    )
    assert bpy.ops.pe.check_requirements() == {"FINISHED"}
    for row, scenario in zip(settings.scenarios, study.scenarios, strict=True):
        told = json.loads(row.result)
        assert told.pop("signature")
        assert told == json.loads(json.dumps(study.drive_by(scenario).summary()))
    drawn = layouts.drawn(conditions, **vars(layouts.Window(car)))
    assert ("prop", "speed_kmh") in drawn.notes and ("prop", "track_needed") in drawn.notes
    settings.scenarios[1].enabled = False
    assert len(scenes.study().scenarios) == 1
    bpy.ops.pe.remove_row(rows="scenarios")
    assert len(settings.scenarios) == 1


def test_a_change_of_a_scenario_makes_the_figures_of_variants_stale(car):
    settings = car.perception_entropy
    bpy.ops.pe.add_row(rows="scenarios", kind="cyclist_from_right")
    bpy.ops.pe.save_variant()
    bpy.data.objects["roof"].location.x += 0.25
    bpy.ops.pe.save_variant()
    assert bpy.ops.pe.compare_variants() == {"FINISHED"}
    assert not pending_variants(car)
    settings.scenarios[0].latency_s = 0.9
    assert len(pending_variants(car)) == 2


def test_the_3d_view_shows_what_a_check_says(car):
    bpy.ops.pe.add_row(rows="scenarios", kind="cyclist_from_right")
    (item,) = scenes.drawn(car)["scenario"].values()
    driven = scenes.study().drive_by(scenes.study().scenarios[0])
    moment = driven.bodies[0].moments[0.9]
    marks = {mark.text: mark.time_s for mark in item.strip.marks}
    assert marks == {
        "must brake here": driven.scenario.brake_s,
        "confirmed here 90%": moment.time_s,
    }
    late = item.at(5.0)
    k = round(5.0 * RATE_HZ)
    assert f"AP {driven.bodies[0].ap[k]:.2f}" in late.labels[-1].text
    rays = len(late.lines.points) - len(item.at(0.0).lines.points)
    assert rays == 2 * (int(driven.bodies[0].ap[k] > 0.0) - int(driven.bodies[0].ap[0] > 0.0))
    car.perception_entropy.view.show_scenario = False
    assert "scenario" not in scenes.drawn(car)
