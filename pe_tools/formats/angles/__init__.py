"""Channel angles of a LiDAR from a file; its content decides the layout."""

from __future__ import annotations

from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text, read_bytes

from .columns import Channel, read_columns

__all__ = ["read_angles"]


def read_angles(path: str | Path) -> list[Channel]:
    """Read the channels of a LiDAR from a file; its content decides the layout, not its name.

    Layouts: plain columns (counter-clockwise offsets), Hesai's angle correction (clockwise).

    Channels are sorted by id if the file has ids, else in the file's order. A file of none of these
    layouts, or with a wrong value, raises `InputError`.
    """
    path = Path(path)
    source, text = str(path), decode_text(read_bytes(path))
    if not text.strip():
        raise InputError(source, "file", "channel angles", "an empty file")
    return read_columns(source, text)
