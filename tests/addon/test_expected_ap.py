"""Expected AP in traffic as the objective: the panel, headless Blender, `pe` and a job agree."""

import bpy
import pytest

import pe_tools as pt
from blender_addon.panels import main, search_panels
from tests.addon import layouts, scenes


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
