"""ASAM OSI's virtual_detection_area: a SensorData message a sensor, as protobuf's JSON.

The area is nominal: the field of view up to the sensor's range, without what the vehicle hides. Its
polygons are given in the sensor's own frame; the mounting position is that of the sensor in the
vehicle's frame, whose origin is the middle of the rear axle at its height (`osi_sensordata.proto`
and `osi_common.proto`, OpenSimulationInterface/open-simulation-interface, 3.7.0).
"""

import json
import math
from typing import Any

import numpy as np

from pe_core.geometry.poses import rotate
from pe_core.sensors import kind_of

from ..exchange import Written, mounting_position, origin_of
from .request import OutputRequest, plain_names
from .solid import mounted_view
from .solids import whole_solid

STEP = math.radians(5.0)  # Angle between corners of the polygons: they are for a rough picture
DECIMALS = 4  # Of coordinates [m]


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return a message a sensor, and messages on sensors without an area. Ids count as those of an
    export to `osi` do. `InputError` where the rear axle is not known."""
    study = request.study
    names, lines = plain_names([sensor.name for sensor in study.rig])
    origin = origin_of("osi", study.reference)
    files: dict[str, bytes] = {}
    for number, sensor in enumerate(study.rig):
        view = mounted_view(sensor, None, request.reach(sensor), STEP)
        if view is None:
            lines.append(f"{sensor.name}: no field of view of a {kind_of(sensor).label} is known")
            continue
        solid = whole_solid(sensor.name, view)
        place = np.asarray(sensor.pose.position)
        own = rotate(sensor.pose.ground_from_sensor.T, solid.points - place)
        message = {
            "sensor_id": {"value": number},
            "mounting_position": mounting_position(sensor.pose, origin),
            "virtual_detection_area": {"polygon": _polygons(own, solid.faces)},
        }
        text = json.dumps(message, allow_nan=False, separators=(",", ":"))
        files[f"{names[sensor.name]}_sensor_data.json"] = text.encode()
    return files, lines


def _polygons(points: Any, faces: Any) -> list[dict[str, Any]]:
    """Return triangles as messages."""
    corners = [
        dict(zip("xyz", point, strict=True)) for point in np.round(points, DECIMALS).tolist()
    ]
    return [{"vertex": [corners[k] for k in face]} for face in faces.tolist()]
