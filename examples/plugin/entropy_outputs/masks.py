"""Ego masks: which pixels and beams of a sensor end on its own vehicle, and on which part of it.

A white pixel is free, a black pixel is occluded by the vehicle's body. A pixel is tested with
the ray through its centre, as in the measurement of a camera: the ray passes through the vehicle's
glass and starts just outside its skin. A LiDAR beam is occluded by any hit within its range. Pixels
outside the image circle of a lens are black, too.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pe_core.base.files import csv_text
from pe_core.base.table_reader import dump_json
from pe_core.scene.rig import Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.sensors import EgoMask, kind_of
from pe_tools.exchange import Written
from pe_tools.graphics import png_bytes
from pe_tools.outputs import OutputRequest, SceneOutput
from pe_tools.outputs.request import plain_names

SUMMARY = "masks.json"
DECIMALS = 6
"""Of shares and angles [deg]."""


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return a PNG per sensor, a table per LiDAR, the occluded shares by part, and messages."""
    rig, vehicle = request.study.rig, request.study.vehicle
    names, lines = plain_names([sensor.name for sensor in rig])
    if vehicle is None:
        lines.append("the study has no vehicle: masks are white")
    files: dict[str, bytes] = {}
    summaries: list[dict[str, Any]] = []
    for sensor in rig:
        mask = kind_of(sensor).ego_mask(sensor, vehicle)
        if mask is None:
            lines.append(f"{sensor.name}: no mask is made of a {kind_of(sensor).label}")
            continue
        file = f"{names[sensor.name]}_mask"
        files[f"{file}.png"] = png_bytes(mask.sees_out.astype(np.uint8) * np.uint8(255))
        if mask.azimuths is not None:
            files[f"{file}.csv"] = _table(mask)
        summaries.append(_shares(sensor, mask, vehicle, f"{file}.png"))
    return {SUMMARY: dump_json({"masks": summaries}).encode(), **files}, lines


def _shares(sensor: Sensor, mask: EgoMask, vehicle: Vehicle | None, file: str) -> dict[str, Any]:
    """Return the occluded shares of a sensor as plain data."""
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
        "occluded": sum(by_part.values()),
        "occluded_share": round(sum(by_part.values()) / count, DECIMALS),
        "outside_share": round(float(mask.outside.mean()), DECIMALS),
        "by_part": {name: round(rays / count, DECIMALS) for name, rays in by_part.items()},
        "rays_by_part": by_part,
    }


def _table(mask: EgoMask) -> bytes:
    """A LiDAR's mask: elevations down, azimuths across [deg], 1 sees out, 0 is the own body."""
    assert mask.elevations is not None and mask.azimuths is not None
    up, around = (np.round(np.degrees(w), DECIMALS) + 0.0 for w in (mask.elevations, mask.azimuths))
    rows: list[list[object]] = [
        ["elevation_deg\\azimuth_deg", *(f"{a:g}" for a in around.tolist())]
    ]
    seen = mask.sees_out.astype(np.uint8).tolist()
    rows += [[f"{e:g}", *row] for e, row in zip(up.tolist(), seen, strict=True)]
    return csv_text(rows).encode()


OUTPUT = SceneOutput("masks", "Ego Masks (PNG, CSV)", "masks", write, True, has_range=False)
