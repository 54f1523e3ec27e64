"""Channel angles of a LiDAR from a file; its content decides the layout."""

from __future__ import annotations

import re
from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text, read_bytes

from .columns import Channel, read_columns
from .velodyne import read_xml, read_yaml

__all__ = ["read_angles"]

YAML = re.compile(r"^lasers[ \t]*:", re.MULTILINE)
"""A line of the ROS driver's calibration of a Velodyne."""


def read_angles(path: str | Path) -> list[Channel]:
    """Read the channels of a LiDAR from a file; its content decides the layout, not its name.

    Layouts: plain columns (counter-clockwise offsets), Hesai's angle correction (clockwise),
    Velodyne's calibration as the ROS driver's YAML or as db.xml.

    Channels are sorted by id if the file has ids, else in the file's order. A file of none of these
    layouts, or with a wrong value, raises `InputError`.
    """
    path = Path(path)
    source, data = str(path), read_bytes(path)
    text = decode_text(data)
    if not text.strip():
        raise InputError(source, "file", "channel angles", "an empty file")
    if text.lstrip().startswith("<"):
        return read_xml(source, data)
    return read_yaml(source, text) if YAML.search(text) else read_columns(source, text)
