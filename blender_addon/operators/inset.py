"""Pictures of sensors in the 3D view, while the view stays as it is: of the selected one in a
corner, of all cameras in a strip along the lower edge.

Blender's viewport renders the picture of a camera from the camera's pose. It is rendered again when
the scene has changed, not when the view is turned. The engine's process computes the picture of a
LiDAR's ranges. Blender's camera has no distortion: for a lens with distortion, the picture is the
pinhole view of *Look Through*.
"""

import math
import time
from collections.abc import Hashable
from functools import partial
from typing import Any, NamedTuple

import bpy
import numpy as np
from mathutils import Matrix

from .. import bridge, engine_process, sensor_cache, vehicle_cache, viewport
from ..engine import catalog, pe
from ..overlay import surroundings
from ..sensor_kinds import Pixels, row_of
from . import sensor_pictures
from .declared import declared
from .sensor_pictures import PictureView

PLATE_NAME, TOPIC = "inset", "inset ranges"
WIDTH_SHARE, MAX_HEIGHT_SHARE, MAX_WIDTH_PX = 0.3, 0.4, 380.0
"""Largest share of the view's width and height, and largest width at a scale of 1."""
TITLE_PX = 20.0
STRIP_PX, GAP_PX = 92.0, 6.0
"""Height of the pictures of the strip and the gaps between them, at a scale of 1."""
STILL_S = 0.25
"""How long after the last change all pictures that are out of date are rendered."""
NEAR_M, FAR_M = 0.02, 500.0


class InsetSize(NamedTuple):
    """Size of a picture [px]."""

    width: int
    height: int


class WantedPicture(NamedTuple):
    """A picture of a camera to be rendered; `made_of` is what it is made from."""

    made_of: Hashable
    pose: pe.Pose
    model: pe.Camera
    size: InsetSize


PictureKey = tuple[int, str]
"""The region's pointer, and the sensor's name in the strip; "" in the corner."""

_handlers = viewport.DrawHandlers()
_change_count = 0
"""How often a scene has changed: earlier pictures are out of date."""
_rendering = False
_rendered_count, _rest_at = 0, 0.0
"""How often it had changed when pictures were rendered last, and when all others will be."""
_pictures: dict[PictureKey, tuple[Hashable, sensor_pictures.InsetCamera]] = {}
"""Pictures of cameras, with what they were made from."""
_requested: dict[PictureKey, WantedPicture] = {}
"""Pictures that are to be rendered, in turn."""
_in_strip: dict[int, list[tuple[str, viewport.PlateBox]]] = {}
"""Sensors and their pictures in the strip, by the region's pointer."""
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
    for timer in (request_ranges, render_requested, render_rest):
        if not bpy.app.background and bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    for _, camera in _pictures.values():
        camera.free()
    _pictures.clear()
    for kept in (_requested, _in_strip):
        kept.clear()
    for plate in (PLATE_NAME, viewport.CAMERAS):
        viewport.release_plate(plate)
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
    _draw_strip(context)
    sensor = shown_sensor(context)
    if sensor is None:
        _release((region, ""))
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
    if not _has_room(context) or space.region_3d.view_perspective == "CAMERA":
        return None
    sensor = _sensor_of(obj) if obj.perception_entropy.is_sensor else None
    if sensor is None:
        return None
    row = row_of(sensor.kind)
    return None if row.camera is None and row.pixels is None else sensor


def shown_cameras(context: bpy.types.Context) -> list[tuple[pe.Sensor, pe.Camera]]:
    """Return the visible cameras, where the view is to show the strip."""
    if not context.scene.perception_entropy.view.show_cameras or not _has_room(context):
        return []
    visible = (each for each in sensor_cache.sensors(context.scene) if each.visible_get())
    possible = (sensor for each in visible if (sensor := _sensor_of(each)) is not None)
    rows = ((sensor, row_of(sensor.kind).camera) for sensor in possible)
    return [(sensor, camera_of(sensor.model)) for sensor, camera_of in rows if camera_of]


def _has_room(context: bpy.types.Context) -> bool:
    """Whether a region is a 3D view; in a quad view, the one that can be turned."""
    space = context.space_data
    is_view = space is not None and space.type == "VIEW_3D"
    return is_view and context.region_data == space.region_3d


def _sensor_of(obj: bpy.types.Object) -> pe.Sensor | None:
    """Return an object's sensor as it stands; None where it is not possible: the list says why."""
    try:
        pose = bridge.pose_of_matrix(np.array(obj.matrix_world, dtype=float))
        return pe.Sensor(obj.name, catalog.load(obj.perception_entropy.model), pose)
    except pe.InputError:
        return None


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
    size = size_of((region.width, region.height), (model.width, model.height), scale)
    camera = _picture(context, "", sensor, model, size)
    if camera is None:
        return None
    corner = _corner(context, camera.size)
    sensor_pictures.draw_picture(camera.texture, corner, camera.size)
    return sensor_pictures.draw_frame(corner, camera.size, title_of(sensor), scale)


