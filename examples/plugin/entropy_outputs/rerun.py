"""The scene as a Rerun recording: vehicle, sensors, fields of view, beams and ground maps.

All entities are static. The world has the axes of the ground frame. A camera's image plane is a
child of its sensor, in the sensor's axes (forward, left, up).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from pe_core import Sensor
from pe_core.scene import rotate
from pe_core.sensors import kind_of
from pe_tools.exchange import (
    MAX_BEAMS,
    Written,
    portable_sensors,
    require_at_most,
    straight,
    with_pictures,
)
from pe_tools.graphics import COVERAGE, ENTROPY, Rgb, drawing_of, ground_map, sensor_colors
from pe_tools.outputs import SceneOutput
from pe_tools.outputs.glb import view_wires
from pe_tools.outputs.request import BLIND, BODY, GLASS, OutputRequest, plain_names
from pe_tools.outputs.solid import mounted_view
from pe_tools.outputs.solids import blind_volume

FILE, APPLICATION = "scene.rrd", "perception_entropy"
WORLD, VEHICLE, SENSORS, BEAMS, GROUND = "world", "vehicle", "sensors", "beams", "ground"
BLIND_VOLUME = "blind_volume"
STEP = math.radians(1.0)
REACH_M, BEAM_M = 4.0, 25.0
"""Default maximum lengths of fields of view and of beams [m]."""
MAX_RAYS = 2000
MAP_M, MAP_STEP_M = 25.0, 0.5
"""Maps of the ground reach so far from the origin, in squares of this side."""
FREE, STOPPED = (0, 115, 178, 70), (214, 94, 0, 255)
BEAM_RADIUS_M, WIRE_RADIUS_M = 0.006, 0.02
PICTURE_M = 0.6
"""How far from its sensor a camera's picture is drawn."""
MAPS = {"coverage": COVERAGE, "entropy": ENTROPY}


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return a recording, and lines on what is not in it. More beams of LiDARs than `MAX_BEAMS`
    raise `InputError`: maps of the ground measure all."""
    study = request.study
    portable, left_out = with_pictures(portable_sensors(study.rig), straight, "Rerun")
    beams = sum(each.scan.beam_count for each in portable if each.scan is not None)
    require_at_most("rerun", "sensors", beams, MAX_BEAMS, "beams, which its maps of the ground ask")
    stream = rr.RecordingStream(APPLICATION)
    none = "no vehicle: nothing is occluded or blind near it"
    lines = [] if study.vehicle is not None else [none]
    memory = stream.memory_recording()  # the library may write an incomplete file without an error
    stream.send_blueprint(_blueprint())
    stream.log("/", rr.ViewCoordinates.FLU, static=True)
    _log_vehicle(stream, request)
    names, _ = plain_names([sensor.name for sensor in study.rig])
    colors = sensor_colors(study.rig)
    for sensor, portable_sensor in zip(study.rig, portable, strict=True):
        entity = [SENSORS, names[sensor.name]]
        _log_sensor(stream, request, sensor, entity, colors[sensor.name])
        if (picture := portable_sensor.picture) is not None:
            pinhole = rr.Pinhole(
                image_from_camera=picture.matrix,
                resolution=picture.size,
                camera_xyz=rr.ViewCoordinates.FLU,
                image_plane_distance=PICTURE_M,
            )
            _log(stream, [*entity, "picture"], pinhole)
        if drawing_of(sensor.kind).beams:
            _log(stream, [BEAMS, names[sensor.name]], _beams(request, sensor))
    _log_ground(stream, request)
    recording: bytes = memory.drain_as_bytes()
    stream.disconnect()
    return {FILE: recording}, lines + left_out


def _blueprint() -> Any:
    """Return views of the scene to choose from: what would hide the rest has its own."""
    own = {
        "Coverage": f"{GROUND}/coverage",
        "Entropy": f"{GROUND}/entropy",
        "Blind volume": BLIND_VOLUME,
    }
    views = []
    for name, shown in own.items():
        hidden = [f"- /{WORLD}/{entity}" for entity in own.values() if entity != shown]
        views.append(rrb.Spatial3DView(name=name, contents=["$origin/**", *hidden]))
    return rrb.Blueprint(rrb.Tabs(*views), collapse_panels=True)


def _log(stream: Any, parts: list[str], what: Any) -> None:
    """Log at an entity path; its parts may contain blanks and non-ASCII letters."""
    stream.log([WORLD, *parts], what, static=True)


def _log_vehicle(stream: Any, request: OutputRequest) -> None:
    vehicle, rig = request.study.vehicle, request.study.rig
    if vehicle is None:
        return
    for number, name in enumerate(vehicle.part_names):
        corners = vehicle.triangles[vehicle.parts == number].reshape(-1, 3)
        if len(corners):
            points, index = np.unique(corners, axis=0, return_inverse=True)
            color = _rgba(GLASS if name in vehicle.glass else BODY)
            _log(stream, [VEHICLE, name], _mesh(points, index.reshape(-1, 3), color))
    blind = blind_volume(BLIND_VOLUME, rig, vehicle)
    if blind is not None:
        _log(stream, [blind.name], _mesh(blind.points, blind.faces, _rgba(BLIND)))


def _log_sensor(
    stream: Any, request: OutputRequest, sensor: Sensor, entity: list[str], color: Rgb
) -> None:
    """Log a sensor's pose, what it is, and its field of view in its own axes."""
    pose, rotation = sensor.pose, sensor.pose.ground_from_sensor
    placed = rr.Transform3D(translation=pose.position, mat3x3=rotation, axis_length=0.3)
    _log(stream, entity, placed)
    properties = {"name": sensor.name, "kind": sensor.kind, "model": sensor.model.name}
    _log(stream, entity, rr.AnyValues(**properties))
    view = mounted_view(sensor, request.study.vehicle, request.reach(sensor, REACH_M), STEP)
    if view is not None:
        lines = [rotate(rotation.T, line - view.origin) for line in view_wires(view)]
        strips = rr.LineStrips3D(lines, colors=_rgba(color), radii=WIRE_RADIUS_M)
        _log(stream, [*entity, "view"], strips)


