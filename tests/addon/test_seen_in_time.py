"""Stories in the panel: added, checked by the engine's numbers, shown, kept by a study and back."""

import json
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector

import pe_core as pe
from blender_addon import bridge, film, result_staleness
from blender_addon.bridge.sensor_records import sensor_of
from blender_addon.operators.compare_variants import pending_variants
from blender_addon.panels.condition_panel import seen_in_time
from pe_core.motion import stories
from pe_tools import graphics
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
    drawn = layouts.drawn(seen_in_time, **vars(layouts.Window(car)))
    assert ("prop", "speed_kmh") in drawn.notes and ("prop", "track_needed") in drawn.notes
    settings.stories[1].enabled = False
    assert len(scenes.study().stories) == 1
    bpy.ops.pe.remove_row(rows="stories")
    assert len(settings.stories) == 1


def test_how_sensors_scan_gives_seams_and_is_kept(car):
    settings = car.perception_entropy
    low = scenes.add_sensor("low", location=(2.3, 0.3, 0.8))
    for obj, phase in ((bpy.data.objects["roof"], 0.0), (low, 0.5)):
        obj.perception_entropy.scan_turns, obj.perception_entropy.scan_phase = "left", phase
    settings.box_latency_s = 0.2
    bpy.ops.pe.add_row(rows="stories", kind="cyclist_from_right")
    bpy.ops.pe.check_requirements()
    told = json.loads(settings.stories[0].result)["bodies"][0]
    assert told["seam_of"] == ["low", "roof"] and told["seam_m"] > 0.1
    drawn = layouts.drawn(seen_in_time, **vars(layouts.Window(car)))
    assert any("low and roof see it up to" in str(note) for note in drawn.notes)
    assert ("prop", "box_latency_s") in drawn.notes
    study = scenes.study()
    assert study.rig["low"].scan == pe.ScanTiming("left", 0.5)
    assert study.confirmation.box_latency_s == 0.2
    (record,) = [r for r in bridge.records_of_scene(car) if r.name == "low"]
    assert sensor_of(record).scan == pe.ScanTiming("left", 0.5)
    low.perception_entropy.scan_phase = 0.25
    result_staleness.update_result()
    assert not settings.stories[0].result


def test_variants_that_differ_in_a_scan_are_two_and_keep_their_own_figures(car):
    settings, roof = car.perception_entropy, bpy.data.objects["roof"].perception_entropy
    bpy.ops.pe.add_row(rows="stories", kind="cyclist_from_right")
    roof.scan_turns = "left"
    bpy.ops.pe.save_variant()
    roof.scan_phase = 0.25
    bpy.ops.pe.save_variant()
    first, second = settings.variants
    assert not bridge.same_score(bridge.records_of(first), bridge.records_of(second))
    assert bpy.ops.pe.compare_variants() == {"FINISHED"}
    roof.scan_phase = 0.5
    assert not pending_variants(car)
    assert bpy.ops.pe.score() == {"FINISHED"}
    assert bool(settings.has_result)
    settings.stories[0].latency_s = 0.9
    assert len(pending_variants(car)) == 2


def animated(scene, name, body, path):
    """An object of 0.5 x 0.4 x 1.1 m that keyframes move straight: frame, x, y."""
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    obj = bpy.context.object
    obj.name, obj.scale = name, (0.5, 0.4, 1.1)
    obj.perception_entropy.body = body
    for frame, x, y in path:
        obj.location = (x, y, 0.55)
        obj.keyframe_insert("location", frame=frame)
    return obj


