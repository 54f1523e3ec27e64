"""Mountings of radars as the drivers of tier4/nebula ask for them: position, angles, damping.

Names and signs are those of its services for Continental's radars (continental_srvs:
SetSensorMounting and SetRadarParameters, @dbada665): metres, radians, damping in dB. Its drivers
count `longitudinal` from the front axle, forward positive (wrapper of the SRR520, @4907a10a).
"""

from __future__ import annotations

import json

from pe_core import catalog
from pe_core.scene import Reference, Sensor
from pe_core.sensors import kind_of
from pe_tools.outputs import OutputRequest, SceneOutput

RADAR = "radar"
FILE = "nebula_radars.yaml"
HEAD = """\
# Radars of the rig, for the services of tier4/nebula. Metres from {origin},
# radians, damping of the cover in dB one way. Set the plug's side on the vehicle.
"""
DECIMALS = 6


def write(request: OutputRequest) -> tuple[dict[str, bytes], list[str]]:
    """Return the mountings of a study's radars, and lines on what is not in them."""
    study, lines = request.study, []
    origin, offset = _origin(study.reference)
    if study.reference is None or study.reference.wheelbase is None:
        lines.append(f"positions are from {origin}; nebula counts from the front axle")
    parts = [HEAD.format(origin=origin)]
    for sensor in study.rig:
        if sensor.kind != RADAR:
            continue
        parts.append(_mounting(sensor, offset, _damping(request, sensor)))
        if abs(sensor.pose.rotation_deg[0]) > 0.0:
            lines.append(f"{sensor.name}: nebula has no roll; left out")
    if len(parts) == 1:
        lines.append("no radar in the rig: the file names none")
    return {FILE: "\n".join(parts).encode()}, lines


def _origin(reference: Reference | None) -> tuple[str, float]:
    """Return what positions are counted from, and its x in the ground frame [m]."""
    if reference is None:
        return "the ground under the vehicle's centre", 0.0
    if reference.wheelbase is None:
        return "the rear axle, on the ground", reference.rear_axle_x
    return "the front axle, on the ground", reference.rear_axle_x + reference.wheelbase


def _damping(request: OutputRequest, sensor: Sensor) -> float:
    """Return the loss of the model's own cover and of all covers before it, one way [dB]."""
    vehicle = request.study.vehicle
    covers = {} if vehicle is None else kind_of(sensor).covers_met(sensor, vehicle)
    own = float(catalog.to_table(sensor.model).get("cover_loss_db", 0.0))
    return own + sum(db for db, _ in covers.values())


def _mounting(sensor: Sensor, offset: float, damping: float) -> str:
    x, y, z = sensor.pose.position
    _, pitch, yaw = sensor.pose.rpy
    numbers = {
        "longitudinal": x - offset,
        "lateral": y,
        "vertical": z,
        "yaw": yaw,
        "pitch": pitch,
        "cover_damping": damping,
    }
    lines = [f"{json.dumps(sensor.name)}:", f"  model: {json.dumps(sensor.model.name)}"]
    lines += [f"  {key}: {round(value, DECIMALS) + 0.0!r}" for key, value in numbers.items()]
    return "\n".join(lines) + "\n"


OUTPUT = SceneOutput("nebula", "Radar Mountings (Nebula)", FILE, write, has_range=False)
