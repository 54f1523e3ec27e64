"""The shuttle's four corners while they are searched: painted mounts, curve, best so far."""

from __future__ import annotations

from .guide import LOOK
from .reel import Camera, Reel

ADDON = "bl_ext.user_default.perception_entropy"
CURVE = f"__import__('{ADDON}.search_curve', fromlist=['searches']).searches"
TRIED, PATIENCE_S = 120, 240
"""Placements that the picture's curve shows, and how long they may take."""


def searched(camera: Camera) -> None:
    """The curve is under way, a better placement stands beside the start."""
    stage = camera.stage
    stage.do("bpy.context.preferences.view.ui_scale = 1.0")
    stage.do(LOOK.format(center=(0.3, 0.3, 1.2), distance=10.5, rotation=(1.08, 0.0, 2.18)))
    stage.do("""
        settings, objects = window.scene.perception_entropy, bpy.context.view_layer.objects
        settings.score_samples = settings.search_samples = 8192
        for name in ("ground", "beams", "reach", "blind"):
            setattr(settings.view, f"show_{name}", False)
        for obj in objects:
            obj.select_set(obj.name == "lidar_left")
        objects.active = objects["lidar_left"]
    """)
    stage.rest()
    stage.do("""
        region = next(each for each in area.regions if each.type == "WINDOW")
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.pe.optimize("INVOKE_DEFAULT")
    """)
    stage.wait_until(f"any(seen.tried >= {TRIED} for seen in {CURVE}.values())", PATIENCE_S)
    stage.rest()
    camera.still("four_corners")


MOUNTS = Reel("examples/four_corners/four_corners.blend", (searched,))
