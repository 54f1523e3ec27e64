"""Pictures of what sensors see: textures for a corner of the 3D view."""

from collections.abc import Callable
from typing import Any, NamedTuple

import bpy
import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d
from mathutils import Matrix

from .. import viewport
from ..engine import graphics
from ..sensor_kinds import Pixels

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
        """Have a viewport draw its scene from a camera; not while that viewport is drawn. `around`
        draws what is added to the scene, with the camera's matrices."""
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
