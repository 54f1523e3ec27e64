"""The dashboard: the engine's figures, what is wanted, what is kept; *Simple* and *All*."""

import json
import math
import re

import bpy
import pytest

from blender_addon import document
from blender_addon.engine import jobs, pe, search
from blender_addon.operators import known_rigs
from blender_addon.panels import CLASSES, dashboard, layout, main
from blender_addon.processes import engine_calls
from tests.addon import layouts, scenes

TERMS = re.compile(r"\bnats\b|\bprior\b|\bfusion\b|entropy", re.IGNORECASE)
"""Words that *Simple* does without; the name of the product apart."""


def window(scene):
    return layouts.Window(scene, scene.objects["roof"])


def shown(scene):
    """What the first panel shows."""
    return layouts.drawn(main.main, **vars(window(scene)))


def panels(scene, *, roots=False):
    """The panels of the sidebar that are there."""
    there = [cls for cls in CLASSES if issubclass(cls, bpy.types.Panel)]
    there = [cls for cls in there if cls.poll(window(scene)) and cls.bl_region_type == "UI"]
    return [cls for cls in there if not (roots and hasattr(cls, "bl_parent_id"))]


def test_its_values_are_those_of_the_score(car):
    bpy.ops.pe.score()
    texts = shown(car).texts("label")
    result = car.perception_entropy.result
    rows = result.data["dashboard"]
    assert {row["figure"] for row in rows} == {*search.KEPT, "requirements", "entropy"}
    for row in rows:
        figure = search.FIGURES[row["figure"]]
        if row["value"] is not None and figure.is_seen:
            assert figure.text(row["value"]).replace("m2", "m²") in texts
    assert f"{result.entropy:.3f}" in texts
    data = json.loads(car.perception_entropy.result_json)
    data["figures"]["after"]["reach"] = {"car": [20.0, True], "cone": [20.0, True]}
    data["figures"]["after"]["values"]["reach"] = 20.0
    car.perception_entropy.result_json = json.dumps(data)
    assert "≥ 20 m" in shown(car).texts("label"), "the space ends there"


def test_what_is_wanted_is_met_or_not_and_is_the_study_s(car):
    settings = car.perception_entropy
    bpy.ops.pe.score()
    value = search.FIGURES["blind_ground"].value(
        search.KeyFigures.from_dict(settings.result.data["figures"]["after"])
    )
    assert "Wanted" in shown(car).texts("label")
    for wanted, text in ((0.0, "0 of 1 met"), (value + 1.0, "1 of 1 met")):
        settings.limit_blind_ground = wanted
        assert text in shown(car).texts("label")
        limit = scenes.study().limits.value("blind_ground")
        assert limit == pytest.approx(wanted, rel=1e-6)
    settings.keep_blind_ground = False
    settings.keep_ap_near = True
    kept = [key for key, limit in scenes.study().limits if limit.kept]
    assert kept == ["blind_sector", "ap_near"]
    bpy.ops.pe.score()
    (row,) = (r for r in settings.result.data["dashboard"] if r["figure"] == "blind_ground")
    assert row["met"] and not row["kept"]
    settings.limit_blind_ground = -100.0  # no limit: a lower number is none, 0 may be one
    assert scenes.study().limits == search.Limits(blind_sector=True, ap_near=True)


def test_only_the_figures_that_are_chosen_are_computed_and_shown(car):
    """What has a limit stays; the study, and a score without a window, have the same."""
    settings = car.perception_entropy
    assert settings.figures == set(search.SHOWN)
    settings.figures = {"reach", "height", "entropy"}
    bpy.ops.pe.score()
    result = settings.result
    limited = {key for key, _ in scenes.study().limits}
    assert limited
    assert {row["figure"] for row in result.data["dashboard"]} == {"reach", "entropy", *limited}
    values = result.data["figures"]["after"]["values"]
    assert values.keys() == {"reach", "height", *limited}
    assert scenes.study().figures == ("reach", "entropy", "height")
    assert values == jobs.ScoreJob(scenes.study()).run().figures_after.values
    texts = shown(car).texts("label")
    hidden = set(search.KEPT) - {"reach", *limited}
    assert search.FIGURES["reach"].label in texts
    assert hidden
    assert not {search.FIGURES[key].label for key in hidden} & set(texts)


