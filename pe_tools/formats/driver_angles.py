"""Channel angles in the documents of drivers: Ouster's metadata, Velodyne's calibration.

Signs are those of the drivers. Ouster's SDK turns a beam by `-beam_azimuth` from the encoder,
counter-clockwise seen from above (ouster_client/src/xyzlut.cpp). Velodyne's ROS driver subtracts
`rot_correction` from an azimuth that is clockwise (velodyne_pointcloud/src/lib/rawdata.cc), so it
is counter-clockwise itself.
"""

import math
import re
from typing import Any

from pe_core.base.errors import InputError
from pe_core.base.table_reader import Table, parse_json
from pe_core.base.values import FINITE, Whole, numbers

from .channels import Channel, checked_channel, sorted_by_id
from .yaml_text import parse_yaml

OUSTER_PART = "beam_intrinsics"
OUSTER_UP = "beam_altitude_angles"
OUSTER_AROUND = "beam_azimuth_angles"
OUSTER_SIGN = -1.0
VELODYNE_LASERS = "lasers"
VELODYNE_ID = "laser_id"
VELODYNE_UP = "vert_correction"
VELODYNE_AROUND = "rot_correction"
VELODYNE_SIGN = 1.0
"""A sign is the factor that makes an offset counter-clockwise seen from above."""
LASERS = re.compile(rf"^{VELODYNE_LASERS} *:", re.MULTILINE)
LASER_ID = Whole(0, 999_999_999, "a channel's id")


def driver_channels(source: str, text: str) -> list[Channel] | None:
    """Return the channels of a driver's document; None for a text that is none. A document without
    angles, or with a wrong one, raises `InputError`."""
    if text.lstrip().startswith("{"):
        return _ouster(source, parse_json(source, text))
    if LASERS.search(text):
        return _velodyne(source, parse_yaml(source, text))
    return None


def _ouster(source: str, data: Any) -> list[Channel]:
    """Return the channels of Ouster's metadata, in its order: the highest first. Newer metadata
    has the angles [deg] in a part of its own."""
    table = Table(data, source)
    table = table.at(OUSTER_PART, {}) if OUSTER_PART in table else table
    up = _angles(table, OUSTER_UP)
    around = _angles(table, OUSTER_AROUND)
    if len(up) != len(around):
        raise table.error(f"{len(up)} angles, one a channel", len(around), OUSTER_AROUND)
    return [
        checked_channel(
            source,
            f"{table.field(OUSTER_UP)}[{number}]",
            None,
            elevation_deg=elevation_deg,
            offset_deg=OUSTER_SIGN * azimuth_deg,
        )
        for number, (elevation_deg, azimuth_deg) in enumerate(zip(up, around, strict=True))
    ]


def _angles(table: Table, key: str) -> list[float]:
    """Return a list of finite angles [deg] that is not empty."""
    angles = numbers(table.raw(key))
    if angles is None or angles.ndim != 1 or not len(angles):
        raise table.error("a list of angles, one a channel", "none", key)
    return [FINITE.checked(table.source, table.field(key), angle) for angle in angles.tolist()]


def _velodyne(source: str, data: Any) -> list[Channel]:
    """Return the channels of a calibration file of Velodyne's ROS driver, by id."""
    channels = []
    for laser in Table(data, source).at(VELODYNE_LASERS, []).items:
        number = laser.whole(VELODYNE_ID, rule=LASER_ID)
        elevation = math.degrees(laser.number(VELODYNE_UP, rule=FINITE))
        offset = VELODYNE_SIGN * math.degrees(laser.number(VELODYNE_AROUND, rule=FINITE))
        channels.append(
            checked_channel(source, laser.path, number, elevation_deg=elevation, offset_deg=offset)
        )
    if not channels:
        raise InputError(source, VELODYNE_LASERS, "at least one laser", "none")
    return sorted_by_id(source, channels, 0)
