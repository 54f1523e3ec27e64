"""A surround view: four fisheyes, their pictures, and the ground that is stitched from them."""

from __future__ import annotations

from .guide import LOOK, OURS, SETTINGS, settled
from .reel import Camera, Reel

AHEAD = LOOK.format(center=(1.0, -1.2, 0.9), distance=14.5, rotation=(1.0, 0.0, 2.45))
PICTURES = OURS.format("operators.camera_pictures") + "._pictures"
VIEW = (60, 230, 1240, 874)


def stitched(camera: Camera) -> None:
    """The template "parking" with a road and test bodies."""
    stage = camera.stage
    stage.do(f"""
        {SETTINGS.strip()}
        bpy.ops.pe.add_rig(key="parking")
        bpy.ops.pe.surroundings()
        for name in ("beams", "frustums", "ground", "labels", "blind", "legend"):
            setattr(settings.view, "show_" + name, False)
        settings.view.show_cameras = settings.view.show_birds_eye = True
        settings.view.birds_eye_within = 6.0
        bpy.ops.object.select_all(action="DESELECT")
        window.view_layer.objects.active = None
    """)
    stage.do(AHEAD)
    settled(camera)
    stage.do("pass")
    stage.wait_until(f"len({PICTURES}) == 9", 120)
    stage.rest()
    camera.still("birds_eye", VIEW)


SURROUND = Reel("sedan.blend", (stitched,))