def test_any_animated_object_is_a_story(car):
    settings = car.perception_entropy
    with pytest.raises(RuntimeError, match="test bodies"):
        bpy.ops.pe.add_row(rows="stories", kind="animated")
    assert not settings.stories
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"
    car.frame_start, car.frame_end = 1, 73
    animated(car, "runner", "child", [(1, 14.0, -6.0), (73, 2.0, 0.0)])
    box = animated(car, "box", "HIDES", [(1, 8.0, -3.0)])
    box.rotation_euler.z = 0.5
    assert bpy.ops.pe.add_row(rows="stories", kind="animated") == {"FINISHED"}
    assert bpy.ops.pe.play_story() == {"FINISHED"}
    (story,) = scenes.study().stories
    assert (story.start_s, story.end_s, story.anchor) == (-3.0, 0.0, "origin")
    runner, hides = story.actors
    assert runner.watched and not hides.watched
    assert runner.body.size == pytest.approx((0.5, 0.4, 1.1))
    assert runner.body.class_name == "pedestrian"
    where, headings = story.positions(None)
    assert where[0, 0] == pytest.approx((14.0, -6.0)) and where[0, -1] == pytest.approx((2.0, 0.0))
    assert where[0, 15] == pytest.approx((8.0, -3.0), abs=1e-3)  # it does not ride with the speed
    assert where[1] == pytest.approx(where[1, :1].repeat(len(story.times), 0))
    assert headings[1] == pytest.approx(0.5, abs=1e-4)
    driven = scenes.study().drive_by(story)
    assert [body.name for body in driven.bodies] == ["runner"] and driven.bodies[0].ap.max() > 0.0
    (item,) = scenes.drawn(car)["story"].values()
    assert len(item.frames) == 73
    assert item.at(0.0).labels[0].text == item.at(9.0).labels[0].text  # the moments stay
    assert item.at(0.0).faces.points[:, 0].max() > 14.0 > item.at(9.0).faces.points[:, 0].max()


def test_the_3d_view_shows_what_a_check_says(car):
    bpy.ops.pe.add_row(rows="stories", kind="cyclist_from_right")
    (item,) = scenes.drawn(car)["story"].values()
    driven = scenes.study().drive_by(scenes.study().stories[0])
    moment = driven.bodies[0].moments[0.9]
    marks = {mark.text: mark.time_s for mark in item.strip.marks}
    assert marks == {"must brake here": driven.story.brake_s, "confirmed here 90%": moment.time_s}
    late = item.at(5.0)
    k = round(5.0 * driven.story.rate_hz)
    assert f"AP {driven.bodies[0].ap[k]:.2f}" in late.labels[-1].text
    rays = len(late.lines.points) - len(item.at(0.0).lines.points)
    assert rays == 2 * (int(driven.bodies[0].ap[k] > 0.0) - int(driven.bodies[0].ap[0] > 0.0))
    car.perception_entropy.view.show_story = False
    assert "story" not in scenes.drawn(car)


def test_a_film_is_a_scene_of_its_own(car):
    story = replace(stories()["cyclist_from_right"], start_s=-2.0)
    study = scenes.study()
    driven = study.drive_by(story)
    made = film.film_scene(car, study, story)
    assert (made.frame_start, made.frame_end) == (car.frame_start, car.frame_start + 48)
    assert made.render.stamp_note_text == graphics.digest(driven)
    assert "cabin" in made.objects, list(made.objects)
    moving = graphics.BodiesInTime.of(driven, study.vehicle, 24.0)
    strip, left = graphics.time_strip(driven), made.objects["cells"].location.x
    cursor = []
    layer = made.view_layers[0]
    for k in (0, 30, 48):
        made.frame_set(made.frame_start + k)
        layer.update()
        cursor.append(made.objects["cursor"].evaluated_get(layer.depsgraph).location.x - left)
        body = made.objects["cyclist"].evaluated_get(layer.depsgraph)
        assert tuple(body.location)[:2] == pytest.approx(moving.bodies[0].positions[k], abs=1e-4)
        ray = made.objects["roof cyclist"].evaluated_get(layer.depsgraph)
        ends = [ray.matrix_world @ Vector((x, 0.0, 0.0)) for x in (-0.5, 0.5)]
        if moving.bodies[0].by_sensor["roof"][k] > 0.0:
            assert tuple(ends[0]) == pytest.approx((0.0, 0.0, 2.5), abs=1e-3)
            assert tuple(ends[1]) == pytest.approx(tuple(body.location), abs=1e-3)
    shares = [strip.share(time) for time in (-2.0, -0.75, 0.0)]
    assert np.array(cursor) / cursor[-1] == pytest.approx(np.array(shares) / shares[-1], abs=1e-5)
    with pytest.raises(pe.InputError, match=r"\.webm"):
        film.write_film(car, study, story, Path("film.gif"))
