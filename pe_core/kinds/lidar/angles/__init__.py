"""Channel angles of a LiDAR, from a file in one of the layouts in use."""

from __future__ import annotations

from pathlib import Path

from ....errors import InputError
from ....text.files import decode_text, read_bytes
from .channels import Channel
from .columns import read_columns
from .velodyne import is_yaml, read_xml, read_yaml

__all__ = ["Channel", "read_angles"]


def read_angles(path: str | Path) -> list[Channel]:
    """Read the channels of a LiDAR; the layout is told by the content, not by the name.

    Layouts: plain columns (counter-clockwise offsets), Hesai's angle correction (clockwise),
    Velodyne's calibration as the ROS driver's YAML or as db.xml.

    Returns
    -------
    list of Channel
        By id where the file has ids, else in the file's order; offsets counter-clockwise.

    Raises
    ------
    InputError
        One line with the file, the line or channel, what was expected and what was found.
    """
    path = Path(path)
    source, data = str(path), read_bytes(path)
    text = decode_text(data)
    if not text.strip():
        raise InputError(source, "file", "channel angles", "an empty file")
    if text.lstrip().startswith("<"):
        return read_xml(source, data)
    return read_yaml(source, text) if is_yaml(text) else read_columns(source, text)
