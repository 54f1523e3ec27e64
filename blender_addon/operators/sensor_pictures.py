"""Pictures of what cameras see: textures over the 3D view."""

from collections.abc import Callable
from typing import Any, NamedTuple

import bpy
import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d
from mathutils import Matrix

from .. import document
from ..engine import catalog, pe
from ..view import viewport
from ..view.plates import PlateSize, Room

TITLE_PX = 20.0
PAD_PX = 6.0
WIDTH_SHARE = 0.3
MAX_HEIGHT_SHARE = 0.4
MAX_WIDTH_PX = 380.0
"""Largest share of the view's width and height, and largest width at a scale of 1."""
TAKES_SRGB = bpy.app.version >= (5, 0, 0)
"""Whether textures drawn over a view are taken as they are; before 5.0 they are linear light."""
EDGE = (0.75, 0.75, 0.75, 1.0)


class PictureSize(NamedTuple):
    """Size of a picture [px]."""

    width: int
    height: int


class PictureView(NamedTuple):
    """A 3D view on the screen."""

    window: bpy.types.Window
    space: bpy.types.SpaceView3D
    region: bpy.types.Region


class ViewportPicture:
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
            self._offscreen = gpu.types.GPUOffScreen(*size)
            self.size = size
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
        self._offscreen = None
        self.size = (0, 0)


def draw_picture(
    texture: gpu.types.GPUTexture, corner: tuple[float, float], size: tuple[int, int]
) -> None:
    """Draw a texture with its lower left corner there [px]."""
    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")
    draw_texture_2d(texture, corner, *size)


def draw_frame(
    corner: tuple[float, float], size: tuple[float, float], title: str, scale: float
) -> viewport.PlateBox:
    """Draw a frame round a picture and its title on top; return the box of all of it."""
    left, bottom = corner
    width, height = size
    right = left + width
    top = bottom + height
    titled = draw_title((left, top), title, scale, right)
    viewport.draw_outline((left, bottom, right, top), EDGE)
    return left, bottom, right, titled[3]


def draw_title(
    corner: tuple[float, float], title: str, scale: float, right: float
) -> viewport.PlateBox:
    """Draw a title on a plate that goes to `right` [px], as much of it as there is room for; return
    the plate's box."""
    left, bottom = corner
    pad = PAD_PX * scale
    small = viewport.SMALL * scale
    box = left, bottom, right, bottom + TITLE_PX * scale
    viewport.fill_box(box, viewport.PLATE)
    text = viewport.fitted(title, small, right - left - 2.0 * pad)
    viewport.draw_text(text, left + pad, bottom + pad, small, color=viewport.INK)
    return box


def title_size(title: str, room: Room) -> PlateSize:
    """Return the size of the plate of a title, in a room [px]."""
    scale = room.scale
    width = viewport.text_size(title, viewport.SMALL * scale)[0] + 2.0 * PAD_PX * scale
    return PlateSize(min(width, room.width), TITLE_PX * scale)


def has_room(context: bpy.types.Context) -> bool:
    """Whether a region is a 3D view; in a quad view, the one that can be turned."""
    space = context.space_data
    is_view = space is not None and space.type == "VIEW_3D"
    return is_view and context.region_data == space.region_3d


def sensor_of(obj: bpy.types.Object) -> pe.Sensor | None:
    """Return an object's sensor as it stands; None where it is not possible: the list says why."""
    try:
        pose = document.pose_of_matrix(np.array(obj.matrix_world, dtype=float))
        return pe.Sensor(obj.name, catalog.load(obj.perception_entropy.model), pose)
    except pe.InputError:
        return None


def size_in(region: viewport.DrawRegion, picture: tuple[float, float], room: Room) -> PictureSize:
    """Return the largest size of a picture of these proportions in a region [px]."""
    wide = min(region.width, room.width / WIDTH_SHARE)
    return size_of((wide, region.height), picture, room.scale)


def size_of(region: tuple[float, float], picture: tuple[float, float], scale: float) -> PictureSize:
    """Return the size of a picture of these proportions in a region [px]."""
    ratio = picture[1] / picture[0]
    width = min(WIDTH_SHARE * region[0], MAX_WIDTH_PX * scale, MAX_HEIGHT_SHARE * region[1] / ratio)
    return PictureSize(max(int(width), 2), max(int(width * ratio), 2))
