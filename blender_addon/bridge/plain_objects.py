"""Convert Blender's cameras and empties to sensors, and sensors to cameras and empties.

A sensor's name and model are custom properties of the object. The image size is a custom property
of the camera, because a scene has one image size and a rig may have several.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import cast

import bpy
import numpy as np
from bpy.types import Object, Scene
from mathutils import Matrix

from ..engine import catalog, exchange, pe
from .rig import pose_of_matrix
from .view_camera import CAMERA_FROM_SENSOR, FAR_M, FILM_MM, SHORTEST_MM

NAME, MODEL, SIZE, ASPECT = "sensor", "model", "image_size", "pixel_aspect"
COLLECTION = "Rig"
CLIPS = (0.1, 1000.0)
"""Where Blender's cameras begin and end to see unless told: no ranges of a sensor."""
LEFT_OUT = "{0}: Blender's camera has no distortion ({1}); its axis is right"
HOLDS = frozenset({exchange.MODEL, exchange.MIN_RANGE, exchange.MAX_RANGE})
"""What the objects hold besides poses and pictures."""
ALIKE_PX = 0.01
DIGITS_PX, DIGITS_M = 4, 6
"""What single precision leaves of a focal length and a range."""


def plain_objects(objects: Iterable[Object]) -> list[Object]:
    """Return the cameras and empties that are neither sensors nor view cameras."""
    kinds = {"CAMERA", "EMPTY"}
    candidates = (obj for obj in objects if obj.type in kinds and not _is_ours(obj))
    return [obj for obj in candidates if obj.instance_collection is None]


def _is_ours(obj: Object) -> bool:
    settings = obj.perception_entropy
    return settings.is_sensor or settings.is_view


def sensors_of_objects(
    scene: Scene, objects: Iterable[Object], models: Mapping[str, str], stand_in: str
) -> tuple[list[pe.Sensor], list[str]]:
    """Return cameras and empties as sensors, and a message for each one with a substitute model.

    `models` are the chosen models by sensor name; an empty without a model gets `stand_in`.

    `InputError` when there is none, or a camera has no perspective or no possible lens.
    """
    sensors, lines = [], []
    for obj in plain_objects(objects):
        name = str(obj.get(NAME, obj.name))
        model_name = models.get(name) or _model_of(obj)
        if obj.type == "EMPTY" and model_name is None:
            lines.append(f"{name}: no model on the empty; {stand_in} stands in: choose its model")
        model = _camera(scene, obj, name, model_name) if obj.type == "CAMERA" else None
        sensors.append(pe.Sensor(name, model or catalog.load(model_name or stand_in), _pose(obj)))
    if not sensors:
        raise pe.InputError("scene", "objects", "cameras or empties", "none")
    return sensors, lines


def _model_of(obj: Object) -> str | None:
    """Return the model name in an object's custom property, if the catalogue has that model."""
    name = str(obj.get(MODEL, ""))
    return name if name in catalog.entries() else None


def _pose(obj: Object) -> pe.Pose:
    matrix = np.array(obj.matrix_world, dtype=float)
    matrix[:3, :3] /= np.sqrt((matrix[:3, :3] ** 2).sum(axis=0))
    if obj.type == "CAMERA":
        matrix = matrix @ np.linalg.inv(np.array(CAMERA_FROM_SENSOR))
    return pose_of_matrix(matrix)


def _camera(scene: Scene, obj: Object, name: str, model_name: str | None) -> pe.Camera:
    """Return a camera's model: the chosen one if the lens matches it, else a model of the lens."""
    camera = obj.data
    if camera.type != "PERSP":
        raise pe.InputError("scene", f"camera {name!r}", "a perspective lens", camera.type)
    table = _table(scene, camera)
    if model_name is not None:
        model = catalog.load(model_name)
        picture = exchange.picture_of(model)
        if picture is None or _is_of(picture, table):
            return cast(pe.Camera, model)
    return cast(pe.Camera, catalog.from_table(name, table))


