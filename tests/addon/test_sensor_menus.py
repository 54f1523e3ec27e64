"""What there is to add: by kind, in a few words; and a search that finds."""

import bpy

from blender_addon import operators
from blender_addon.engine import catalog
from blender_addon.operators import add_sensor
from blender_addon.operators import add_sensor as offers


def test_a_sensor_in_a_few_words():
    told = offers.tooltip_of("Hesai AT128E2X")
    assert "channels 128, -12.47 to 12.93 deg" in told and "range 210 m" in told
    assert offers.tooltip_of("nobody's") == ""


def test_the_search_lists_a_kind_s_sensors_with_their_figures(addon):
    items = add_sensor._menu_items(type("Chosen", (), {"kind": "lidar"}), bpy.context)
    assert [each[0] for each in items] == catalog.names("lidar")
    (found,) = [each for each in items if "QT128" in each[1]]
    assert found[0] == "Hesai QT128C2X" and "range 50 m" in found[2]


def test_what_was_typed_is_found():
    assert catalog.matching("qt128") == ["Hesai QT128C2X"]
    assert catalog.matching("pandar64", "lidar") == [
        "Pandar64"
    ]  # itself, not those that contain it
    assert catalog.matching("QT128", "camera") == [] == catalog.matching("  ")
    assert len(catalog.matching("OS0")) > 1


def test_a_preset_of_one_s_own_is_offered_too():
    catalog.add("Mine", {"kind": "camera", "width": 640, "height": 480, "hfov_deg": 60})
    try:
        assert "Mine" in operators.models("camera")
    finally:
        catalog.remove("Mine")
