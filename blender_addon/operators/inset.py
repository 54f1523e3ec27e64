"""The picture of the selected sensor in a corner of the 3D view, while the view stays as it is.

Blender's viewport renders the picture of a camera from the camera's pose. It is rendered again when
the scene has changed, not when the view is turned. The engine's process computes the picture of a
LiDAR's ranges. Blender's camera has no distortion: for a lens with distortion, the picture is the
pinhole view of *Look Through*.
"""

import math
from collections.abc import Hashable
from functools import partial
from typing import NamedTuple

import bpy
import numpy as np
from mathutils import Matrix

from .. import bridge, engine_process, vehicle_cache, viewport
from ..engine import catalog, pe
from ..overlay import surroundings
from ..sensor_kinds import Pixels, row_of
from . import sensor_pictures
from .sensor_pictures import PictureView

PLATE_NAME, TOPIC = "inset", "inset ranges"
WIDTH_SHARE, MAX_HEIGHT_SHARE, MAX_WIDTH_PX = 0.3, 0.4, 380.0
"""Largest share of the view's width and height, and largest width at a scale of 1."""
TITLE_PX = 20.0
NEAR_M, FAR_M = 0.02, 500.0


class InsetSize(NamedTuple):
    """Size of a picture [px]."""

    width: int
    height: int


_handlers = viewport.DrawHandlers()
_change_count = 0
"""How often a scene has changed: earlier pictures are out of date."""
_rendering = False
_pictures: dict[int, tuple[Hashable, sensor_pictures.InsetCamera]] = {}
"""Pictures of cameras by the region's pointer, with the key of what they were made from."""
_requested: dict[int, tuple[Hashable, pe.Pose, pe.Camera, InsetSize]] = {}
"""Pictures that are to be rendered, by the region's pointer."""
_ranges: tuple[Hashable, sensor_pictures.PixelImage] | None = None
_requested_ranges: Hashable = None


def register() -> None:
    """Start drawing, where there is a window."""
    if not bpy.app.background:
        _handlers.show((draw, "POST_PIXEL"))


def unregister() -> None:
    """Stop drawing, and release all pictures."""
    global _ranges, _requested_ranges
    _handlers.hide()
    for timer in (request_ranges, render_requested):
        if not bpy.app.background and bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    for _, camera in _pictures.values():
        camera.free()
    _pictures.clear()
    _requested.clear()
    viewport.release_plate(PLATE_NAME)
    _ranges = _requested_ranges = None


def note_change(*_: object) -> None:
    """Invalidate the pictures after an update; they are made again at the next redraw."""
    global _change_count
    _change_count += 1


def draw() -> None:
    """Draw into the current 3D view, if it is switched on; Blender calls this at each redraw."""
    context = bpy.context
    if _rendering or context.region is None:
        return
    region, box = context.region.as_pointer(), None
    sensor = shown_sensor(context)
    if sensor is None:
        _release(region)
    elif (camera_of := row_of(sensor.kind).camera) is not None:
        box = _draw_camera(context, sensor, camera_of(sensor.model))
    else:
        box = _draw_ranges(context, sensor)
    viewport.reserve_plate(region, PLATE_NAME, box)


def shown_sensor(context: bpy.types.Context) -> pe.Sensor | None:
    """Return the active sensor, where the view is to show its picture."""
    obj, space = context.active_object, context.space_data
    if not context.scene.perception_entropy.view.show_inset or obj is None:
        return None
    if space is None or space.type != "VIEW_3D" or context.region_data != space.region_3d:
        return None  # in a quad view, only the view that can be turned
    settings = obj.perception_entropy
    if not settings.is_sensor or space.region_3d.view_perspective == "CAMERA":
        return None
    try:
        pose = bridge.pose_of_matrix(np.array(obj.matrix_world, dtype=float))
        sensor = pe.Sensor(obj.name, catalog.load(settings.model), pose)
    except pe.InputError:  # the list of sensors says why
        return None
    row = row_of(sensor.kind)
    return None if row.camera is None and row.pixels is None else sensor


def size_of(region: tuple[int, int], picture: tuple[int, int], scale: float) -> InsetSize:
    """Return the size of a picture of these proportions in a region [px]."""
    ratio = picture[1] / picture[0]
    width = min(WIDTH_SHARE * region[0], MAX_WIDTH_PX * scale, MAX_HEIGHT_SHARE * region[1] / ratio)
    return InsetSize(max(int(width), 2), max(int(width * ratio), 2))


def projection(model: pe.Camera) -> Matrix:
    """Return the matrix (4, 4), clip space from camera, of the pinhole for a model's view."""
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
    """Return the title above a picture."""
    camera_of = row_of(sensor.kind).camera
    if camera_of is None:
        return f"{sensor.name}: ranges, ahead in the middle"
    camera = camera_of(sensor.model)
    bent = camera.lens is not None
    fov = math.degrees(bridge.shown_fov(camera))
    return f"{sensor.name}{f' (as a pinhole, {fov:.0f}°)' if bent else ''}"


