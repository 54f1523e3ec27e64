"""The sensors for the asset browser: each a ready sensor; the library comes and goes with us."""

import re

import bpy
import numpy as np
import pytest

import blender_addon
import pe_core as pe
from blender_addon import library, operators
from blender_addon.caches import sensor_cache
from blender_addon.preferences import own_catalog, preferences_panel, verification
from blender_addon.view.housing import KEY
from tests.addon import scenes

BLEND = library.FOLDER / "sensors.blend"
CATALOGS = library.FOLDER / "blender_assets.cats.txt"
KINDS = ("lidar", "camera")
MINE = """
["My LiDAR"]
kind = "lidar"
elevations_deg = [-15, 0, 5]
azimuth_step_deg = 1.0
max_range_m = 80
"""


def appended(*names):
    """Append assets as Blender does it, into the open scene; return them."""
    with bpy.data.libraries.load(str(BLEND), assets_only=True) as (_, wanted):
        wanted.objects = list(names)
    for obj in wanted.objects:
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return wanted.objects


@pytest.fixture
def assets(addon):
    """Return all assets of the file, linked to no scene."""
    with bpy.data.libraries.load(str(BLEND), assets_only=True) as (there, wanted):
        wanted.objects = list(there.objects)
    return wanted.objects


def test_there_is_an_asset_for_every_lidar_and_camera_of_the_catalogue(assets):
    models = [name for kind in KINDS for name in pe.catalog.names(kind)]
    assert sorted(each.perception_entropy.model for each in assets) == sorted(models)


def test_each_is_a_sensor_with_its_body_a_place_in_the_catalogue_tags_and_a_picture(assets):
    catalogs = dict(re.findall(r"^([0-9a-f-]{36}):([^:]+):", CATALOGS.read_text(), re.MULTILINE))
    for obj in assets:
        settings = obj.perception_entropy
        data = obj.asset_data
        assert settings.is_sensor, obj.name
        assert settings.stands_when_dropped, obj.name
        assert obj.data[KEY] == settings.model
        assert tuple(obj.location) == (0.0, 0.0, 0.0) and tuple(obj.scale) == (1.0, 1.0, 1.0)
        kind = pe.catalog.load(settings.model).kind
        assert catalogs[data.catalog_id].split("/")[0].lower() == kind
        words = {tag.name for tag in data.tags}
        known = pe.catalog.housing(settings.model) is not None
        assert {"sensor", "true size" if known else "typical size"} <= words
        assert data.description and data.license
        assert not is_blank(obj.preview), obj.name


def is_blank(preview):
    """Whether a preview shows nothing."""
    if preview is None or not preview.image_size[0]:
        return True
    pixels = np.empty(preview.image_size[0] * preview.image_size[1] * 4, np.float32)
    preview.image_pixels_float.foreach_get(pixels)
    return np.ptp(pixels) < 0.5


def test_an_appended_asset_is_a_sensor_at_once(car):
    before = len(sensor_cache.sensors(car))
    (puck,) = appended("VLP-16 Puck")
    puck.location = (0.4, 0.0, 1.9)
    bpy.context.view_layer.update()
    sensor_cache.invalidate()
    assert len(sensor_cache.sensors(car)) == before + 1
    study = scenes.study()
    assert study.rig[puck.name].model is pe.catalog.load("Velodyne VLP-16 Puck")
    assert study.rig[puck.name].pose.position == (0.4, 0.0, 1.9)
    assert {part for part in study.vehicle.part_names} == {"body", "cabin"}


def libraries():
    """Names and paths of Blender's asset libraries."""
    return [(each.name, each.path) for each in bpy.context.preferences.filepaths.asset_libraries]


@pytest.fixture
def enabled(unregistered):
    """Register as Blender does it for an extension: with an entry in its preferences."""
    before = libraries()
    entry = bpy.context.preferences.addons.new()
    entry.module = blender_addon.__name__
    blender_addon.register()
    try:
        yield before, entry
    finally:
        blender_addon.unregister()
        bpy.context.preferences.addons.remove(entry)
    assert libraries() == before


def test_the_library_comes_and_goes_with_the_extension(enabled):
    before, entry = enabled
    assert entry.preferences.show_library
    (ours,) = [each for each in libraries() if each not in before]
    assert ours == (library.NAME, str(library.FOLDER))
    found = bpy.context.preferences.filepaths.asset_libraries[-1]
    assert found.import_method == "APPEND"
    blender_addon.unregister()
    assert libraries() == before
    blender_addon.register()
    assert libraries() == [*before, ours]


def test_sensors_of_an_own_catalogue_are_in_the_menus_of_all_files(enabled, tmp_path):
    """They go with the preference, and with the extension; a wrong file has its line."""
    stored = enabled[1].preferences
    path = tmp_path / "mine.toml"
    path.write_text(MINE)
    stored.own_catalog = str(path)
    assert not own_catalog.problem and "My LiDAR" in operators.models("lidar")
    preferences_panel.unregister()
    assert "My LiDAR" not in operators.models("lidar")
    preferences_panel.register()
    assert "My LiDAR" in operators.models("lidar")
    path.write_text(MINE + '[Pandar64]\nkind = "lidar"\n')
    stored.own_catalog = str(path)
    assert "My LiDAR" not in operators.models("lidar") and "a name used once" in own_catalog.problem
    stored.own_catalog = ""
    assert not own_catalog.problem


def test_the_engine_is_verified_from_the_preferences(enabled, monkeypatch):
    """What came of it stands there; so does an engine that cannot be verified."""
    told = ("2 of 3 golden cases are right, 0.1 s", "FAILED LiDAR, range: 1 in place of 2")
    monkeypatch.setattr(verification.verify, "verify_in_short", lambda: told)
    assert bpy.ops.pe.verify_engine() == {"FINISHED"}
    assert verification.lines() == told and not verification.is_running()

    def fail():
        raise pe.InputError("engine", "process", "one that starts", "none")

    monkeypatch.setattr(verification.verify, "verify_in_short", fail)
    assert bpy.ops.pe.verify_engine() == {"FINISHED"}
    first, second = verification.lines()
    assert "one that starts" in first and second.startswith("FAILED")
