"""The film: a LiDAR drawn along the roof, and what that changes on the ground."""

from __future__ import annotations

import math

from .guide import LOOK, SETTINGS, grab, settled
from .reel import Camera, Reel

FRAMES = 48
FRAME_MS = 110
START = (-0.35, 0.0, 1.52)
WAY_M = 1.0
"""Where the LiDAR is at first, and how far it goes to and fro [m]."""
CROP = (2, 92, 1598, 872)
WIDTH = 1200


def drawn_along(camera: Camera) -> None:
    """From the middle of the roof to the front, to the back, and home."""
    stage = camera.stage
    stage.do(LOOK.format(center=(0.3, -0.3, 0.2), distance=15.0, rotation=(0.95, 0.0, 2.35)))
    stage.do(f"""
        {SETTINGS.strip()}
        settings.view.show_beams = False
        settings.view.show_ground = settings.view.show_blind = True
        settings.live.on = True
        bpy.data.objects.remove(window.scene.objects["roof_lidar"])
        bpy.ops.pe.add_sensor(model="Pandar64")
        bpy.context.object.location = {START}
        shown = area.spaces.active
        shown.show_region_ui = shown.show_region_toolbar = shown.show_gizmo = False
        shown.overlay.show_cursor = False
    """)
    settled(camera)
    x, y = stage.place_of(START)
    u, v = stage.place_of((START[0] + WAY_M, *START[1:]))
    stage.point_at(x, y)
    grab(camera)
    for number in range(FRAMES):
        share = math.sin(2.0 * math.pi * number / FRAMES)
        stage.mouse("mousemove", round(x + (u - x) * share), round(y + (v - y) * share))
        stage.rest(0.3)
        camera.frame(FRAME_MS)
    stage.key("Escape")
    camera.film("film", CROP, WIDTH)


FILM = Reel("sedan.blend", (drawn_along,))
