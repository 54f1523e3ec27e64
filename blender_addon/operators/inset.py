"""The picture of the selected sensor in a corner of the 3D view, while the view stays as it is.

A camera's is drawn by Blender's own viewport, from where the camera is; it is made again when the
scene has changed, not when the view is turned. A LiDAR's is that of its ranges, worked out beside
the window. Blender's camera bends no lines: of a lens that does, the picture is the pinhole that
*Look Through* shows.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import NamedTuple

import bpy
import numpy as np
from bpy.app.handlers import persistent
from mathutils import Matrix

from .. import body, bridge, corners, redraw
from ..engine import catalog, kinds, pe
from ..worker import desk
from . import inset_drawing, range_image
from .inset_drawing import PictureView

VIEWS = bpy.types.SpaceView3D
PLATE, TOPIC = "inset", "inset ranges"
SHARE, HIGHEST_SHARE, WIDEST_PX = 0.3, 0.4, 380.0
"""The picture's part of the view's width and height at most, and its width at a scale of 1."""
MARGIN_PX, TITLE_PX = 14.0, 20.0
NEAR_M, FAR_M = 0.02, 500.0


class InsetSize(NamedTuple):
    """Size of a picture [px]."""

    width: int
    height: int


_handles: list[object] = []
_changed = 0
"""How often a scene has changed: pictures of before are not those of now."""
_rendering = False
_known: dict[int, tuple[Hashable, inset_drawing.InsetCamera]] = {}
"""Pictures of cameras by the region's pointer, with what they were made of."""
_wanted: dict[int, tuple[Hashable, pe.Sensor, InsetSize]] = {}
"""Pictures that are to be rendered, by the region's pointer."""
_ranges: tuple[Hashable, inset_drawing.Image] | None = None
_asked: Hashable = None


