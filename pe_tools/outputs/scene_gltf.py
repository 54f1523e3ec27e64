"""The scene as glTF. In the whole scene the axes of a sensor's node are those of glTF: x forward, y
up, z to the right. A program with z up imports them as x forward, y left, z up. A camera is a child
of its sensor's node and looks along -z."""

import math
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.scene import Sensor, rotate

from ..exchange import Written
from ..exchange.frames import quaternion
from ..exchange.lens_pictures import centred
from ..exchange.portable import PortableSensor, with_pictures
from ..exchange.portable_kinds import portable_sensors
from ..graphics import Rgb, sensor_colors_on_paper
from .glb import LINES, GlbScene, add_vehicle, view_wires, y_up
from .request import OutputRequest
from .solid import free_solid, mounted_view

FILE = "scene.glb"
TITLE = "glTF"
ROOT = "Grp_Root"
REACH_M = 4.0  # How far fields of view go unless told
VIEW_ALPHA = 0.18
LOOKING_ALONG_X = [0.0, -math.sqrt(0.5), 0.0, math.sqrt(0.5)]
"""Quaternion (x, y, z, w) that turns -z of a glTF camera to a sensor's x."""
NEAR_M = 0.1
FAR_M = 1000.0
STEP = math.radians(1.0)  # Approximate angular size of the triangles, seen from the sensor [rad]


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return the scene in one file, and lines on what is not in it."""
    study = request.study
    scene = GlbScene()
    sensors, left_out = with_pictures(portable_sensors(study.rig), centred, TITLE)
    names = {sensor.name for sensor in study.rig}
    nodes = add_vehicle(scene, study.vehicle, study.reference, names)
    colors = sensor_colors_on_paper(study.rig)
    for sensor, portable in zip(study.rig, sensors, strict=True):
        parts = [*_camera(scene, portable), *_view(scene, request, sensor, colors[sensor.name])]
        position = y_up(np.asarray(sensor.pose.position)).tolist()
        extras = {"kind": sensor.kind, "model": sensor.model.name}
        rotation = _turn(sensor)
        node = scene.add_node(
            sensor.name, parts, translation=position, rotation=rotation, extras=extras
        )
        nodes.append(node)
    lines = [] if study.vehicle is not None else ["no vehicle: sensors alone"]
    return {FILE: scene.encoded(scene.add_node(ROOT, nodes))}, lines + left_out


def _turn(sensor: Sensor) -> list[float]:
    """Return a sensor's rotation as a quaternion (x, y, z, w) between axes of glTF."""
    w, x, y, z = quaternion(sensor.pose.ground_from_sensor)
    return [x, z, -y, w]


def _camera(scene: GlbScene, portable: PortableSensor) -> list[int]:
    """Add the node of what takes a picture, below its sensor's."""
    picture = portable.picture
    if picture is None or picture.size is None:
        return []
    wide = picture.size[0] / picture.fx
    high = picture.size[1] / picture.fy
    perspective: dict[str, Any] = {"yfov": 2.0 * math.atan(high / 2.0), "aspectRatio": wide / high}
    perspective |= {"znear": NEAR_M, "zfar": FAR_M}
    # Not the sensor's own name: trimesh merges a node and a camera with the same name.
    name = f"{portable.name} view"
    scene.cameras.append({"name": name, "type": "perspective", "perspective": perspective})
    number = len(scene.cameras) - 1
    return [scene.add_node(name, rotation=LOOKING_ALONG_X, camera=number)]


def _view(scene: GlbScene, request: OutputRequest, sensor: Sensor, color: Rgb) -> list[int]:
    """Add a sensor's visible field of view in its own axes: the sides and their edges."""
    view = mounted_view(sensor, request.study.vehicle, request.reach(sensor, REACH_M), STEP)
    if view is None:
        return []
    name = f"{sensor.name} field of view"
    solid = free_solid(name, view)
    lines = view_wires(view)
    ends = np.cumsum([len(line) for line in lines])
    steps = np.delete(np.arange(ends[-1] - 1), ends[:-1] - 1)
    material = scene.add_material(name, color, VIEW_ALPHA)
    sides = scene.add_mesh(name, _own(sensor, solid.points), solid.faces, material)
    edges = scene.add_mesh(
        f"{name}, edges",
        _own(sensor, np.vstack(lines)),
        np.stack([steps, steps + 1], axis=1),
        scene.add_material(f"{name}, edges", color),
        mode=LINES,
    )
    return [scene.add_node(name, mesh=sides), scene.add_node(f"{sensor.name} edges", mesh=edges)]


def _own(sensor: Sensor, points: Floats) -> Floats:
    """Return points of the ground frame in a sensor's own axes."""
    return rotate(sensor.pose.ground_from_sensor.T, points - np.asarray(sensor.pose.position))