def _beams(request: OutputRequest, sensor: Sensor) -> Any:
    """Return an even sample of a sensor's beams, up to the vehicle, the ground or the range."""
    directions = kind_of(sensor).rays(sensor, MAX_RAYS)
    origin, max_distance = np.asarray(sensor.pose.position), request.reach(sensor, BEAM_M)
    reach = np.full(len(directions), max_distance)
    falling = (directions[:, 2] < 0.0) & (origin[2] > 0.0)
    reach[falling] = np.minimum(max_distance, origin[2] / -directions[falling, 2])
    distance = np.full(len(directions), np.inf)
    if request.study.vehicle is not None:
        distance = request.study.vehicle.first_hit(origin.tolist(), directions).distance
    occluded = distance < reach
    points = origin + directions * np.minimum(distance, reach)[:, None]
    strips = np.stack([np.broadcast_to(origin, points.shape), points], axis=1)
    colors = np.where(occluded[:, None], STOPPED, FREE).astype(np.uint8)
    return rr.LineStrips3D(strips, colors=colors, radii=BEAM_RADIUS_M)


def _log_ground(stream: Any, request: OutputRequest) -> None:
    """Log maps of the ground as the 3D view has them: coverage, and entropy under it."""
    visible = request.study.sight().ground(request.study.rig, step=MAP_STEP_M, within=MAP_M)
    for name, quantity in MAPS.items():
        sheet = ground_map(visible, quantity, 1.0, faded=False).sheet
        if sheet is not None:
            points, colors, faces = sheet.mesh
            rgba = np.rint(colors * 255.0).astype(np.uint8)
            mesh = rr.Mesh3D(vertex_positions=points, triangle_indices=faces, vertex_colors=rgba)
            _log(stream, [GROUND, name], mesh)


def _mesh(points: Any, faces: Any, color: list[int]) -> Any:
    """Return a mesh whose normals are the mean of those of the triangles, weighted by area."""
    corners = points[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros_like(points)
    for k in range(3):
        np.add.at(total, faces[:, k], across)
    length = np.sqrt((total**2).sum(axis=1, keepdims=True))
    return rr.Mesh3D(
        vertex_positions=points,
        triangle_indices=faces,
        vertex_normals=total / np.where(length > 0.0, length, 1.0),
        albedo_factor=color,
    )


def _rgba(color: Rgb) -> list[int]:
    """Return an opaque colour: Rerun 0.23 draws meshes so, whatever their alpha."""
    return [*(round(255 * value) for value in color), 255]


OUTPUT = SceneOutput("rerun", "Rerun Recording", FILE, write)
