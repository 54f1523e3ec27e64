"""A LiDAR's ranges as an image of Blender's: worked out beside the window, shown in an editor."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import redraw
from ..engine import graphics, kinds, pe
from ..worker import desk

TOPIC = "ranges"
LEGEND = "near is bright, far is dark by metres; orange: stopped by the vehicle; grey: nothing"
PIXELS_PER_DEG = 3
"""So that a full circle fits into the editor that is made of the 3D view."""
SPLIT = 0.34
"""How much of the 3D view's height the picture takes."""


def name_of(sensor: str) -> str:
    """Return the name of a sensor's image."""
    return f"{sensor} range"


def ask(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> None:
    """Have a LiDAR's picture made, and put into its image."""
    image_of(sensor.name)
    far = sensor.model.max_range
    desk.ask(
        TOPIC,
        lambda: painted(kinds.range_picture(sensor, vehicle), far),
        lambda pixels: (put(sensor.name, pixels), show(sensor.name)),
        lambda error: print(f"perception entropy: no picture of {sensor.name}: {error}"),
    )


def painted(picture: kinds.RangePicture, far_m: float) -> NDArray[np.float32]:
    """(H, W, 4) sRGB, the top row first: a degree is as wide as it is high."""
    angles = picture.elevations, picture.azimuths
    rows, columns = (graphics.even_angles(each, PIXELS_PER_DEG) for each in angles)
    colors = graphics.range_colors(picture, far_m)[np.ix_(rows, columns)]
    return np.concatenate([colors, np.ones((*colors.shape[:2], 1))], axis=2).astype(np.float32)


def put(sensor: str, pixels: NDArray[np.float32]) -> None:
    """Put a picture into a sensor's image, and keep it in the file."""
    image = image_of(sensor)
    height, width = pixels.shape[:2]
    if tuple(image.size) != (width, height):
        image.scale(width, height)
    image.pixels.foreach_set(np.ascontiguousarray(pixels[::-1]).ravel())
    image.update()
    image.pack()
    redraw.editors("IMAGE_EDITOR")


def image_of(sensor: str) -> bpy.types.Image:
    """Return the image of a sensor's ranges, made unless there is one."""
    name = name_of(sensor)
    found = bpy.data.images.get(name)
    return found or bpy.data.images.new(name, 360 * PIXELS_PER_DEG, 40 * PIXELS_PER_DEG)


def show(sensor: str) -> None:
    """Show the image in an image editor: one that is there, a part of the 3D view, or a window.

    Not while an operator runs: its button belongs to the areas that change.
    """
    if bpy.app.background:
        return
    windows = bpy.context.window_manager.windows
    areas = [area for window in windows for area in window.screen.areas]
    editors = [area for area in areas if area.type == "IMAGE_EDITOR"]
    area = editors[0] if editors else _new_area(windows[0])
    if area is not None:
        area.type = "IMAGE_EDITOR"
        area.spaces.active.image = image_of(sensor)


def _new_area(window: bpy.types.Window) -> bpy.types.Area | None:
    """Return the lower part of the 3D view, or, where that fills the window, another window."""
    views = [each for each in window.screen.areas if each.type == "VIEW_3D"]
    if not views:
        return None
    before = set(window.screen.areas)
    largest = max(views, key=lambda area: area.width * area.height)
    with bpy.context.temp_override(window=window, area=largest):
        if bpy.ops.screen.area_split.poll():
            bpy.ops.screen.area_split(direction="HORIZONTAL", factor=SPLIT)
            return next(iter(set(window.screen.areas) - before), None)
        if bpy.ops.wm.window_new() == {"FINISHED"}:
            return bpy.context.window_manager.windows[-1].screen.areas[0]
    return None
