"""Radars and ultrasonic sensors in Blender: added, scored as the engine does, covers, pictures."""

import bpy
import pytest

from tests.addon import scenes

ARS = "Continental ARS408-21"
PARKING = "Parking module 2.5 m"


@pytest.fixture
def front(car):
    """Return the car's scene with a radar and an ultrasonic sensor ahead of it."""
    scenes.add_sensor("front", ARS, location=(2.5, 0.0, 0.5))
    scenes.add_sensor("parking", PARKING, location=(2.5, 0.4, 0.5))
    return car


def test_objects_of_the_vehicle_are_covers(front):
    bpy.data.objects["front"].location.x = 1.8  # in the body
    parts = [o for o in front.perception_entropy.vehicle.objects if o.type == "MESH"]
    bpy.context.view_layer.update()
    blocked = scenes.study()
    for part in parts:
        part.perception_entropy.cover_loss_db = 1.7
    study = scenes.study()
    assert (
        dict(study.vehicle.covers) == {part.name: 1.7 for part in parts}
        and not blocked.vehicle.covers
    )
    before, after = (
        s.evaluator().score(s.rig).per_sensor["front"].coverage for s in (blocked, study)
    )
    assert before < after
