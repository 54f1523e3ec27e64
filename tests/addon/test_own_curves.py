"""A sensor's own AP curve: from the panel to a study, a variant and a file, and back."""

import bpy
import pytest

from blender_addon import bridge
from blender_addon.engine import pe, studies
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


def test_a_group_of_two_curves_is_one_line(own):
    own.objects["roof"].perception_entropy.fusion = "front"
    with pytest.raises(pe.InputError, match="expected one AP curve, found two"):
        scenes.study()


def test_variants_keep_it(own):
    settings_of(own).curve_a, settings_of(own).curve_b = 0.21, 0.7
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    first = own.perception_entropy.variants[0]
    kept = bridge.study_of_variant(own, first, bpy.context.evaluated_depsgraph_get())
    assert kept.rig["front"].curve == OWN and kept.rig["roof"].curve is None
    settings_of(own).own_curve = False
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    assert len(own.perception_entropy.variants) == 2
    key = own.perception_entropy.variants[0].key
    assert bpy.ops.pe.switch_variant(key=key) == {"FINISHED"}
    assert scenes.study().rig["front"].curve == OWN


def test_a_study_file_brings_it_back(own, tmp_path):
    settings_of(own).curve_a, settings_of(own).curve_b = 0.21, 0.7
    path = tmp_path / "study.toml"
    assert bpy.ops.pe.export_study(filepath=str(path)) == {"FINISHED"}
    assert studies.load_study(path).rig["front"].curve == OWN
    settings_of(own).own_curve = False
    assert bpy.ops.pe.import_study(filepath=str(path)) == {"FINISHED"}
    assert scenes.study().rig["front"].curve == OWN and scenes.study().rig["roof"].curve is None
