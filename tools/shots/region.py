"""The free region of the LiDAR on the robotaxi's roof, on its mesh."""

from __future__ import annotations

from .guide import LOOK
from .reel import Camera, Reel

ADDON = "bl_ext.user_default.perception_entropy"
JOB = f"__import__('{ADDON}.operators.running_job', fromlist=['current']).current"
REGION = f"__import__('{ADDON}.queries.where_map', fromlist=['regions']).regions"
PATIENCE_S = 300
"""How long the fine region may take."""


def found(camera: Camera) -> None:
    """The patch on the roof, and in the sidebar how far the sensor may go: from where it was before
    the search, which took it to the end of its bounds."""
    stage = camera.stage
    stage.do("bpy.context.preferences.view.ui_scale = 1.15")
    stage.do(LOOK.format(center=(-0.35, 0.1, 1.35), distance=3.1, rotation=(0.95, 0.0, 2.35)))
    stage.do("""
        settings, objects = window.scene.perception_entropy, bpy.context.view_layer.objects
        settings.score_samples = settings.search_samples = 16384
        settings.view.region_loss = 0.1
        area.spaces.active.overlay.show_cursor = False
        area.spaces.active.overlay.show_axis_x = area.spaces.active.overlay.show_axis_y = False
        for name in ("ground", "beams", "reach", "blind", "requirements"):
            setattr(settings.view, f"show_{name}", False)
        for obj in objects:
            obj.select_set(obj.name == "roof_lidar")
        objects.active = lidar = objects["roof_lidar"]
        lidar.location, lidar.rotation_euler = (-0.43, 0.0, 1.62), (0.0, 0.0, 0.0)
    """)
    stage.do("bpy.ops.pe.score()")
    stage.rest()
    stage.do("""
        region = next(each for each in area.regions if each.type == "WINDOW")
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.pe.free_region("INVOKE_DEFAULT", name="roof_lidar")
    """)
    stage.wait_until(f"bool({REGION}) and {JOB} is None", PATIENCE_S)
    stage.rest()
    camera.still("free_region")


FREE_REGION = Reel("../examples/robotaxi_sedan/robotaxi_sedan.blend", (found,))
