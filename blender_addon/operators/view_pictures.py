"""Pictures over the 3D view: the strip of cameras and the bird's-eye view are drawn from here."""

import bpy

from .. import viewport
from . import birds_eye, camera_pictures, camera_strip

_handlers = viewport.DrawHandlers()


def register() -> None:
    """Start drawing, where there is a window."""
    if not bpy.app.background:
        _handlers.show((draw, "POST_PIXEL"))


def unregister() -> None:
    """Stop drawing, and release all pictures."""
    _handlers.hide()
    for kept in (camera_pictures, camera_strip, birds_eye):
        kept.clear()
    for plate in (viewport.CAMERAS, birds_eye.PLATE_NAME):
        viewport.release_plate(plate)


def draw() -> None:
    """Draw into the current 3D view what is switched on; Blender calls this at each redraw."""
    context = bpy.context
    if not camera_pictures.is_rendering() and context.region is not None:
        camera_strip.draw(context)
        birds_eye.draw(context)
