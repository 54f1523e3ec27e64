"""The kind of sensor in `toy_kind` is added, scored, searched, listed and drawn in Blender.

A toy ring: m depends on the distance alone. No module of the add-on knows of it.
"""

from pathlib import Path

import bpy
import numpy as np
import pytest

import blender_addon
import pe_core as pe
from blender_addon import document, panels, properties, sensor_kinds
from blender_addon.engine import advice
from blender_addon.operators import models, offers
from blender_addon.view import housing
from pe_core import catalog
from pe_core import sensors as kinds
from tests.addon import scenes
from tests.addon.layouts import Layout, Window
from tests.engine.toy_kind import RING

PRESET = "Parking Ring"


@pytest.fixture
def ring_kind(car):
    """Have the kind and a preset of it in the engine's tables for a test, and a car to try it."""
    kinds.register(RING)
    catalog.add(PRESET, {"kind": "toyring", "range_m": 12.0})
    yield car
    catalog.remove(PRESET)
    kinds.unregister("toyring")


@pytest.fixture
def ring(ring_kind):
    """Return the ring that the operator has added, at the car's front."""
    return scenes.add_sensor("bumper", PRESET, location=(2.1, 0.0, 0.5))


def test_it_is_offered_beside_the_others(ring_kind):
    assert [(o.label, o.usual, models(o.kind)) for o in offers()][4:] == [
        ("Toy Ring", PRESET, [PRESET])
    ]
    assert (PRESET, "Toy Ring") in properties.model_suggestions(None, None, "")
    layout = Layout()
    settings = bpy.context.scene.perception_entropy
    settings.kind_to_add = "toyring"
    panels.main.draw_add(layout, settings, simple=False)
    assert layout.notes == [
        ("prop", "kind_to_add"),
        ("operator", "Add"),
        ("operator", "Place"),
        ("operator", ""),
        ("operator", "pe.where"),
    ]


def test_the_operator_scores_it_as_the_engine_does(ring_kind, ring):
    study = scenes.study()
    expected = study.evaluator().score(study.rig)
    assert bpy.ops.pe.score() == {"FINISHED"}
    own = document.figures_of_sensor(ring)
    assert own.beams == own.occluded == 0
    assert own.entropy == pytest.approx(expected.per_sensor["bumper"].entropy, abs=1e-5)
    assert own.coverage == pytest.approx(expected.per_sensor["bumper"].coverage, abs=1e-6) != 0.0
    assert own.entropy != document.figures_of_sensor(ring_kind.objects["roof"]).entropy


def test_the_panel_shows_what_was_stored(ring_kind, ring):
    bpy.ops.pe.score()
    ring_kind.perception_entropy.panels = "ALL"
    layout = Layout()
    own = document.figures_of_sensor(ring)
    panels.sensor_lists.draw_sensors(layout, Window(ring_kind))
    assert list(filter(None, layout.texts("operator"))) == ["bumper", "roof"]
    shown = layout.texts("label")
    assert shown[shown.index(PRESET) + 1] == advice.loss_text(own.lost) != ""


def test_the_search_moves_it(ring_kind, ring):
    ring_kind.objects["roof"].perception_entropy.free = (False,) * 6
    ring_kind.perception_entropy.candidates = 12
    ring_kind.perception_entropy.method = "random"
    ring_kind.perception_entropy.keep_blind_sector = False  # quick: worker processes lack the kind
    ring.location.z = 3.0  # where it sees little
    start = scenes.study().rig["bumper"].pose
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    settings = ring_kind.perception_entropy
    assert settings.result.kind == "optimize"
    assert settings.result.entropy < settings.result.entropy_before
    assert scenes.study().rig["bumper"].pose != start


def test_a_row_gives_it_a_housing_and_fields(ring_kind, ring, monkeypatch):
    box = pe.Housing("box", (0.5, 0.4, 0.3), (0.0, 0.0, 0.15), "a test")
    row = sensor_kinds.KindRow(
        sensor_kinds.OTHER.mount, lambda _model: box, own_fields=("max_range",)
    )
    monkeypatch.setitem(sensor_kinds.ROWS, "toyring", row)
    assert sensor_kinds.row_of("toyring").own_fields == ("max_range",)
    surface = housing.model_surface(PRESET)
    np.testing.assert_allclose(np.ptp(surface.points, axis=0), (0.5, 0.4, 0.3), atol=0.01)


def test_the_add_on_never_heard_of_it():
    """The proof that no module had to be touched: none of them holds its name."""
    for path in Path(blender_addon.__file__).parent.rglob("*.py"):
        assert "toyring" not in path.read_text("utf-8").lower(), path.name
