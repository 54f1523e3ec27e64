"""Pictures of what cameras see, rendered by Blender's viewport from their poses.

A picture is requested while a view is drawn, and rendered by a timer, as that is impossible while a
view is drawn. It is rendered again when the scene has changed, not when the view is turned.
"""

import math
import time
from collections.abc import Collection, Hashable
from functools import partial
from typing import NamedTuple

import bpy
import gpu
from mathutils import Matrix

from .. import document
from ..engine import pe
from ..overlay import surroundings
from ..view import viewport
from . import sensor_pictures
from .sensor_pictures import PictureSize, PictureView, ViewportPicture

STILL_S = 0.25
"""How long after the last change all pictures that are out of date are rendered."""
NEAR_M = 0.02
FAR_M = 500.0


class PictureKey(NamedTuple):
    """The region's pointer, the plate that shows the picture, and whose picture it is there."""

    region: int
    plate: str
    name: str = ""


class Exposure(NamedTuple):
    """From where and how a picture is taken: the eye, camera axes from the ground frame, clip space
    from camera axes. `raised` is how far the road that is drawn around the eye is raised [m]."""

    eye: pe.Pose
    camera_from_ground: Matrix
    projection: Matrix
    raised: float = 0.0


class WantedPicture(NamedTuple):
    """A picture to be rendered; `made_of` is what it is made from."""

    made_of: Hashable
    look: Exposure
    size: PictureSize


_change_count = 0
"""How often a scene has changed: earlier pictures are out of date."""
_rendering = False
_rendered_count = 0
_rest_at = 0.0
"""How often it had changed when pictures were rendered last, and when all others will be."""
rendered: dict[PictureKey, tuple[Hashable, ViewportPicture]] = {}
"""Pictures, with what they were made from."""
requested: dict[PictureKey, WantedPicture] = {}
"""Pictures that are to be rendered, in turn."""


def is_rendering() -> bool:
    """Whether a picture is being rendered: nothing is drawn over it."""
    return _rendering


def note_change(*_: object) -> None:
    """Invalidate the pictures after an update; they are made again at the next redraw."""
    global _change_count
    _change_count += 1


def clear() -> None:
    """Cancel what is requested, and release all pictures."""
    for timer in (render_requested, render_rest):
        if not bpy.app.background and bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    requested.clear()
    for key in tuple(rendered):
        release(key)


def release(key: PictureKey) -> None:
    """Release a picture, if there is one."""
    requested.pop(key, None)
    cached = rendered.pop(key, None)
    if cached is not None:
        cached[1].free()


def keep_only(region: int, plate: str, names: Collection[str]) -> None:
    """Release the pictures of a plate in a region except those with these names."""
    for key in tuple(rendered):
        if key[:2] == (region, plate) and key.name not in names:
            release(key)


def projection(model: pe.Camera) -> Matrix:
    """Return the matrix (4, 4), clip space from camera, of the pinhole for a model's view."""
    across = NEAR_M * math.tan(document.shown_fov(model) / 2.0)
    up = across * model.height / model.width
    return frustum(-across, across, -up, up, near=NEAR_M, far=FAR_M)


def frustum(
    left: float, right: float, bottom: float, top: float, near: float, far: float
) -> Matrix:
    """Return the matrix (4, 4), clip space from camera, of a window in the near plane [m]."""
    wide = right - left
    high = top - bottom
    deep = far - near
    return Matrix(
        (
            (2.0 * near / wide, 0.0, (right + left) / wide, 0.0),
            (0.0, 2.0 * near / high, (top + bottom) / high, 0.0),
            (0.0, 0.0, -(far + near) / deep, -2.0 * far * near / deep),
            (0.0, 0.0, -1.0, 0.0),
        )
    )


def look_of(pose: pe.Pose, model: pe.Camera) -> Exposure:
    """Return the look of a camera at a pose."""
    turned = Matrix(pose.ground_from_sensor.tolist())
    ground_from_sensor = Matrix.LocRotScale(pose.position, turned, None)
    camera_from_ground = (ground_from_sensor @ document.CAMERA_FROM_SENSOR).inverted()
    return Exposure(pose, camera_from_ground, projection(model))


def picture(
    context: bpy.types.Context, plate: str, name: str, look: Exposure, size: PictureSize
) -> ViewportPicture | None:
    """Return the latest picture of a look; request a new one if anything has changed."""
    key = PictureKey(context.region.as_pointer(), plate, name)
    shading = context.space_data.shading
    shown = shading.type, shading.light, shading.color_type
    clip = tuple(map(tuple, look.projection))
    made_of = (size, look.eye, clip, _change_count, context.scene.name, shown)
    cached = rendered.get(key)
    if cached is None or cached[0] != made_of:
        requested[key] = WantedPicture(made_of, look, size)
        if not bpy.app.timers.is_registered(render_requested):
            bpy.app.timers.register(render_requested, first_interval=0.0)
    return None if cached is None else cached[1]


def render_requested(rest: bool = False) -> None:
    """Timer: render requested pictures.

    While the scene changes, of those in turn one is rendered a redraw.
    """
    global _rendered_count, _rest_at
    is_moving = not rest and _rendered_count != _change_count
    _rendered_count = _change_count
    _rest_at = time.monotonic() + STILL_S
    in_turn = list(requested)
    now = in_turn[:1] if is_moving else in_turn
    for key in now:
        wanted = requested.pop(key)
        view = _view_of(key.region)
        if view is not None:
            cached = rendered.get(key)
            camera = cached[1] if cached is not None else ViewportPicture()
            _render(view, camera, wanted)
            rendered[key] = wanted.made_of, camera
    if not is_moving:
        viewport.redraw_editors()
    if is_moving and in_turn and not bpy.app.timers.is_registered(render_rest):
        bpy.app.timers.register(render_rest, first_interval=STILL_S)


def render_rest() -> float | None:
    """Timer: render all pictures that are out of date once the scene has stopped changing."""
    left = _rest_at - time.monotonic()
    if left > 0.0:
        return left
    render_requested(rest=True)
    return None


def _view_of(pointer: int) -> PictureView | None:
    """Return the 3D view of a region, by its pointer; None where it was closed."""
    for window in bpy.context.window_manager.windows:
        for area in (each for each in window.screen.areas if each.type == "VIEW_3D"):
            for region in area.regions:
                if region.as_pointer() == pointer:
                    return PictureView(window, area.spaces.active, region)
    return None


def _render(view: PictureView, camera: ViewportPicture, wanted: WantedPicture) -> None:
    """Render a picture by the viewport, without overlays."""
    global _rendering
    look = wanted.look
    overlay = view.space.overlay
    before = overlay.show_overlays
    _rendering = True
    overlay.show_overlays = False
    try:
        around = partial(_draw_around, look, wanted.size)
        camera.render(view, wanted.size, look.camera_from_ground, look.projection, around)
    finally:
        overlay.show_overlays = before
        _rendering = False


def _draw_around(look: Exposure, size: PictureSize) -> None:
    gpu.matrix.translate((0.0, 0.0, look.raised))
    surroundings.draw_around(look.eye, size, not sensor_pictures.TAKES_SRGB)
