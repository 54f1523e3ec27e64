"""A sensor's own AP curve: from the panel to a study, a variant and a file, and back."""

import pytest

from blender_addon import bridge
from blender_addon.engine import pe
from tests.addon import scenes

OWN = pe.ApCurve(0.21, 0.7)


@pytest.fixture
def own(car):
    """Return a scene whose second LiDAR, a group of its own, has a curve of its own."""
    obj = scenes.add_sensor("front", model="Pandar40", location=(2.0, 0.0, 1.2))
    settings = obj.perception_entropy
    settings.fusion, settings.own_curve = "front", True
    return car


def settings_of(scene):
    return scene.objects["front"].perception_entropy


def test_it_begins_as_the_kind_s_and_counts_once_it_is_another(own):
    kind = pe.PerceptionModel().curve("lidar")
    assert scenes.study().rig["front"].curve == kind
    settings_of(own).curve_a, settings_of(own).curve_b = 0.21, 0.7
    rig = scenes.study().rig
    assert (rig["front"].curve, rig["roof"].curve) == (OWN, None)
    settings_of(own).own_curve = False
    assert scenes.study().rig["front"].curve is None
    settings_of(own).own_curve = True  # what was typed is not lost
    assert scenes.study().rig["front"].curve == OWN


def test_a_result_is_stale_once_it_changes(own):
    before = bridge.signature(own)
    settings_of(own).curve_a = 0.21
    changed = bridge.signature(own)
    settings_of(own).own_curve = False
    assert len({before, changed, bridge.signature(own)}) == 3
