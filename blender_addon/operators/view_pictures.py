"""Pictures over the 3D view: the strip of cameras and the bird's-eye view are drawn from here."""

import bpy

from ..view import plates
from ..view.plates import Plate, Room
from . import birds_eye, camera_pictures, camera_strip

PLATE_NAME = "pictures"


def register() -> None:
    """Start drawing, where there is a window."""
    if not bpy.app.background:
        plates.show(PLATE_NAME, plates_of)


def unregister() -> None:
    """Stop drawing, and release all pictures."""
    plates.hide(PLATE_NAME)
    for kept in (camera_pictures, camera_strip, birds_eye):
        kept.clear()


def plates_of(context: bpy.types.Context, room: Room) -> list[Plate]:
    """Return what is switched on of the pictures."""
    if camera_pictures.is_rendering() or context.region is None:
        return []
    return [*camera_strip.plates_of(context, room), *birds_eye.plates_of(context, room)]
