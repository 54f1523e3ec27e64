"""A LiDAR dragged from the asset browser onto the roof, with a real mouse."""

import re
from pathlib import Path

CATALOGS = Path(__file__).resolve().parents[2] / "blender_addon/assets/blender_assets.cats.txt"
ROOF = (-0.4, 0.0, 1.45)
EFFECT_TIMEOUT_S = 90
SENSORS = """
kept["sensors"] = {
    each.name: {
        "model": each.perception_entropy.model,
        "place": list(each.matrix_world.translation),
        "up": each.matrix_world.col[2][2],
        "body": each.data.get("pe_housing") if each.data else None,
    }
    for each in window.scene.objects if each.perception_entropy.is_sensor
}
"""
LOOK_FROM_ABOVE = """
from mathutils import Euler
look = area.spaces.active.region_3d
look.view_location, look.view_distance = (0.0, 0.0, 0.7), 7.0
look.view_rotation = Euler((0.6, 0.0, 2.2)).to_quaternion()
window.scene.perception_entropy.show_overlay = False
"""


def catalog_id(path):
    """A catalogue's id by its path."""
    return re.search(rf"^([0-9a-f-]+):{path}:", CATALOGS.read_text(), re.MULTILINE)[1]


def first_asset(stage):
    """Where the first asset of the browser is on the screen."""
    kept = stage.do("""
        below = next(a for a in window.screen.areas if a.ui_type == "ASSETS")
        list_ = next(r for r in below.regions if r.type == "WINDOW")
        kept["first"] = [list_.x + 50, window.height - (list_.y + list_.height) + 60]
    """)
    return tuple(kept["first"])


def test_an_asset_dropped_on_the_roof_is_a_sensor_that_stands_there(stage, screenshots):
    before = stage.do(SENSORS)["sensors"]
    stage.show_assets(catalog_id("LiDAR/Velodyne"))
    stage.do(LOOK_FROM_ABOVE)
    stage.rest()

    def dropped():
        """Blender does not say when it has read the assets; before, a drag does nothing."""
        stage.drag(first_asset(stage), stage.place_of(ROOF))
        stage.rest()
        return len(stage.do(SENSORS)["sensors"]) > len(before)

    stage.wait_for(dropped, EFFECT_TIMEOUT_S, "a new sensor")
    stage.photograph(screenshots / "window_assets.png")

    after = stage.do(SENSORS)["sensors"]
    (new,) = [after[name] for name in after.keys() - before.keys()]
    assert new["model"].startswith("Velodyne ")
    assert new["body"] == new["model"]
    x, y, z = new["place"]
    assert abs(x - ROOF[0]) < 0.3 and abs(y - ROOF[1]) < 0.3
    assert 1.4 < z < 1.65, "it does not stand on the roof"
    assert new["up"] > 0.9
    assert {name: after[name] for name in before} == before
    assert "Traceback" not in stage.log.read_text()


def test_the_preferences_take_the_library_away(stage):
    names = "[each.name for each in bpy.context.preferences.filepaths.asset_libraries]"
    stage.wait_until(f"'Perception Entropy' in {names}")
    stage.do("bpy.ops.preferences.addon_disable(module='bl_ext.user_default.perception_entropy')")
    stage.wait_until(f"'Perception Entropy' not in {names}")