def _table(scene: Scene, camera: bpy.types.Camera) -> dict[str, object]:
    """Return a camera's figures with the keys of a study.

    Blender measures the sensor along the image's longer side, unless the sensor fit names a side.
    """
    width, height, aspect = _picture(scene, camera)
    fit = camera.sensor_fit
    across = fit == "HORIZONTAL" or (fit == "AUTO" and width >= height * aspect)
    film = camera.sensor_height if fit == "VERTICAL" else camera.sensor_width
    length = width if across else height * aspect
    fx = camera.lens * length / film
    cx = width / 2.0 - camera.shift_x * length
    cy = height / 2.0 + camera.shift_y * length / aspect
    values = {"fx": fx, "fy": fx / aspect, "cx": cx, "cy": cy}
    table: dict[str, object] = {"kind": "camera", "width": width, "height": height}
    table |= {key: round(value, DIGITS_PX) for key, value in values.items()}
    clips = [round(clip, DIGITS_M) for clip in (camera.clip_start, camera.clip_end)]
    keys = zip(("min_range_m", "max_range_m"), clips, CLIPS, strict=True)
    return table | {key: clip for key, clip, usual in keys if clip != usual}


def _picture(scene: Scene, camera: bpy.types.Camera) -> tuple[int, int, float]:
    """Return width, height [px] and pixel aspect (height / width) of the camera or the scene."""
    render = scene.render
    share = render.resolution_percentage / 100.0
    size = camera.get(SIZE) or [int(render.resolution_x * share), int(render.resolution_y * share)]
    aspect = render.pixel_aspect_y / render.pixel_aspect_x
    return (
        int(size[0]),
        int(size[1]),
        float(camera.get(ASPECT, 1.0 if camera.get(SIZE) else aspect)),
    )


def _is_of(picture: exchange.Picture, table: Mapping[str, object]) -> bool:
    """Whether a camera's image has the given figures, with the principal point on the axis."""
    figures = (*(picture.size or ()), picture.fx, picture.fy, *picture.center)
    keys = ("width", "height", "fx", "fy", "cx", "cy")
    return all(
        abs(float(table[k]) - v) < ALIKE_PX  # type: ignore[arg-type]
        for k, v in zip(keys, figures, strict=True)
    )


def put_objects(scene: Scene, rig: pe.Rig) -> tuple[list[Object], list[str]]:
    """Add a rig to a scene as cameras and empties in a new collection; return them and messages.

    The messages name properties that Blender's cameras and empties cannot represent.
    """
    collection = bpy.data.collections.new(COLLECTION)
    scene.collection.children.link(collection)
    made, lines = [], []
    for sensor in rig:
        picture = exchange.picture_of(sensor.model)
        data = None if picture is None else _camera_data(sensor, picture)
        obj = bpy.data.objects.new(sensor.name, data)
        obj[NAME], obj[MODEL] = sensor.name, sensor.model.name
        obj.matrix_world = _matrix(sensor.pose, data is not None)
        if picture is None:
            obj.empty_display_type = "ARROWS"
        elif not picture.lens.is_straight:
            lines.append(LEFT_OUT.format(sensor.name, picture.lens.model))
        collection.objects.link(obj)
        made.append(obj)
    return made, lines + exchange.lost_line(rig, "Blender's objects", HOLDS)


def _matrix(pose: pe.Pose, is_camera: bool) -> Matrix:
    ground_from_sensor = np.eye(4)
    ground_from_sensor[:3, :3], ground_from_sensor[:3, 3] = pose.ground_from_sensor, pose.position
    if is_camera:
        ground_from_sensor = ground_from_sensor @ np.array(CAMERA_FROM_SENSOR)
    return Matrix(ground_from_sensor.tolist())


def _camera_data(sensor: pe.Sensor, picture: exchange.Picture) -> bpy.types.Camera:
    """Return a camera with a picture's lens, size and range."""
    camera = bpy.data.cameras.new(sensor.name)
    model = cast(pe.Camera, sensor.model)
    width, height = model.width, model.height
    aspect = picture.fx / picture.fy
    camera.lens_unit, camera.sensor_fit = "MILLIMETERS", "HORIZONTAL"
    camera.sensor_width = max(FILM_MM, SHORTEST_MM * width / picture.fx)
    camera.sensor_height = camera.sensor_width * height * aspect / width
    camera.lens = picture.fx * camera.sensor_width / width
    cx, cy = picture.center
    camera.shift_x = (width / 2.0 - cx) / width
    camera.shift_y = (cy - height / 2.0) * aspect / width
    min_range, max_range = model.min_range, model.max_range
    camera.clip_start = min_range or CLIPS[0]
    camera.clip_end = max_range if math.isfinite(max_range) else FAR_M
    camera[SIZE], camera[ASPECT] = (width, height), aspect
    return camera
