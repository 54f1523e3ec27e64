"""A LiDAR dragged from the asset browser onto the roof, with a real mouse."""

import math
import re
from pathlib import Path

import pytest

import pe_core as pe

CATALOGS = Path(__file__).resolve().parents[2] / "blender_addon/assets/blender_assets.cats.txt"
ROOF = (-0.4, 0.0, 1.45)
EFFECT_TIMEOUT_S = 90
SENSORS = """
kept["sensors"] = {
    each.name: {
        "model": each.perception_entropy.model,
        "place": list(each.matrix_world.translation),
        "up": each.matrix_world.col[2][2],
        "ahead": list(each.matrix_world.col[0].to_3d()),
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
LOOK_FROM_BEHIND = """
from mathutils import Euler
look = area.spaces.active.region_3d
look.view_location, look.view_distance = (-2.0, 0.0, 0.8), 6.0
look.view_rotation = Euler((1.3, 0.0, -1.5)).to_quaternion()
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


def tail_of_the_car(stage):
    """Return the point of the car's steep tail that a ray from behind meets."""
    kept = stage.do("""
        from mathutils import Vector
        depsgraph = bpy.context.evaluated_depsgraph_get()
        start, ahead = Vector((-9.0, 0.1, 0.8)), Vector((1.0, 0.0, 0.0))
        hit, point, normal, *_ = window.scene.ray_cast(depsgraph, start, ahead)
        kept["tail"], kept["normal"] = list(point), list(normal)
    """)
    assert kept["normal"][0] < -0.8, "no steep place"
    return tuple(kept["tail"])


def dropped_on(stage, place, before):
    """Drag the first asset onto a place; return the new sensor, and all of them."""

    def dropped():
        """Blender does not say when it has read the assets; before, a drag does nothing."""
        stage.drag(first_asset(stage), stage.place_of(place))
        stage.settle()
        return len(stage.do(SENSORS)["sensors"]) > len(before)

    stage.wait_for(dropped, EFFECT_TIMEOUT_S, "a new sensor")
    after = stage.do(SENSORS)["sensors"]
    (new,) = [after[name] for name in after.keys() - before.keys()]
    return new, after


@pytest.mark.thorough
def test_an_asset_dropped_on_the_roof_is_a_sensor_that_stands_there(stage, screenshots):
    before = stage.do(SENSORS)["sensors"]
    stage.show_assets(catalog_id("LiDAR/Velodyne"))
    stage.do(LOOK_FROM_ABOVE)
    stage.settle()
    new, after = dropped_on(stage, ROOF, before)
    stage.photograph(screenshots / "window_assets.png")
    assert new["model"].startswith("Velodyne ")
    assert new["body"] == new["model"]
    x, y, z = new["place"]
    assert abs(x - ROOF[0]) < 0.3 and abs(y - ROOF[1]) < 0.3
    assert 1.4 < z < 1.65, "it does not stand on the roof"
    assert new["up"] > 0.9
    assert {name: after[name] for name in before} == before

    stage.do(LOOK_FROM_BEHIND)
    stage.do(f"""
        below = next(a for a in window.screen.areas if a.ui_type == "ASSETS")
        below.spaces.active.params.catalog_id = {catalog_id("Camera/Paper")!r}
    """)
    stage.settle()
    surface = tail_of_the_car(stage)
    camera, everything = dropped_on(stage, surface, after)
    stage.photograph(screenshots / "window_asset_camera.png")
    assert pe.catalog.load(camera["model"]).kind == "camera"
    assert camera["up"] == pytest.approx(1.0, abs=1e-6), "the camera lies on its side"
    assert camera["ahead"][0] < -0.9 and camera["ahead"][2] == pytest.approx(0.0, abs=1e-6)
    assert math.dist(camera["place"], surface) < 0.25
    assert camera["place"][0] < surface[0], "it does not stand clear of the tail"

    name = next(iter(everything.keys() - after.keys()))
    stage.point_at(*stage.place_of((-2.0, 2.5, 0.2)))
    stage.mouse("key", "ctrl+z")
    stage.wait_until(f"{name!r} not in window.scene.objects")
    stage.mouse("key", "ctrl+shift+z")
    stage.wait_until(f"{name!r} in window.scene.objects")
    stage.settle()
    again = stage.do(SENSORS)["sensors"][name]
    assert again == camera, "redo brings it back as it was dropped"
    assert "Traceback" not in stage.log.read_text()
