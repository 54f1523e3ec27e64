"""Ego masks: which pixels and beams of a sensor end on its own vehicle, and on which part of it.

White sees out, black is the own body. A pixel is asked by the ray through its middle, as the camera
is measured: through the vehicle's glass, from a point proud of its skin. A beam is stopped as far
as the LiDAR's range, however near. Of a lens, what is outside its image circle is black, too.
"""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np

from ..exchange import Written
from ..graphics import png_bytes
from ..kinds import EgoMask, kind_of
from ..scene.sensors import Sensor
from ..scene.vehicle import Vehicle
from ..text.json_text import dump_json
from .names import plain_names
from .request import OutputRequest

SUMMARY, BY_PART = "masks.json", "stopped_by_part.csv"
DECIMALS = 6
"""Of shares and angles [deg]."""


def write(wanted: OutputRequest) -> tuple[Written, list[str]]:
    """Return a PNG of each sensor, a table of each LiDAR, and the shares by part."""
    rig, vehicle = wanted.study.rig, wanted.study.vehicle
    names, lines = plain_names([sensor.name for sensor in rig])
    if vehicle is None:
        lines.append("the study has no vehicle: masks are white")
    files: dict[str, bytes] = {}
    told: list[dict[str, Any]] = []
    for sensor in rig:
        mask = kind_of(sensor).ego_mask(sensor, vehicle)
        if mask is None:
            lines.append(f"{sensor.name}: no mask is made of a {kind_of(sensor).label}")
            continue
        file = f"{names[sensor.name]}_mask"
        files[f"{file}.png"] = png_bytes(mask.sees_out.astype(np.uint8) * np.uint8(255))
        if mask.azimuths is not None:
            files[f"{file}.csv"] = _table(mask)
        told.append(_told(sensor, mask, vehicle, f"{file}.png"))
    return {SUMMARY: dump_json({"masks": told}).encode(), BY_PART: _by_part(told), **files}, lines


def _told(sensor: Sensor, mask: EgoMask, vehicle: Vehicle | None, file: str) -> dict[str, Any]:
    """A sensor's shares as plain data."""
    count = mask.parts.size
    names = () if vehicle is None else tuple(vehicle.part_names)
    by_part = mask.counts(names)
    return {
        "sensor": sensor.name,
        "kind": sensor.kind,
        "file": file,
        "width": mask.parts.shape[1],
        "height": mask.parts.shape[0],
        "rays": count,
        "stopped": sum(by_part.values()),
        "stopped_share": round(sum(by_part.values()) / count, DECIMALS),
        "outside_share": round(float(mask.outside.mean()), DECIMALS),
        "by_part": {name: round(rays / count, DECIMALS) for name, rays in by_part.items()},
        "rays_by_part": by_part,
    }


def _by_part(told: list[dict[str, Any]]) -> bytes:
    """All sensors' shares by part as one table."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(["sensor", "part", "rays", "share"])
    for each in told:
        for part, rays in each["rays_by_part"].items():
            lines.writerow([each["sensor"], part, rays, f"{each['by_part'][part]:.6f}"])
    return text.getvalue().encode()


def _table(mask: EgoMask) -> bytes:
    """A LiDAR's mask: elevations down, azimuths across [deg], 1 sees out, 0 is the own body."""
    assert mask.elevations is not None and mask.azimuths is not None
    up, around = (np.round(np.degrees(w), DECIMALS) + 0.0 for w in (mask.elevations, mask.azimuths))
    head = ",".join(["elevation_deg\\azimuth_deg", *(f"{a:g}" for a in around.tolist())])
    rows = mask.sees_out.astype(np.uint8).astype(str)
    lines = (f"{e:g}," + ",".join(row) for e, row in zip(up.tolist(), rows, strict=True))
    return "\n".join([head, *lines, ""]).encode()
