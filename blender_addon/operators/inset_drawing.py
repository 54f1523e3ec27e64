"""Pictures on the graphics card for a corner of the 3D view, and their frame."""

from __future__ import annotations

from typing import NamedTuple

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from gpu_extras.presets import draw_texture_2d
from mathutils import Matrix
from numpy.typing import NDArray

from ..corners import PlateBox

Pixels = NDArray[np.float32]
"""(H, W, 4) sRGB, the top row first."""
FONT, TEXT_PX, TITLE_PX, PAD_PX = 0, 11.0, 20.0, 6.0
PLATE, INK = (0.08, 0.08, 0.08, 0.78), (0.92, 0.92, 0.92, 1.0)
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
        self._offscreen: gpu.types.GPUOffScreen | None = None
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
    ) -> None:
        """Have a viewport draw its scene from a camera; not while that viewport is drawn."""
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

    def free(self) -> None:
        """Let go of the memory."""
        if self._offscreen is not None:
            self._offscreen.free()
        self._offscreen, self.size = None, (0, 0)


class Image:
    """A picture of pixels, uploaded when it is drawn first."""

    def __init__(self, pixels: Pixels) -> None:
        self.height, self.width = pixels.shape[:2]
        upwards = pixels[::-1]
        self._pixels = np.ascontiguousarray(upwards if TAKES_SRGB else linear(upwards), np.float32)
        self._texture: gpu.types.GPUTexture | None = None

    @property
    def texture(self) -> gpu.types.GPUTexture:
        """Its texture."""
        if self._texture is None:
            data = gpu.types.Buffer("FLOAT", self._pixels.size, self._pixels.ravel())
            size = (self.width, self.height)
            self._texture = gpu.types.GPUTexture(size, format="RGBA16F", data=data)
        return self._texture


def linear(pixels: Pixels) -> Pixels:
    """Return sRGB as linear light; alpha stays (IEC 61966-2-1)."""
    rgb = pixels[..., :3]
    low, high = rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4
    return np.concatenate([np.where(rgb <= 0.04045, low, high), pixels[..., 3:]], axis=-1)


def draw_picture(
    texture: gpu.types.GPUTexture, corner: tuple[float, float], size: tuple[int, int]
) -> None:
    """Draw a texture with its lower left corner there [px]."""
    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")
    draw_texture_2d(texture, corner, *size)


def draw_frame(
    corner: tuple[float, float], size: tuple[int, int], title: str, scale: float
) -> PlateBox:
    """Draw a frame round a picture and its title on top; return the box of all of it."""
    (left, bottom), (width, height) = corner, size
    right, top = left + width, bottom + height
    above = top + TITLE_PX * scale
    before = gpu.state.blend_get()
    gpu.state.blend_set("ALPHA")
    _plain("TRI_FAN", ((left, top), (right, top), (right, above), (left, above)), PLATE)
    edges = ((left, bottom), (right, bottom), (right, top), (left, top), (left, bottom))
    _plain("LINE_STRIP", edges, EDGE)
    gpu.state.blend_set(before)
    blf.size(FONT, TEXT_PX * scale)
    blf.color(FONT, *INK)
    blf.position(FONT, round(left + PAD_PX * scale), round(top + PAD_PX * scale), 0.0)
    blf.draw(FONT, title)
    return left, bottom, right, above


def _plain(
    kind: str, points: tuple[tuple[float, float], ...], color: tuple[float, float, float, float]
) -> None:
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    shader.uniform_float("color", color)
    batch_for_shader(shader, kind, {"pos": [(x, y, 0.0) for x, y in points]}).draw(shader)
