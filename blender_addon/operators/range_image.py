"""A LiDAR's ranges as an image of Blender's: worked out beside the window, shown in an editor."""

from __future__ import annotations

import math

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import redraw
from ..engine import kinds, pe
from ..worker import desk

TOPIC = "ranges"
LEGEND = "near is bright, far is dark by metres; orange: stopped by the vehicle; grey: nothing"
PIXELS_PER_DEG = 3
"""So that a full circle fits into the editor that is made of the 3D view."""
NEAREST_M = 0.5
"""All that is nearer has the brightest colour."""
COLORS = (
    *((0.993, 0.906, 0.144), (0.565, 0.843, 0.263), (0.206, 0.719, 0.473), (0.128, 0.565, 0.551)),
    *((0.173, 0.427, 0.556), (0.247, 0.275, 0.533), (0.267, 0.005, 0.329)),
)
"""From near to far: Viridis (van der Walt and Smith, 2015), even to the eye and safe for colour
vision of any kind; sRGB."""
NOTHING = (0.16, 0.16, 0.17)
BODY_NEAR, BODY_FAR = (1.0, 0.62, 0.20), (0.72, 0.28, 0.0)
"""Vermillion, as stopped beams are drawn: nearer parts are lighter."""
BODY_FAR_M = 5.0
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
    rows = _resampled(np.degrees(picture.elevations))
    columns = _resampled(np.degrees(picture.azimuths))
    distance = picture.distance[np.ix_(rows, columns)]
    stopped = picture.stopped[np.ix_(rows, columns)]
    finite = np.where(np.isfinite(distance), np.maximum(distance, NEAREST_M), far_m)
    share = np.log(finite / NEAREST_M) / math.log(max(far_m, 2.0 * NEAREST_M) / NEAREST_M)
    colors = _between(COLORS, share)
    colors[~np.isfinite(distance)] = NOTHING
    colors[stopped] = _between((BODY_NEAR, BODY_FAR), finite[stopped] / BODY_FAR_M)
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


def _resampled(degrees: NDArray[np.float64]) -> NDArray[np.int64]:
    """(P,) for each pixel of an axis the beam that is nearest to it, of descending angles."""
    high, low = float(degrees[0]), float(degrees[-1])
    count = max(1, round((high - low) * PIXELS_PER_DEG))
    angles = high - (np.arange(count) + 0.5) * (high - low) / count
    between = (degrees[1:] + degrees[:-1]) / 2.0
    return np.searchsorted(-between, -angles)


def _between(colors: tuple[tuple[float, ...], ...], share: NDArray[np.float64]) -> NDArray:
    """(..., 3) colours at shares from 0 to 1 of a row of colours."""
    steps = np.linspace(0.0, 1.0, len(colors))
    return np.stack([np.interp(share, steps, channel) for channel in zip(*colors, strict=True)], -1)