def _draw_camera(
    context: bpy.types.Context, sensor: pe.Sensor, model: pe.Camera
) -> viewport.PlateBox | None:
    """Draw the latest picture of a camera; request a new one if anything has changed."""
    scale, region = context.preferences.system.ui_scale, context.region
    pointer = region.as_pointer()
    size = size_of((region.width, region.height), (model.width, model.height), scale)
    shading = context.space_data.shading
    look = (shading.type, shading.light, shading.color_type)
    made_of = (size, sensor.pose, model.name, _change_count, context.scene.name, look)
    cached = _pictures.get(pointer)
    if cached is None or cached[0] != made_of:
        _requested[pointer] = made_of, sensor.pose, model, size
        if not bpy.app.timers.is_registered(render_requested):
            bpy.app.timers.register(render_requested, first_interval=0.0)
    if cached is None:
        return None
    left, bottom = _corner(context, cached[1].size)
    sensor_pictures.draw_picture(cached[1].texture, (left, bottom), cached[1].size)
    return sensor_pictures.draw_frame((left, bottom), cached[1].size, title_of(sensor), scale)


def render_requested() -> None:
    """Timer: render the requested pictures of cameras; that is impossible while a view is drawn."""
    for pointer, (made_of, pose, model, size) in list(_requested.items()):
        del _requested[pointer]
        view = _view_of(pointer)
        if view is not None:
            cached = _pictures.get(pointer)
            camera = cached[1] if cached is not None else sensor_pictures.InsetCamera()
            _render(view, camera, pose, model, size)
            _pictures[pointer] = made_of, camera
    viewport.redraw_editors()


def _view_of(pointer: int) -> PictureView | None:
    """Return the 3D view of a region, by its pointer; None where it was closed."""
    for window in bpy.context.window_manager.windows:
        for area in (each for each in window.screen.areas if each.type == "VIEW_3D"):
            for region in area.regions:
                if region.as_pointer() == pointer:
                    return PictureView(window, area.spaces.active, region)
    return None


def _render(
    view: PictureView,
    camera: sensor_pictures.InsetCamera,
    pose: pe.Pose,
    model: pe.Camera,
    size: InsetSize,
) -> None:
    """Render a camera's view by the viewport, without overlays."""
    global _rendering
    turned = Matrix(pose.ground_from_sensor.tolist())
    ground_from_sensor = Matrix.LocRotScale(pose.position, turned, None)
    camera_from_ground = (ground_from_sensor @ bridge.CAMERA_FROM_SENSOR).inverted()
    overlay = view.space.overlay
    before, _rendering = overlay.show_overlays, True
    overlay.show_overlays = False
    try:
        around = partial(surroundings.draw_around, pose, size, not sensor_pictures.TAKES_SRGB)
        camera.render(view, size, camera_from_ground, projection(model), around)
    finally:
        overlay.show_overlays, _rendering = before, False


def _draw_ranges(context: bpy.types.Context, sensor: pe.Sensor) -> viewport.PlateBox | None:
    """Draw the latest picture of ranges; request a new one if anything has changed."""
    global _requested_ranges
    made_of = sensor.name, sensor.pose, sensor.model.name, vehicle_cache.shared.version
    if made_of != _requested_ranges:
        _requested_ranges = made_of
        if not bpy.app.timers.is_registered(request_ranges):
            bpy.app.timers.register(request_ranges, first_interval=0.0)
    if _ranges is None or _ranges[0] != (sensor.name, sensor.model.name):
        return None
    scale, region, image = context.preferences.system.ui_scale, context.region, _ranges[1]
    size = size_of((region.width, region.height), (image.width, image.height), scale)
    left, bottom = _corner(context, size)
    sensor_pictures.draw_picture(image.texture, (left, bottom), size)
    return sensor_pictures.draw_frame((left, bottom), size, title_of(sensor), scale)


def request_ranges() -> None:
    """Timer: request the picture of the active sensor ."""
    scene, obj = bpy.context.scene, bpy.context.view_layer.objects.active
    if obj is None or not obj.perception_entropy.is_sensor:
        return
    depsgraph = bpy.context.evaluated_depsgraph_get()
    try:
        sensor = bridge.sensor_from_object(obj, depsgraph)
    except pe.InputError:
        return
    vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
    pixels_of = row_of(sensor.kind).pixels
    if pixels_of is None:
        return

    def deliver(pixels: Pixels) -> None:
        global _ranges
        _ranges = (sensor.name, sensor.model.name), sensor_pictures.PixelImage(pixels)
        viewport.redraw_editors()

    engine_process.ask(
        TOPIC,
        pixels_of,
        (sensor, vehicle),
        deliver,
        lambda _error: None,  # Look Through says why
    )


def _corner(context: bpy.types.Context, size: tuple[int, int]) -> tuple[float, float]:
    """Return the lower left corner of a picture in the region [px]: above the other plates."""
    region, margin = context.region, viewport.MARGIN * viewport.ui_scale()
    left, pointer = viewport.beside_toolbar(context), region.as_pointer()
    viewport.reserve_plate(pointer, PLATE_NAME, None)
    bottom = viewport.free_bottom(pointer, (left, left + size[0]), margin, margin)
    return left, min(bottom, region.height - size[1] - TITLE_PX * viewport.ui_scale())


def _release(region: int) -> None:
    cached = _pictures.pop(region, None)
    if cached is not None:
        cached[1].free()
