"""Variants: kept, put back exactly, nothing lost; their scores are those of the scene."""

import base64
import json
from dataclasses import replace
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from blender_addon import document
from blender_addon.caches import result_staleness
from blender_addon.engine import advice
from blender_addon.operators import compare_variants
from blender_addon.queries import diagnostics
from tests.addon import scenes
from tests.addon.layouts import Layout


@pytest.fixture
def ideas(car):
    """Return a scene with two sensors at awkward places, saved as "Variant"."""
    scenes.add_sensor("eye", model="Camera 60 deg", location=(0.70001, -0.12345, 1.23457))
    car.objects["eye"].rotation_euler = np.radians((1.2345, 67.8901, -123.4567))
    car.objects["roof"].perception_entropy.free = (False, True) * 3
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    return car


def variants(scene):
    """Names of a scene's variants."""
    return [row.name for row in scene.perception_entropy.variants]


def rows(scene):
    return {row.name: row for row in scene.perception_entropy.variants}


def switch(scene, name):
    return bpy.ops.pe.switch_variant(key=rows(scene)[name].key)


def poses():
    return {sensor.name: (sensor.pose, sensor.model) for sensor in scenes.study().rig}


def remove(scene, name):
    bpy.data.objects.remove(scene.objects[name])
    bpy.context.view_layer.update()


def test_switching_brings_every_sensor_back_to_the_bit(ideas):
    before = poses()
    start = document.records_of_scene(ideas)
    bpy.ops.pe.save_variant()
    second = ideas.objects["roof"]
    second.location = (0.123456, 0.2, 1.9)
    second.perception_entropy.model = "HDL-64E"
    second.perception_entropy.free = (True,) * 6
    bpy.context.view_layer.update()
    bpy.ops.pe.update_variant()
    moved = poses()
    assert moved != before
    for _ in range(3):
        assert switch(ideas, "Variant") == {"FINISHED"}
        assert poses() == before
        assert document.same_sensors(document.records_of_scene(ideas), start)
        assert switch(ideas, "Variant 2") == {"FINISHED"}
        assert poses() == moved
    assert variants(ideas) == ["Variant", "Variant 2"], "nothing was unsaved"


def test_what_was_not_saved_is_kept(ideas):
    ideas.objects["roof"].location.z = 2.5
    bpy.context.view_layer.update()
    changed = poses()
    switch(ideas, "Variant")
    assert variants(ideas) == ["Variant", "Unsaved"]
    assert poses() != changed
    switch(ideas, "Unsaved")
    assert poses() == changed
    assert variants(ideas) == ["Variant", "Unsaved"]
    ideas.objects["roof"].location.z = 2.6
    bpy.context.view_layer.update()
    switch(ideas, "Variant")
    assert variants(ideas) == ["Variant", "Unsaved", "Unsaved 2"]


def test_lacking_sensors_are_made_and_surplus_ones_set_aside(ideas):
    both = poses()
    remove(ideas, "eye")
    scenes.add_sensor("third", model="HDL-64E", location=(1.0, 0.0, 2.0))
    bpy.ops.pe.save_variant()
    switch(ideas, "Variant")
    assert poses() == both
    assert [obj.name for obj in document.sensor_objects(ideas)] == ["eye", "roof"]
    third = ideas.objects["third"]
    assert not third.visible_get() and not third.perception_entropy.is_sensor
    switch(ideas, "Variant 2")
    assert set(poses()) == {"roof", "third"}
    assert ideas.objects["third"] == third, "the very object, with all that it has"


def test_the_mark_tells_that_the_scene_is_another(ideas):
    settings = ideas.perception_entropy
    result_staleness.update_variants()
    assert not settings.variant_changed
    ideas.objects["roof"].location.x += 0.001
    bpy.context.view_layer.update()
    result_staleness.update_variants()
    assert settings.variant_changed
    ideas.objects["roof"].location.x -= 0.001
    bpy.context.view_layer.update()
    result_staleness.update_variants()
    assert not settings.variant_changed
    ideas.objects["roof"].scale = (2.0, 2.0, 2.0)  # no possible sensor
    bpy.context.view_layer.update()
    result_staleness.update_variants()
    assert settings.variant_changed


def test_a_score_goes_to_the_variant_that_stands(ideas):
    assert not rows(ideas)["Variant"].has_result
    bpy.ops.pe.copy_row(rows="variants")
    ideas.objects["roof"].location.z = 2.5
    bpy.context.view_layer.update()
    bpy.ops.pe.score()
    assert not rows(ideas)["Variant"].has_result, "it was not this one that was scored"
    switch(ideas, "Variant")
    assert rows(ideas)["Unsaved"].has_result, "it was kept with the score that it had"
    bpy.ops.pe.score()
    first = rows(ideas)["Variant"]
    second = rows(ideas)["Variant 2"]
    assert first.has_result and second.entropy == first.entropy
    result_staleness.update_variants()
    assert not first.stale
    ideas.perception_entropy.prior = "uniform"
    result_staleness.update_variants()
    assert first.stale


