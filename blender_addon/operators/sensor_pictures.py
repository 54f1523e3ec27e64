"""Pictures of what sensors see: textures for a corner of the 3D view, and an image of ranges."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, cast

import bpy
import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d
from mathutils import Matrix

from .. import engine_process, viewport
from ..engine import graphics, pe
from ..sensor_kinds import PIXELS_PER_DEG, Pixels, row_of

TITLE_PX, PAD_PX = 20.0, 6.0
TITLE_PLATE, INK = (0.08, 0.08, 0.08, 0.78), (0.92, 0.92, 0.92, 1.0)
TAKES_SRGB = bpy.app.version >= (5, 0, 0)
"""Whether textures drawn over a view are taken as they are; before 5.0 they are linear light."""
EDGE = (0.75, 0.75, 0.75, 1.0)


class PictureView(NamedTuple):
    """A 3D view on the screen."""

    window: bpy.types.Window
    space: bpy.types.SpaceView3D
    region: bpy.types.Region


class InsetCamera:
    """A picture that the viewport renders."""

    def __init__(self) -> None:
        self._offscreen: Any = None  # a gpu.types.GPUOffScreen, once it has been rendered to
        self.size = (0, 0)

    @property
    def texture(self) -> gpu.types.GPUTexture:
        """What was rendered last."""
        return self._offscreen.texture_color

    def render(
        self,
        view: PictureView,
        size: tuple[int, int],
        camera_from_ground: Matrix,
        projection: Matrix,
        around: Callable[[], None],
    ) -> None:
        """Have a viewport draw its scene from a camera; not while that viewport is drawn.

        `around` draws what is added to the scene, with the camera's matrices.
        """
        if size != self.size:
            self.free()
            self._offscreen, self.size = gpu.types.GPUOffScreen(*size), size
        self._offscreen.draw_view3d(
            view.window.scene,
            view.window.view_layer,
            view.space,
            view.region,
            camera_from_ground,
            projection,
            do_color_management=TAKES_SRGB,
            draw_background=True,
        )
        with self._offscreen.bind(), gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
            gpu.matrix.load_matrix(camera_from_ground)
            gpu.matrix.load_projection_matrix(projection)
            around()

    def free(self) -> None:
        """Let go of the memory."""
        if self._offscreen is not None:
            self._offscreen.free()
        self._offscreen, self.size = None, (0, 0)


class PixelImage:
    """A picture of pixels, uploaded when it is drawn first."""

    def __init__(self, pixels: Pixels) -> None:
        self.height, self.width = pixels.shape[:2]
        upwards = pixels[::-1]
        self._pixels = np.ascontiguousarray(
            upwards if TAKES_SRGB else graphics.linear(upwards), np.float32
        )
        self._texture: gpu.types.GPUTexture | None = None

    @property
    def texture(self) -> gpu.types.GPUTexture:
        """Its texture."""
        if self._texture is None:
            data = gpu.types.Buffer("FLOAT", self._pixels.size, self._pixels.ravel())
            size = (self.width, self.height)
            self._texture = gpu.types.GPUTexture(size, format="RGBA16F", data=data)
        return self._texture


def draw_picture(
    texture: gpu.types.GPUTexture, corner: tuple[float, float], size: tuple[int, int]
) -> None:
    """Draw a texture with its lower left corner there [px]."""
    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")
    draw_texture_2d(texture, corner, *size)


def draw_frame(
    corner: tuple[float, float], size: tuple[int, int], title: str, scale: float
) -> viewport.PlateBox:
    """Draw a frame round a picture and its title on top; return the box of all of it."""
    (left, bottom), (width, height) = corner, size
    right, top = left + width, bottom + height
    above = top + TITLE_PX * scale
    viewport.fill_box((left, top, right, above), TITLE_PLATE)
    viewport.draw_outline((left, bottom, right, top), EDGE)
    pad = PAD_PX * scale
    viewport.draw_text(title, left + pad, top + pad, viewport.SMALL * scale, INK)
    return left, bottom, right, above


RANGE_TOPIC = "ranges"
SPLIT = 0.34
"""How much of the 3D view's height the picture takes."""


def image_name(sensor: str) -> str:
    """Return the name of a sensor's image."""
    return f"{sensor} range"


def request_image(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> None:
    """Have the picture of a sensor's kind made, and put into the sensor's image."""
    image_of(sensor.name)
    pixels = row_of(sensor.kind).pixels
    assert pixels is not None  # asked for those kinds alone

    def deliver(made: Pixels) -> None:
        store_image(sensor.name, made)
        show_image(sensor.name)

    engine_process.ask(
        RANGE_TOPIC,
        pixels,
        (sensor, vehicle),
        deliver,
        lambda error: print(f"perception entropy: no picture of {sensor.name}: {error}"),
    )


def store_image(sensor: str, pixels: Pixels) -> None:
    """Put a picture into a sensor's image, and keep it in the file."""
    image = image_of(sensor)
    height, width = pixels.shape[:2]
    if tuple(image.size) != (width, height):
        image.scale(width, height)
    cast(Any, image.pixels).foreach_set(np.ascontiguousarray(pixels[::-1]).ravel())
    image.update()
    image.pack()
    viewport.redraw_editors("IMAGE_EDITOR")


def image_of(sensor: str) -> bpy.types.Image:
    """Return the image of a sensor; a new one where there is none."""
    name = image_name(sensor)
    image = bpy.data.images.get(name)
    return image or bpy.data.images.new(name, 360 * PIXELS_PER_DEG, 40 * PIXELS_PER_DEG)


def show_image(sensor: str) -> None:
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
    views = [view for view in window.screen.areas if view.type == "VIEW_3D"]
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
