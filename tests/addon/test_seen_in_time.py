"""Stories in the panel: added, checked by the engine's numbers, shown, kept by a study and back."""

import json

import bpy
import pytest

from blender_addon.operators.compare_variants import pending_variants
from blender_addon.panels.condition_panel import conditions
from pe_core.motion import RATE_HZ, stories
from tests.addon import layouts, scenes


@pytest.fixture
def car(addon):
    scene = bpy.context.scene
    scene.perception_entropy.vehicle = scenes.add_car(scene)
    scenes.add_sensor("roof", location=(0.0, 0.0, 2.5))
    return scene


def test_a_story_is_added_checked_and_shown(car):
    settings = car.perception_entropy
    assert bpy.ops.pe.add_row(rows="stories", kind="cyclist_from_right") == {"FINISHED"}
    assert bpy.ops.pe.add_row(rows="stories", kind="crossing_child") == {"FINISHED"}
    settings.stories[0].speed_kmh = 20.0
    study = scenes.study()
    assert [each.name for each in study.stories] == ["cyclist_from_right", "crossing_child"]
    assert study.stories[0].speed_kmh == 20.0 and study.stories[1] == stories()["crossing_child"]
    assert bpy.ops.pe.check_requirements() == {"FINISHED"}
    for row, story in zip(settings.stories, study.stories, strict=True):
        told = json.loads(row.result)
        assert told.pop("signature")
        assert told == json.loads(json.dumps(study.drive_by(story).summary()))
    drawn = layouts.drawn(conditions, **vars(layouts.Window(car)))
    assert ("prop", "speed_kmh") in drawn.notes and ("prop", "track_needed") in drawn.notes
    settings.stories[1].enabled = False
    assert len(scenes.study().stories) == 1
    bpy.ops.pe.remove_row(rows="stories")
    assert len(settings.stories) == 1


def test_a_change_of_a_story_makes_the_figures_of_variants_stale(car):
    settings = car.perception_entropy
    bpy.ops.pe.add_row(rows="stories", kind="cyclist_from_right")
    bpy.ops.pe.save_variant()
    bpy.data.objects["roof"].location.x += 0.25
    bpy.ops.pe.save_variant()
    assert bpy.ops.pe.compare_variants() == {"FINISHED"}
    assert not pending_variants(car)
    settings.stories[0].latency_s = 0.9
    assert len(pending_variants(car)) == 2


def test_the_3d_view_shows_what_a_check_says(car):
    bpy.ops.pe.add_row(rows="stories", kind="cyclist_from_right")
    (item,) = scenes.drawn(car)["story"].values()
    driven = scenes.study().drive_by(scenes.study().stories[0])
    moment = driven.bodies[0].moments[0.9]
    marks = {mark.text: mark.time_s for mark in item.strip.marks}
    assert marks == {"must brake here": driven.story.brake_s, "confirmed here 90%": moment.time_s}
    late = item.at(5.0)
    k = round(5.0 * RATE_HZ)
    assert f"AP {driven.bodies[0].ap[k]:.2f}" in late.labels[-1].text
    rays = len(late.lines.points) - len(item.at(0.0).lines.points)
    assert rays == 2 * (int(driven.bodies[0].ap[k] > 0.0) - int(driven.bodies[0].ap[0] > 0.0))
    car.perception_entropy.view.show_story = False
    assert "story" not in scenes.drawn(car)