def test_a_good_score_is_told_by_the_known_rigs_on_this_body(car):
    """As many are worse as by a score of each in its turn, beyond two standard errors of the
    difference; another body is asked about again."""
    bpy.ops.pe.score()
    study = scenes.study()
    settings = car.perception_entropy
    assert not [text for text in shown(car).texts("label") if "known rigs" in text]
    known_rigs.request(car, study, "of this body")
    kept = json.loads(settings.known_rigs_json)
    evaluator = study.evaluator(samples=engine_calls.HELD_SAMPLES)
    worse = 0
    for key, (value, stderr) in kept["entropies"].items():
        rig = pe.catalog.rig_on(pe.catalog.known_rig(key), study.vehicle)
        assert value == evaluator.entropy(rig)
        error = math.hypot(stderr, settings.result.stderr)
        worse += value - settings.result.entropy > 2.0 * error > 0.0
    told = f"Better than {worse} of {len(kept['entropies'])} known rigs"
    assert told in shown(car).texts("label")
    settings.known_rigs_json = json.dumps({**kept, "entropies": {}})
    known_rigs.request(car, study, "of this body")
    assert not json.loads(settings.known_rigs_json)["entropies"], "asked once"
    known_rigs.request(car, study, "of another")
    assert json.loads(settings.known_rigs_json) == {**kept, "of": "of another"}


def test_simple_has_eight_headers_at_most_and_no_terms(car):
    bpy.ops.pe.score()
    document.store_warnings(car.perception_entropy, [])
    simple = panels(car, roots=True)
    assert len(simple) <= 8
    for cls in panels(car):
        drawn = layouts.drawn(cls, **vars(window(car)))
        texts = [*drawn.texts("label"), *drawn.texts("operator"), cls.bl_label]
        found = [text for text in texts if text and TERMS.search(str(text))]
        assert not [t for t in found if t != "Perception Entropy"], cls.__name__
    car.perception_entropy.panels = "ALL"
    assert len(panels(car, roots=True)) > len(simple)
    assert f"{car.perception_entropy.result.entropy:.3f} nats" in shown(car).texts("label")
    assert json.loads(car.perception_entropy.result_json)["dashboard"]


@pytest.mark.parametrize("width", [180, 200, 215, 260, 280, 500])
def test_figures_are_never_cut_names_give_way(car, width):
    """In a sidebar of 215 px it said "Score 3....."."""
    bpy.ops.pe.score()
    shown_in = layouts.Window(car, car.objects["roof"])
    shown_in.region.width = width
    car.perception_entropy.limit_blind_ground = 12.5
    limits = document.limits_of(car.perception_entropy)
    row = search.dashboard(None, 3.25, limits=limits)[0]
    rows = [
        dashboard.DrawnRow(
            row, name="Requirements", value="12.3 m2", before=before, sense=1, is_noise=False
        )
        for before in ("", "45.6")
    ]
    sides = dashboard.RowWidths.of(shown_in, rows)
    size = layout.room_px(shown_in, 0.0)[1]
    used = sides.name + sides.value + sides.wanted
    assert used <= layout.room_px(shown_in, dashboard.BESIDE_ROW_PX)[0] + 1e-6
    assert sides.value > layout.text_px("12.3 m2", size)
    if sides.has_room:
        assert sides.wanted > layout.text_px("(45.6)", size)
    if sides.has_fields:
        assert sides.wanted > layout.text_px("12.5 m2", size), "nor what is wanted"
    assert sides.has_fields == (width >= 260)
    assert sides.has_room == (width >= 260)
    name = dashboard.name_in(shown_in, rows[0]._replace(name=row.figure.label), sides.text_room)
    if width >= 200:
        assert name in (row.figure.label, row.figure.short), "whole words"
    if width == 500:
        assert name == row.figure.label


def test_simple_has_few_panels_fields_and_buttons(car):
    """What no designer presses in the first hour is in *All*."""
    bpy.ops.pe.add_row(rows="requirements", kind="ncap26_reverse_static")
    bpy.ops.pe.save_variant()
    bpy.ops.pe.score()
    notes = [n for cls in panels(car) for n in layouts.drawn(cls, **vars(window(car))).notes]
    drawn = [kind for kind, *_ in notes]
    assert len(panels(car)) <= 8
    assert drawn.count("prop") <= 30 and drawn.count("operator") <= 30


def test_all_panels_are_drawn_before_there_is_a_score(car):
    car.perception_entropy.panels = "ALL"
    for cls in panels(car):
        layouts.drawn(cls, **vars(window(car)))
