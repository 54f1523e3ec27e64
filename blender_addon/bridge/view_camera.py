"""A camera of Blender's that shows what a camera sensor sees: its child, with the right lens."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

import bpy
from mathutils import Matrix

from ..engine import catalog, pe

FILM_MM = 36.0
"""Width of the picture in the camera; only its ratio to the focal length matters."""
SHORTEST_MM = 1.0
"""Blender knows no shorter focal length: wider lenses get a wider film."""
WIDEST = math.radians(150.0)
"""A wider pinhole shows little but its own corners."""
NEAR_M, FAR_M = 0.01, 1000.0
SIZE_M = 0.1
CAMERA_FROM_SENSOR = Matrix(((0, 0, -1, 0), (-1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
"""In the sensor's frame (x ahead, y left, z up): Blender's cameras look along -z, y is up."""


def view_camera(obj: bpy.types.Object) -> bpy.types.Object | None:
    """Return the camera that shows what a sensor sees, if it has one."""
    views = (each for each in obj.children if each.perception_entropy.is_view)
    return next(views, None)


def make_view_camera(obj: bpy.types.Object, model: pe.Camera) -> bpy.types.Object:
    """Return a sensor's camera, made unless it has one, its lens as the model's."""
    view = view_camera(obj)
    if view is None:
        name = f"{obj.name} view"
        view = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        view.perception_entropy.is_view = True
        view.parent, view.matrix_local = obj, CAMERA_FROM_SENSOR
        view.data.display_size, view.hide_select = SIZE_M, True
        for collection in obj.users_collection:
            collection.objects.link(view)
    set_lens(view.data, model)
    return view


def shown_fov(model: pe.Camera) -> float:
    """Horizontal field of view [rad] of the pinhole that shows a camera's whole view.

    Blender's camera bends no lines: of a lens that does, and of one off the picture's centre, it is
    the narrowest centred pinhole round the field, WIDEST at most.
    """
    if model.lens is None:
        return float(model.hfov)
    depth, left, up = abs(model.outline().T)
    if model.outline()[:, 0].min() <= math.cos(WIDEST / 2.0):
        return WIDEST
    half = max((left / depth).max(), (up / depth).max() * model.width / model.height)
    return min(2.0 * math.atan(half), WIDEST)


def set_lens(camera: bpy.types.Camera, model: pe.Camera) -> None:
    """Give a camera a model's field of view; the principal point is the picture's centre."""
    half = math.tan(shown_fov(model) / 2.0)
    camera.type, camera.lens_unit, camera.sensor_fit = "PERSP", "MILLIMETERS", "HORIZONTAL"
    camera.sensor_width = max(FILM_MM, 2.0 * half * SHORTEST_MM)
    camera.sensor_height = camera.sensor_width * model.height / model.width
    camera.lens = camera.sensor_width / (2.0 * half)
    camera.shift_x = camera.shift_y = 0.0
    camera.clip_start, camera.clip_end = NEAR_M, FAR_M


def look_through(
    scene: bpy.types.Scene, obj: bpy.types.Object, model: pe.Camera
) -> bpy.types.Object:
    """Make a sensor's camera the scene's, and pictures its size; what was before is noted."""
    view = make_view_camera(obj, model)
    if not scene.perception_entropy.before_look:
        scene.perception_entropy.before_look = json.dumps(_settings(scene))
    render = scene.render
    render.resolution_x, render.resolution_y = model.width, model.height
    render.resolution_percentage = 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    scene.camera = view
    return view


def look_back(scene: bpy.types.Scene) -> None:
    """Bring back the scene's camera and size of pictures from before; do nothing without."""
    noted = scene.perception_entropy.before_look
    if not noted:
        return
    before = json.loads(noted)
    scene.camera = scene.objects.get(before.pop("camera") or "")
    for name, value in before.items():
        setattr(scene.render, name, value)
    scene.perception_entropy.before_look = ""


def tend_views(scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object]) -> None:
    """Have cameras fit their sensors' models, and go with the sensors that they were of."""
    for obj in sensors:
        view, model = view_camera(obj), _camera_of(obj)
        if view is not None and model is not None:
            _follow(scene, view, model)
    cameras = [each for each in scene.objects if each.type == "CAMERA"]
    for view in (each for each in cameras if each.perception_entropy.is_view):
        if view.parent is None or _camera_of(view.parent) is None:
            _remove(scene, view)


def _follow(scene: bpy.types.Scene, view: bpy.types.Object, model: pe.Camera) -> None:
    """Set a lens when the model is another one than it is of."""
    size = model.width, model.height
    if abs(view.data.angle_x - shown_fov(model)) > 1e-5:
        set_lens(view.data, model)
    looking = scene.camera == view and scene.perception_entropy.before_look
    if looking and (scene.render.resolution_x, scene.render.resolution_y) != size:
        scene.render.resolution_x, scene.render.resolution_y = size


def _remove(scene: bpy.types.Scene, view: bpy.types.Object) -> None:
    if scene.camera == view:
        look_back(scene)
    data = view.data
    bpy.data.objects.remove(view)
    if data is not None and not data.users:
        bpy.data.cameras.remove(data)


def _camera_of(obj: bpy.types.Object) -> pe.Camera | None:
    """Return the model of a camera sensor; None of anything else."""
    if not obj.perception_entropy.is_sensor:
        return None
    try:
        model = catalog.load(obj.perception_entropy.model)
    except pe.InputError:
        return None
    return model if isinstance(model, pe.Camera) else None


def _settings(scene: bpy.types.Scene) -> dict[str, object]:
    """What looking through a sensor changes, as it is."""
    names = ("resolution_x", "resolution_y", "resolution_percentage")
    names += ("pixel_aspect_x", "pixel_aspect_y")
    values = {name: getattr(scene.render, name) for name in names}
    return values | {"camera": None if scene.camera is None else scene.camera.name}