def test_a_variant_that_is_switched_to_shows_its_own_result(ideas):
    """Figures, words and the sensors' rows are those of when it was scored; others are marked."""

    def shown():
        settings = ideas.perception_entropy
        found = json.loads(settings.result_json)
        kept = {k: found[k] for k in ("entropy", "coverage", "after", "placements", "inputs")}
        return kept, diagnostics.explanation(ideas), settings.result_stale

    bpy.ops.pe.score()
    first = shown()
    ideas.objects["roof"].location.x += 0.5
    bpy.context.view_layer.update()
    bpy.ops.pe.save_variant()
    bpy.ops.pe.score()
    second = shown()
    assert first != second
    for name, own in (("Variant", first), ("Variant 2", second)):
        switch(ideas, name)
        assert shown() == own
    ideas.perception_entropy.variants[0].score_json = ""
    switch(ideas, "Variant")
    assert ideas.perception_entropy.result_stale, "what is shown is of the other one"
    ideas.perception_entropy.prior = "uniform"
    switch(ideas, "Variant 2")
    assert ideas.perception_entropy.result_stale, "its score was made under another prior"


def test_a_held_sensor_is_reported_and_nothing_is_changed(ideas):
    bpy.ops.pe.save_variant()
    roof = ideas.objects["roof"]
    roof.location.z = 2.5
    scenes.add_sensor("third", location=(1.0, 0.0, 2.0))
    roof.constraints.new("LIMIT_LOCATION").use_min_z = True
    roof.constraints[0].min_z = 2.4
    bpy.context.view_layer.update()
    before = poses()
    with pytest.raises(RuntimeError, match="sensor 'roof': placement: expected an object that can"):
        switch(ideas, "Variant")
    bpy.context.view_layer.update()
    assert poses() == before


def unknown(variant):
    """Give the first sensor of a variant a model that there is not."""
    first, *others = document.records_of(variant)
    document.write_records(variant, [replace(first, model="no such sensor"), *others])


def test_a_variant_that_cannot_be_scored_is_reported_and_the_others_are(ideas):
    bpy.ops.pe.copy_row(rows="variants")
    unknown(ideas.perception_entropy.variants[0])
    bpy.ops.pe.compare_variants()
    assert [row.has_result for row in ideas.perception_entropy.variants] == [False, True]
    unknown(ideas.perception_entropy.variants[1])
    ideas.perception_entropy.variants[1].score_json = ""
    with pytest.raises(RuntimeError, match=r"variant .Variant.*names, such as"):
        bpy.ops.pe.compare_variants()


def test_bars_have_the_largest_difference_first_and_the_longest_is_full(ideas):
    """Rows without a sure difference are last; a bar is as long as its value in the row."""
    bpy.ops.pe.copy_row(rows="variants")
    ideas.objects["roof"].location.z += 0.6
    bpy.context.view_layer.update()
    bpy.ops.pe.update_variant()
    bpy.ops.pe.compare_variants()
    names, table = compare_variants.comparison_of(ideas)
    rows = compare_variants.of_rigs(table)
    spreads = [row.spread for row in rows]
    assert spreads == sorted(spreads, reverse=True) and spreads[0] > 0.0
    assert {row.measure for row in rows} >= {
        "blind_ground",
        "blind_sector",
        "reach",
        "entropy",
        "coverage",
    }
    for row in rows:
        ends = sorted(abs(value) for value in row.values)
        if row.spread:
            assert row.spread == pytest.approx(abs(row.values[0] - row.values[1]) / ends[-1])
        if min(row.values) > 0.0:
            shares = [row.share(k) for k in range(2)]
            assert shares == pytest.approx([value / ends[-1] for value in row.values])
    pictures = [document.picture_of(row) for row in compare_variants.compared_variants(ideas)]
    assert all(base64.b64decode(each).startswith(b"\x89PNG") for each in pictures)
    assert pictures[0] != pictures[1], "the sensor stands elsewhere"
    ideas.perception_entropy.panels = "SIMPLE"
    window = {"names": ["entropy", "b"], "rows": table, "pictures": [], "said": ["entropy"]}
    layouts = {"RIG": Layout(), "PARTS": Layout()}
    for part, layout in layouts.items():
        shown = SimpleNamespace(layout=layout, part=part, **window)
        compare_variants.show_comparison.draw(shown, bpy.context)
    bars = layouts["RIG"].texts("bar")
    texts = layouts["RIG"].texts("label")
    assert compare_variants.label_of(rows[0]) in texts[: 2 + len(names)]
    assert bars[: len(names)] == [pytest.approx(rows[0].share(k)) for k in (0, 1)]
    assert len(bars) == 2 * len(rows) and not layouts["PARTS"].texts("bar")
    labels = layouts["PARTS"].texts("label")
    assert {"Score, lower is better", "entropy"} <= {*labels}, "names stay"
    assert "    Near" in labels and "score" in layouts["RIG"].texts("label")


def test_what_a_difference_is_worth_is_that_of_the_scenes_study(car):
    """Of LiDARs alone, by default settings; with another prior or a camera nothing is said."""
    for height in (0.0, 0.3):
        car.objects["roof"].location.z += height
        bpy.context.view_layer.update()
        bpy.ops.pe.save_variant()
    own = list(car.perception_entropy.variants)
    study = scenes.study()
    car.perception_entropy.prior = "road"
    for axis, (low, high) in zip("xyz", ((-80, 80), (-40, 40), (0, 5)), strict=True):
        setattr(car.perception_entropy, f"space_{axis}", (low, high))
    found = document.worth_of_differences(car, own)
    assert set(found) == {"entropy", "traffic_ap", "coverage"}
    assert found == advice.worth_rows(scenes.study(), [study.rig] * 2, one_vehicle=True)
    car.perception_entropy.prior = "highway"
    assert document.worth_of_differences(car, own) == {}
