"""View cameras: a camera of Blender as the child of a camera sensor, with its field of view."""

import json
import math
from collections.abc import Sequence

import bpy
from bpy.types import Object, Scene
from mathutils import Matrix

from ..engine import catalog, pe

FILM_MM = 36.0
"""Width of the picture in the camera; only its ratio to the focal length matters."""
SHORTEST_MM = 1.0
"""Blender knows no shorter focal length: wider lenses get a wider film."""
WIDEST = math.radians(150.0)  # A wider pinhole shows little but its own corners
NEAR_M = 0.01
FAR_M = 1000.0
SIZE_M = 0.1
CAMERA_FROM_SENSOR = Matrix(((0, 0, -1, 0), (-1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
"""In the sensor's frame (x ahead, y left, z up): Blender's cameras look along -z, y is up."""


def view_camera(obj: Object) -> Object | None:
    """Return a sensor's view camera; None if it does not exist."""
    views = (child for child in obj.children if child.perception_entropy.is_view)
    return next(views, None)


def shown_fov(model: pe.Camera) -> float:
    """Return the horizontal field of view [rad] of the pinhole that shows a camera's whole view.
    Blender's camera has no distortion. For a lens with distortion or with a principal point off the
    centre, it is the narrowest centred pinhole that contains the field, at most WIDEST."""
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
    camera.type = "PERSP"
    camera.lens_unit = "MILLIMETERS"
    camera.sensor_fit = "HORIZONTAL"
    camera.sensor_width = max(FILM_MM, 2.0 * half * SHORTEST_MM)
    camera.sensor_height = camera.sensor_width * model.height / model.width
    camera.lens = camera.sensor_width / (2.0 * half)
    camera.shift_x = camera.shift_y = 0.0
    camera.clip_start = NEAR_M
    camera.clip_end = FAR_M


def look_through(scene: Scene, obj: Object, model: pe.Camera) -> Object:
    """Make a sensor's view camera the scene's camera; the previous settings are stored."""
    view = view_camera(obj)
    if view is None:
        name = f"{obj.name} view"
        view = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        view.perception_entropy.is_view = True
        view.parent = obj
        view.matrix_local = CAMERA_FROM_SENSOR
        view.data.display_size = SIZE_M
        view.hide_select = True
        for collection in obj.users_collection:
            collection.objects.link(view)
    set_lens(view.data, model)
    if not scene.perception_entropy.before_look:
        scene.perception_entropy.before_look = json.dumps(_settings(scene))
    render = scene.render
    render.resolution_x = model.width
    render.resolution_y = model.height
    render.resolution_percentage = 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    scene.camera = view
    return view


def look_back(scene: Scene) -> None:
    """Restore the scene's camera and picture size, if they were stored."""
    noted = scene.perception_entropy.before_look
    if not noted:
        return
    before = json.loads(noted)
    scene.camera = scene.objects.get(before.pop("camera") or "")
    for name, value in before.items():
        setattr(scene.render, name, value)
    scene.perception_entropy.before_look = ""


def update_view_cameras(scene: Scene, sensors: Sequence[Object]) -> None:
    """Update view cameras to their sensors' models; remove those whose sensor is gone."""
    for obj in sensors:
        view = view_camera(obj)
        model = _camera_of(obj)
        if view is not None and model is not None:
            size = model.width, model.height
            if abs(view.data.angle_x - shown_fov(model)) > 1e-5:
                set_lens(view.data, model)
            looking = scene.camera == view and scene.perception_entropy.before_look
            if looking and (scene.render.resolution_x, scene.render.resolution_y) != size:
                scene.render.resolution_x, scene.render.resolution_y = size
    cameras = [camera for camera in scene.objects if camera.type == "CAMERA"]
    for view in (camera for camera in cameras if camera.perception_entropy.is_view):
        if view.parent is None or _camera_of(view.parent) is None:
            if scene.camera == view:
                look_back(scene)
            data = view.data
            bpy.data.objects.remove(view)
            if data is not None and not data.users:
                bpy.data.cameras.remove(data)


def _camera_of(obj: Object) -> pe.Camera | None:
    """Return the model of a camera sensor; None for any other object."""
    if not obj.perception_entropy.is_sensor:
        return None
    try:
        model = catalog.load(obj.perception_entropy.model)
    except pe.InputError:
        return None
    return model if isinstance(model, pe.Camera) else None


def _settings(scene: Scene) -> dict[str, object]:
    """Return the scene's settings that `look_through` changes."""
    names = (
        "resolution_x",
        "resolution_y",
        "resolution_percentage",
        "pixel_aspect_x",
        "pixel_aspect_y",
    )
    values = {name: getattr(scene.render, name) for name in names}
    return values | {"camera": None if scene.camera is None else scene.camera.name}