def _draw_strip(context: bpy.types.Context) -> None:
    """Draw the pictures of all cameras in a row, and note where they are."""
    region, scale = context.region.as_pointer(), viewport.ui_scale()
    viewport.reserve_plate(region, viewport.CAMERAS, None)
    _in_strip.pop(region, None)
    cameras, drawn = shown_cameras(context), []
    names = {sensor.name for sensor, _ in cameras}
    for place in [key for key in _pictures if key[0] == region and key[1] not in {"", *names}]:
        _release(place)
    if cameras:
        margin = viewport.MARGIN * scale
        left, bottom = (
            viewport.beside_toolbar(context),
            viewport.above_hud(context, over=(viewport.STRIP,)),
        )
        width = viewport.sidebar_left(context) - margin - left
        sizes = strip_sizes(width, [(each.width, each.height) for _, each in cameras], scale)
        for (sensor, model), size in zip(cameras, sizes, strict=True):
            camera = _picture(context, sensor.name, sensor, model, size)
            if camera is not None:
                sensor_pictures.draw_picture(camera.texture, (left, bottom), size)
            box = sensor_pictures.draw_frame((left, bottom), size, sensor.name, scale)
            drawn.append((sensor.name, box))
            left += size.width + GAP_PX * scale
        boxes = [box for _, box in drawn]
        outer = boxes[0][0], bottom, boxes[-1][2], max(box[3] for box in boxes)
        viewport.reserve_plate(region, viewport.CAMERAS, outer)
        _in_strip[region] = drawn


def strip_sizes(width: float, pictures: list[tuple[int, int]], scale: float) -> list[InsetSize]:
    """Return the sizes of pictures of these proportions in a row, as high as the width allows."""
    ratios = [across / up for across, up in pictures]
    room = width - GAP_PX * scale * (len(ratios) - 1)
    height = max(min(STRIP_PX * scale, room / sum(ratios)), 2.0)
    return [InsetSize(max(int(ratio * height), 2), int(height)) for ratio in ratios]


def picture_at(region: int, x: float, y: float) -> str:
    """Return the sensor whose picture in the strip is at a place in a region [px]; "": none."""
    for name, (left, bottom, right, top) in _in_strip.get(region, ()):
        if left <= x <= right and bottom <= y <= top:
            return name
    return ""


@declared
class PE_GT_camera_strip(bpy.types.Gizmo):
    """Takes the clicks on pictures in the strip."""

    bl_idname = "PE_GT_camera_strip"

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw nothing: the pictures are there."""

    def test_select(self, context: bpy.types.Context, location: tuple[float, float]) -> int:
        """Whether the mouse is over a picture: 0, else -1."""
        return 0 if picture_at(context.region.as_pointer(), *location) else -1

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Look through the camera under the mouse."""
        place = event.mouse_region_x, event.mouse_region_y
        name = picture_at(context.region.as_pointer(), *place)
        if name and bpy.ops.pe.look_through.poll():
            bpy.ops.pe.look_through("INVOKE_DEFAULT", name=name)
        return {"FINISHED"}

    def modal(self, _context: bpy.types.Context, _event: Any, _tweak: set[str]) -> set[str]:
        """End: Blender invokes no gizmo without this."""
        return {"FINISHED"}


@declared
class PE_GGT_camera_strip(bpy.types.GizmoGroup):
    """The strip of cameras takes clicks while it is shown."""

    bl_idname, bl_label = "PE_GGT_camera_strip", "Camera Strip"
    bl_space_type, bl_region_type = "VIEW_3D", "WINDOW"
    bl_options = {"PERSISTENT"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the strip is shown."""
        return bool(context.scene.perception_entropy.view.show_cameras)

    def setup(self, _context: bpy.types.Context) -> None:
        """Make the one gizmo."""
        self.gizmos.new(PE_GT_camera_strip.bl_idname)


def _picture(
    context: bpy.types.Context, name: str, sensor: pe.Sensor, model: pe.Camera, size: InsetSize
) -> sensor_pictures.InsetCamera | None:
    """Return the latest picture of a camera; request a new one if anything has changed."""
    place, shading = (context.region.as_pointer(), name), context.space_data.shading
    look = (shading.type, shading.light, shading.color_type)
    made_of = (size, sensor.pose, model.name, _change_count, context.scene.name, look)
    cached = _pictures.get(place)
    if cached is None or cached[0] != made_of:
        _requested[place] = WantedPicture(made_of, sensor.pose, model, size)
        if not bpy.app.timers.is_registered(render_requested):
            bpy.app.timers.register(render_requested, first_interval=0.0)
    return None if cached is None else cached[1]


def render_requested(rest: bool = False) -> None:
    """Timer: render requested pictures of cameras; that is impossible while a view is drawn.

    While the scene changes, one picture of the strip is rendered a redraw, in turn.
    """
    global _rendered_count, _rest_at
    is_moving = not rest and _rendered_count != _change_count
    _rendered_count, _rest_at = _change_count, time.monotonic() + STILL_S
    in_strip = [place for place in _requested if place[1]]
    now = [each for each in _requested if not (is_moving and each in in_strip[1:])]
    for place in now:
        wanted, view = _requested.pop(place), _view_of(place[0])
        if view is not None:
            cached = _pictures.get(place)
            camera = cached[1] if cached is not None else sensor_pictures.InsetCamera()
            _render(view, camera, wanted.pose, wanted.model, wanted.size)
            _pictures[place] = wanted.made_of, camera
    if not is_moving or any(not name for _, name in now):
        viewport.redraw_editors()
    if is_moving and in_strip and not bpy.app.timers.is_registered(render_rest):
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


def _release(place: PictureKey) -> None:
    _requested.pop(place, None)
    cached = _pictures.pop(place, None)
    if cached is not None:
        cached[1].free()
