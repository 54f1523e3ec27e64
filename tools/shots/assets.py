"""A LiDAR on its way from the asset browser to the roof."""

from __future__ import annotations

import re
from pathlib import Path

from .guide import LOOK, ROOF
from .reel import Camera, Reel

CATALOGS = Path(__file__).resolve().parents[2] / "blender_addon/assets/blender_assets.cats.txt"
PUCK = 6
"""Place of the VLP-16 in Velodyne's row."""
STEP = 112
"""From one asset to the next on the screen."""
LEFT_TO_SEE = (244, 28, 1322, 874)


def dragged(camera: Camera) -> None:
    """The browser below, the sensor on the roof above."""
    stage = camera.stage
    wanted = re.search(r"^([0-9a-f-]+):LiDAR/Velodyne:", CATALOGS.read_text(), re.MULTILINE)
    assert wanted is not None
    stage.do("bpy.context.preferences.view.ui_scale = 1.0")
    stage.show_assets(wanted[1])
    stage.do(LOOK.format(center=(0.0, 0.0, 0.75), distance=5.6, rotation=(1.0, 0.0, 2.23)))
    stage.do("""
        bpy.data.objects.remove(window.scene.objects["roof_lidar"])
        list_ = next(a for a in window.screen.areas if a.ui_type == "ASSETS").regions
        list_ = next(r for r in list_ if r.type == "WINDOW")
        kept["first"] = [list_.x + 50, window.height - (list_.y + list_.height) + 60]
    """)
    stage.rest(4.0)
    x, y = stage.do("pass")["first"]
    stage.drag((x + PUCK * STEP, y), stage.place_of(ROOF))
    stage.rest(3.0)
    camera.still("guide_assets", LEFT_TO_SEE)


ASSETS = Reel("sedan.blend", (dragged,))
