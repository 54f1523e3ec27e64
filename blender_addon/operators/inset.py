"""The picture of the selected sensor in a corner of the 3D view, while the view stays as it is.

The engine's process computes the picture of a LiDAR's ranges. Blender's camera has no distortion:
for a lens with distortion, the picture is the pinhole view of *Look Through*. All drawing of
pictures over a view begins here: the strip of cameras and the bird's-eye view are drawn first.
"""

import math
from collections.abc import Hashable

import bpy

from .. import bridge, engine_process, vehicle_cache, viewport
from ..engine import pe
from ..sensor_kinds import Pixels, row_of
from . import birds_eye, camera_pictures, camera_strip, sensor_pictures
from .camera_pictures import CORNER, PictureKey
from .sensor_pictures import has_room, sensor_of

TOPIC = "inset ranges"

_handlers = viewport.DrawHandlers()
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
    if not bpy.app.background and bpy.app.timers.is_registered(request_ranges):
        bpy.app.timers.unregister(request_ranges)
    for kept in (camera_pictures, camera_strip, birds_eye):
        kept.clear()
    for plate in (CORNER, viewport.CAMERAS, birds_eye.PLATE_NAME):
        viewport.release_plate(plate)
    _ranges = _requested_ranges = None


def draw() -> None:
    """Draw into the current 3D view what is switched on; Blender calls this at each redraw."""
    context = bpy.context
    if camera_pictures.is_rendering() or context.region is None:
        return
    region, box = context.region.as_pointer(), None
    camera_strip.draw(context)
    birds_eye.draw(context)
    sensor = shown_sensor(context)
    if sensor is None:
        camera_pictures.release(PictureKey(region, CORNER))
    elif (camera_of := row_of(sensor.kind).camera) is not None:
        box = _draw_camera(context, sensor, camera_of(sensor.model))
    else:
        box = _draw_ranges(context, sensor)
    viewport.reserve_plate(region, CORNER, box)


def shown_sensor(context: bpy.types.Context) -> pe.Sensor | None:
    """Return the active sensor, where the view is to show its picture."""
    obj, space = context.active_object, context.space_data
    if not context.scene.perception_entropy.view.show_inset or obj is None:
        return None
    if not has_room(context) or space.region_3d.view_perspective == "CAMERA":
        return None
    sensor = sensor_of(obj) if obj.perception_entropy.is_sensor else None
    if sensor is None:
        return None
    row = row_of(sensor.kind)
    return None if row.camera is None and row.pixels is None else sensor


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
    size = sensor_pictures.size_in(context, (model.width, model.height))
    look = camera_pictures.look_of(sensor.pose, model)
    camera = camera_pictures.picture(context, CORNER, "", look, size)
    if camera is None:
        return None
    corner = sensor_pictures.corner(context, CORNER, camera.size)
    sensor_pictures.draw_picture(camera.texture, corner, camera.size)
    return sensor_pictures.draw_frame(corner, camera.size, title_of(sensor), viewport.ui_scale())


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
    image = _ranges[1]
    size = sensor_pictures.size_in(context, (image.width, image.height))
    corner = sensor_pictures.corner(context, CORNER, size)
    sensor_pictures.draw_picture(image.texture, corner, size)
    return sensor_pictures.draw_frame(corner, size, title_of(sensor), viewport.ui_scale())


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
