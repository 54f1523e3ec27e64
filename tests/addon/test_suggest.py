"""*What Would Fix It?* in Blender: as the command line says it, ghosts, and taking it."""

import bpy
import pytest

from blender_addon import panels
from blender_addon.engine import jobs
from blender_addon.panels.score_details import draw_offers
from blender_addon.queries import location_query, where_map
from tests.addon import scenes
from tests.addon.command_line import same_in_both
from tests.addon.layouts import Layout, Window, drawn

SPOT = (0.0, 1.7, 0.0)


def repairs(car, **options):
    assert bpy.ops.pe.suggest(**options) == {"FINISHED"}
    return where_map.offers.get(car.name)


def test_the_window_says_what_pe_says_of_a_blind_place(car, tmp_path):
    offers = repairs(car, point=SPOT)
    assert offers.found and offers.of == pytest.approx(SPOT)
    x, y, _ = offers.of
    told = same_in_both(tmp_path, "explain", ["--at", repr(x), repr(y), "--suggest"])
    assert told["suggestions"] == [each.to_dict() for each in offers.found]


def test_a_failed_requirement_is_mended_as_the_job_says(car):
    bpy.ops.pe.add_row(rows="requirements", kind="OWN")
    name = car.perception_entropy.requirements[0].name
    job = jobs.SuggestJob(scenes.study(), (name,))
    assert list(job)
    offers = repairs(car, requirement=name)
    wanted = [each.sentence for own in job.found.values() for each in own]
    assert ([each.sentence for each in offers.found] if offers else []) == wanted
    with pytest.raises(RuntimeError, match="nothing"):
        bpy.ops.pe.suggest(requirement="nothing")


def test_ghosts_stand_where_the_sensors_would_be_until_the_rig_changes(car):
    offers = repairs(car, point=SPOT)
    shape = scenes.drawn(car)["ghosts"][""]
    assert shape.legend.title == "Would fix it"
    assert {n for each in offers.found for n in each.moved} <= {tag.text for tag in shape.labels}
    where_map.discard_outdated()
    assert car.name in where_map.offers
    scenes.add_sensor("late", location=(0.0, 0.0, 2.0))
    where_map.discard_outdated()
    assert car.name not in where_map.offers and "ghosts" not in scenes.drawn(car)


def test_the_panel_asks_and_tells(car):
    bpy.ops.pe.ask_place(point=SPOT)
    assert location_query.answer(car) is not None
    answer = panels.score_details.explain
    assert "pe.suggest" in drawn(answer, **vars(Window(car))).texts("operator")
    offers = repairs(car, point=SPOT)
    layout = Layout()
    draw_offers(layout, Window(car), point=offers.of)
    text = " ".join(layout.texts("label"))
    assert text.lower().count("blind ground") == len(offers.found)
    done = {True: "Add It", False: "Move It"}
    assert layout.texts("operator") == [done[each.added] for each in offers.found]
