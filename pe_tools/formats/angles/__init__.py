"""Channel angles of a LiDAR from a file; its content decides the layout."""

from __future__ import annotations

from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text, read_bytes

from .columns import Channel, read_columns
from .velodyne import is_yaml, read_xml, read_yaml

__all__ = ["read_angles"]


def read_angles(path: str | Path) -> list[Channel]:
    """Read the channels of a LiDAR from a file; its content decides the layout, not its name.

    Layouts: plain columns (counter-clockwise offsets), Hesai's angle correction (clockwise),
    Velodyne's calibration as the ROS driver's YAML or as db.xml.

    Returns
    -------
    list of Channel
        Sorted by id if the file has ids, else in the file's order; offsets are counter-clockwise.

    Raises
    ------
    InputError
        One line: the file, the line or channel, what is expected and what was found.
    """
    path = Path(path)
    source, data = str(path), read_bytes(path)
    text = decode_text(data)
    if not text.strip():
        raise InputError(source, "file", "channel angles", "an empty file")
    if text.lstrip().startswith("<"):
        return read_xml(source, data)
    return read_yaml(source, text) if is_yaml(text) else read_columns(source, text)
