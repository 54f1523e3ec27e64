"""Which sensors: a scene's choices are the engine's, its front is variants to click through."""

import json

import bpy
import pytest

from blender_addon.engine import jobs, pe
from tests.addon import scenes

CAN = "Velodyne VLP-16 Puck"
LARGE = "Pandar64"


def offer(name, *options, left_out=False):
    """Offer models at prices for a sensor's place."""
    own = bpy.data.objects[name].perception_entropy
    own.may_be_left_out = left_out
    for model, price in options:
        row = own.options.add()
        row.model = model
        row.price = price


@pytest.fixture
def offered(car):
    """The car with two models for its roof, at prices that single precision does not hold."""
    settings = car.perception_entropy
    settings.candidates = 1
    settings.search_samples = 1024
    settings.currency = "EUR"
    car.objects["roof"].perception_entropy.model = LARGE
    offer("roof", (LARGE, 99.1), (CAN, 7.3))
    car.objects["roof"].perception_entropy.free = (False,) * 6
    return car


def test_the_scene_s_choices_are_the_study_s(offered):
    scenes.add_sensor("eye", model="Camera 60 deg")
    offer("eye", ("Camera 30 deg", 1.0), left_out=True)
    offered.perception_entropy.limit_price = 99.2
    selection = scenes.study().selection
    assert [c.sensors for c in selection.choices] == [("eye",), ("roof",)]
    assert [c.optional for c in selection.choices] == [True, False]
    roof = selection.choices[1].options
    assert [(o.model.name, o.price) for o in roof] == [(LARGE, 99.1), (CAN, 7.3)]
    assert selection.currency == "EUR"
    assert scenes.study().limits.price == pe.Limit(99.2)


def test_each_design_of_the_front_is_a_variant_and_nothing_moves(offered):
    """Scores of the variants are the engine's, and switching puts the model there."""
    job = jobs.FrontJob(scenes.study())
    list(job)
    assert bpy.ops.pe.choose_sensors() == {"FINISHED"}
    settings = offered.perception_entropy
    assert offered.objects["roof"].perception_entropy.model == LARGE
    assert [row.name for row in settings.front.rows] == [d.name for d in job.trade_off.front]
    assert [row.name for row in settings.front.rows] == [CAN, LARGE]
    assert settings.front.told == job.trade_off.told
    rows = {row.key: row for row in settings.variants}
    for row, design in zip(settings.front.rows, job.trade_off.front, strict=True):
        kept = json.loads(rows[row.key].score_json)
        assert kept["entropy"] == design.entropy
        assert not rows[row.key].stale
    assert bpy.ops.pe.switch_variant(key=settings.front.rows[0].key) == {"FINISHED"}
    assert offered.objects["roof"].perception_entropy.model == CAN
    assert len(offered.objects["roof"].perception_entropy.options) == 2
