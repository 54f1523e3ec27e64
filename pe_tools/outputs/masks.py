"""Ego masks: which pixels and beams of a sensor end on its own vehicle, and on which part of it.

A white pixel is free, a black pixel is occluded by the vehicle's body. A pixel is tested with
the ray through its centre, as in the measurement of a camera: the ray passes through the vehicle's
glass and starts just outside its skin. A LiDAR beam is occluded by any hit within its range. Pixels
outside the image circle of a lens are black, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Flags, Floats
from pe_core.base.errors import InputError
from pe_core.base.files import csv_text
from pe_core.base.table_reader import dump_json
from pe_core.geometry.poses import rotate
from pe_core.scene.rig import Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.sensors import beam_field, kind_of
from pe_core.sensors.field_of_view import FREE, count_by_part
from pe_core.sensors.lidar.field_of_view import columns_around
from pe_core.sensors.ray_fan import cast_fan

from ..exchange import Written
from ..graphics import png_bytes
from .request import OutputRequest, plain_names

SUMMARY = "masks.json"
DECIMALS = 6
"""Of shares and angles [deg]."""
OUTSIDE = -2
"""Value in place of a part: a pixel beyond the edge of a lens's field."""
MAX_RAYS = 50_000_000
"""Maximum rays of a mask: a picture of 50 megapixels takes about a minute and 2 GB."""
RAYS_AT_ONCE = 1 << 19


@dataclass(frozen=True, slots=True, eq=False)
class EgoMask:
    """Which rays of a sensor end on its own vehicle, and on which part of it.

    Attributes
    ----------
    parts : (H, W) int
        Part of the vehicle that a ray ends on, `FREE` or `OUTSIDE`. By pixel, top row first; or by
        channel, top first, and azimuth, left first.
    elevations, azimuths : (H,) and (W,) float, or None
        Of the rows and columns of a LiDAR, before the offsets of its channels [rad].
    """

    parts: NDArray[np.int32]
    elevations: Floats | None = None
    azimuths: Floats | None = None

    @property
    def sees_out(self) -> Flags:
        """(H, W) which rays are free: white in the mask."""
        return self.parts == FREE

    @property
    def outside(self) -> Flags:
        """(H, W) which pixels show nothing."""
        return self.parts == OUTSIDE

    def counts(self, part_names: Sequence[str]) -> dict[str, int]:
        """Number of rays that end on each part of the vehicle, in descending order."""
        return count_by_part(self.parts, part_names)


def require_mask_size(name: str, rays: int) -> None:
    """Raise `InputError` for a mask of more rays than `MAX_RAYS`, before rays are cast."""
    if rays > MAX_RAYS:
        raise InputError(name, "mask", f"at most {MAX_RAYS:,} pixels or beams", f"{rays:,}")


def picture_mask(sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
    """Cast a ray through the middle of every pixel, some rows at a time."""
    camera: Any = sensor.model
    require_mask_size(sensor.name, camera.width * camera.height)
    found = np.full((camera.height, camera.width), FREE, np.int32)
    rows = max(1, RAYS_AT_ONCE // camera.width)
    seen = None
    if vehicle is not None:
        seen = vehicle.seen_from(sensor.pose.position, camera.sees_through_glass)
    for first in range(0, camera.height, rows):
        down, right = np.mgrid[first : min(first + rows, camera.height), : camera.width] + 0.5
        own = camera.projection.unproject(right.ravel(), down.ravel())
        shown = np.flatnonzero(~np.isnan(own[:, 0]))
        parts = np.full(len(own), OUTSIDE, np.int32)
        parts[shown] = FREE
        if seen is not None and vehicle is not None:
            face = seen.first_hit(rotate(sensor.pose.ground_from_sensor, own[shown])).face
            parts[shown] = np.where(face >= 0, np.asarray(vehicle.parts)[face], FREE)
        found[first : first + rows] = parts.reshape(-1, camera.width)
    return EgoMask(found)


def revolution_mask(sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
    """Return which beams end on the vehicle within their maximum range, however near."""
    lidar: Any = sensor.model
    occluded = beam_field(sensor, vehicle).occluded_by
    azimuths = columns_around(lidar)
    rows, columns = (np.argsort(-angles, kind="stable") for angles in (lidar.elevations, azimuths))
    parts = occluded.reshape(len(rows), len(columns))[np.ix_(rows, columns)]
    return EgoMask(parts.astype(np.int32), lidar.elevations[rows], azimuths[columns])


def fan_mask(sensor: Sensor, vehicle: Vehicle | None, *, through_covers: bool = False) -> EgoMask:
    """Return the rays of a fan that end on the vehicle, the highest elevation first.

    What a cover lets through is free.
    """
    fan = cast_fan(sensor, vehicle, through_covers)
    elevations, azimuths = fan.angles
    flipped = fan.part[::-1, ::-1].astype(np.int32)
    return EgoMask(flipped, elevations[::-1].copy(), azimuths[::-1].copy())


MASKS: dict[str, Callable[[Sensor, Vehicle | None], EgoMask]] = {
    "camera": picture_mask,
    "lidar": revolution_mask,
    "radar": partial(fan_mask, through_covers=True),
    "ultrasonic": fan_mask,
}


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return a PNG per sensor, a table per LiDAR, the occluded shares by part, and messages."""
    rig = request.study.rig
    vehicle = request.study.vehicle
    names, lines = plain_names([sensor.name for sensor in rig])
    if vehicle is None:
        lines.append("the study has no vehicle: masks are white")
    files: dict[str, bytes] = {}
    summaries: list[dict[str, Any]] = []
    for sensor in rig:
        if sensor.kind not in MASKS:
            lines.append(f"{sensor.name}: no mask is made of a {kind_of(sensor).label}")
            continue
        mask = MASKS[sensor.kind](sensor, vehicle)
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