def register() -> None:
    """Start drawing, where there is a window."""
    if not _handles and not bpy.app.background:
        _handles.append(VIEWS.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL"))
        bpy.app.handlers.depsgraph_update_post.append(note_change)


def unregister() -> None:
    """Stop drawing, and let go of all pictures."""
    global _ranges, _asked
    while _handles:
        VIEWS.draw_handler_remove(_handles.pop(), "WINDOW")
        bpy.app.handlers.depsgraph_update_post.remove(note_change)
    for timer in (ask_ranges, render_wanted):
        if not bpy.app.background and bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    for _, camera in _known.values():
        camera.free()
    _known.clear()
    _wanted.clear()
    corners.forget(PLATE)
    _ranges = _asked = None


@persistent
def note_change(*_: object) -> None:
    """After an update: pictures are made again when they are drawn next."""
    global _changed
    _changed += 1


def draw() -> None:
    """Draw into the current 3D view, if it is wanted; Blender calls this at each redraw."""
    context = bpy.context
    if _rendering or context.region is None:
        return
    region, box = context.region.as_pointer(), None
    sensor = shown_sensor(context)
    if sensor is None:
        _drop(region)
    elif isinstance(sensor.model, pe.Camera):
        box = _draw_camera(context, sensor)
    else:
        box = _draw_ranges(context, sensor)
    corners.reserve(region, PLATE, box)


def shown_sensor(context: bpy.types.Context) -> pe.Sensor | None:
    """Return the active sensor, where the view is to show its picture, and where it is."""
    obj, space = context.active_object, context.space_data
    if not context.scene.perception_entropy.view.show_inset or obj is None:
        return None
    if space is None or space.type != "VIEW_3D" or context.region_data != space.region_3d:
        return None  # of four views the one that can be turned has it
    settings = obj.perception_entropy
    if not settings.is_sensor or space.region_3d.view_perspective == "CAMERA":
        return None
    try:
        pose = bridge.pose_of_matrix(np.array(obj.matrix_world, dtype=float))
        sensor = pe.Sensor(obj.name, catalog.load(settings.model), pose)
    except pe.InputError:  # it is told below its row
        return None
    return sensor if isinstance(sensor.model, pe.Camera | pe.Lidar) else None


def size_of(region: tuple[int, int], picture: tuple[int, int], scale: float) -> InsetSize:
    """Return the size of a picture of these proportions in a region [px]."""
    ratio = picture[1] / picture[0]
    width = min(SHARE * region[0], WIDEST_PX * scale, HIGHEST_SHARE * region[1] / ratio)
    return InsetSize(max(int(width), 2), max(int(width * ratio), 2))


def projection(model: pe.Camera) -> Matrix:
    """(4, 4) clip space from the camera's frame, of the pinhole that shows a model's view."""
    across = math.tan(bridge.shown_fov(model) / 2.0)
    up = across * model.height / model.width
    depth = FAR_M - NEAR_M
    return Matrix(
        (
            (1.0 / across, 0.0, 0.0, 0.0),
            (0.0, 1.0 / up, 0.0, 0.0),
            (0.0, 0.0, -(FAR_M + NEAR_M) / depth, -2.0 * FAR_M * NEAR_M / depth),
            (0.0, 0.0, -1.0, 0.0),
        )
    )


def title_of(sensor: pe.Sensor) -> str:
    """Return what is written above a picture."""
    if isinstance(sensor.model, pe.Lidar):
        return f"{sensor.name}: ranges, ahead in the middle"
    bent = sensor.model.lens is not None
    fov = math.degrees(bridge.shown_fov(sensor.model))
    return f"{sensor.name}{f' (as a pinhole, {fov:.0f}°)' if bent else ''}"


def _draw_camera(context: bpy.types.Context, sensor: pe.Sensor) -> corners.Box | None:
    """Draw the newest picture of a camera; have it rendered if anything has changed."""
    scale, region = context.preferences.system.ui_scale, context.region
    model, pointer = sensor.model, region.as_pointer()
    size = size_of((region.width, region.height), (model.width, model.height), scale)
    shading = context.space_data.shading
    look = (shading.type, shading.light, shading.color_type)
    made_of = (size, sensor.pose, model.name, _changed, context.scene.name, look)
    known = _known.get(pointer)
    if known is None or known[0] != made_of:
        _wanted[pointer] = made_of, sensor, size
        if not bpy.app.timers.is_registered(render_wanted):
            bpy.app.timers.register(render_wanted, first_interval=0.0)
    if known is None:
        return None
    left, bottom = _corner(context, known[1].size)
    inset_drawing.draw_picture(known[1].texture, (left, bottom), known[1].size)
    return inset_drawing.draw_frame((left, bottom), known[1].size, title_of(sensor), scale)


def render_wanted() -> None:
    """Timer: have pictures of cameras rendered, which cannot be while a view is drawn."""
    for pointer, (made_of, sensor, size) in list(_wanted.items()):
        del _wanted[pointer]
        found = _view_of(pointer)
        if found is not None:
            known = _known.get(pointer)
            camera = known[1] if known is not None else inset_drawing.InsetCamera()
            _render(found, camera, sensor, size)
            _known[pointer] = made_of, camera
    redraw.editors()


def _view_of(pointer: int) -> PictureView | None:
    """Return where a region is, by its pointer; None where it is gone."""
    for window in bpy.context.window_manager.windows:
        for area in (each for each in window.screen.areas if each.type == "VIEW_3D"):
            for region in area.regions:
                if region.as_pointer() == pointer:
                    return PictureView(window, area.spaces.active, region)
    return None


def _render(
    view: PictureView, camera: inset_drawing.InsetCamera, sensor: pe.Sensor, size: InsetSize
) -> None:
    """Have the viewport draw what a camera sees, without anything that is drawn over it."""
    global _rendering
    turned = Matrix(sensor.pose.ground_from_sensor.tolist())
    ground_from_sensor = Matrix.LocRotScale(sensor.pose.position, turned, None)
    camera_from_ground = (ground_from_sensor @ bridge.CAMERA_FROM_SENSOR).inverted()
    overlay = view.space.overlay
    before, _rendering = overlay.show_overlays, True
    overlay.show_overlays = False
    try:
        camera.render(view, size, camera_from_ground, projection(sensor.model))
    finally:
        overlay.show_overlays, _rendering = before, False


def _draw_ranges(context: bpy.types.Context, sensor: pe.Sensor) -> corners.Box | None:
    """Draw the newest picture of a LiDAR's ranges; have one made if it is not that of now."""
    global _asked
    made_of = sensor.name, sensor.pose, sensor.model.name, body.shared.version
    if made_of != _asked:
        _asked = made_of
        if not bpy.app.timers.is_registered(ask_ranges):
            bpy.app.timers.register(ask_ranges, first_interval=0.0)
    if _ranges is None or _ranges[0] != (sensor.name, sensor.model.name):
        return None
    scale, region, image = context.preferences.system.ui_scale, context.region, _ranges[1]
    size = size_of((region.width, region.height), (image.width, image.height), scale)
    left, bottom = _corner(context, size)
    inset_drawing.draw_picture(image.texture, (left, bottom), size)
    return inset_drawing.draw_frame((left, bottom), size, title_of(sensor), scale)


def ask_ranges() -> None:
    """Timer: have the picture of the active LiDAR's ranges made beside the window."""
    scene, obj = bpy.context.scene, bpy.context.view_layer.objects.active
    if obj is None or not obj.perception_entropy.is_sensor:
        return
    depsgraph = bpy.context.evaluated_depsgraph_get()
    try:
        sensor = bridge.sensor_from_object(obj, depsgraph)
    except pe.InputError:
        return
    vehicle = body.shared.read(scene, depsgraph).vehicle
    if not isinstance(sensor.model, pe.Lidar):
        return

    def deliver(pixels: inset_drawing.Pixels) -> None:
        global _ranges
        _ranges = (sensor.name, sensor.model.name), inset_drawing.Image(pixels)
        redraw.editors()

    desk.ask(
        TOPIC,
        lambda: range_image.painted(kinds.range_picture(sensor, vehicle), sensor.model.max_range),
        deliver,
        lambda _error: None,  # Look Through says why
    )


def _corner(context: bpy.types.Context, size: InsetSize) -> tuple[float, float]:
    """Lower left corner of a picture in the region: above what else is there [px]."""
    scale, region = context.preferences.system.ui_scale, context.region
    left, margin = 0.0, MARGIN_PX * scale
    for each in context.area.regions:
        if each.type == "TOOLS" and each.x < region.x + region.width / 2:
            left = max(left, each.x + each.width - region.x)
    left += margin
    pointer = region.as_pointer()
    corners.reserve(pointer, PLATE, None)
    bottom = corners.bottom_above(pointer, (left, left + size.width), margin, margin)
    return left, min(bottom, region.height - size.height - TITLE_PX * scale)


def _drop(region: int) -> None:
    known = _known.pop(region, None)
    if known is not None:
        known[1].free()
