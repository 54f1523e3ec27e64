"""Channel angles of a LiDAR from a file: columns of a plain table or of Hesai's angle correction
file, or a document of a driver (`driver_angles`)."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.base.files import (
    MAX_QUOTE,
    decode_text,
    numbered_lines,
    parse_number,
    quoted,
    read_bytes,
)

from .channels import Channel, checked_channel, parse_id, sorted_by_id
from .csv_rows import separated
from .driver_angles import driver_channels

NAMES = {
    "elevation": {"elevation", "elevations", "elev", "vertical", "vert"},
    "azimuth": {
        "azimuth",
        "azimuth_offset",
        "azimuth_offsets",
        "horizontal",
        "horizontal_offset",
        "horiz",
    },
    "id": {"id", "laser", "laser_id", "channel", "channel_id", "ring"},
}
"""Names of columns in lower case, words joined by _, without the unit."""
UNIT = re.compile(r"(_(deg|degrees?|angles?))+$")
ANGLE_PREFIXES = ("az", "elev", "hor", "vert")
"""An unknown column whose name begins so is an error; other unknown columns are ignored."""
PREAMBLE = "eeff"
CHECKSUM = re.compile(r"[0-9a-fA-F]{64}")
"""Hesai's files may begin with ``EEFF,1,1`` and end with the SHA-256 of the rest."""
LAYOUTS = (
    "a column named elevation, Hesai's angle correction, Ouster's metadata (JSON), or Velodyne's "
    "calibration (YAML)"
)


Line = tuple[str, tuple[str, ...]]  # A line's location, for messages, and its cells


@dataclass(frozen=True, slots=True)
class Layout:
    """Indices of the columns; `azimuth_sign` makes offsets counter-clockwise."""

    width: int
    elevation: int
    azimuth: int | None = None
    number: int | None = None
    azimuth_sign: float = 1.0

    @property
    def is_hesai(self) -> bool:
        """Whether the layout is Hesai's: offsets are clockwise, and ids begin with 1."""
        return self.azimuth_sign < 0.0


def read_columns(source: str, text: str) -> list[Channel]:
    """Read channels from columns separated by commas, semicolons, tabs or spaces. No column of
    elevations, or a row that is invalid, raises `InputError`."""
    lines: Sequence[tuple[int, str]] = numbered_lines(text)
    while lines and lines[0][1].strip().lower().startswith(PREAMBLE):
        lines = lines[1:]
    if not lines:
        raise InputError(source, "file", "channel angles", "only comments")
    separator, lines = separated(lines)
    if not lines:
        raise InputError(source, "file", "channel angles", "a separator alone")
    by = separator if separator in lines[0][1] else None  # else blanks, in all lines
    rows = [(f"line {n}", _cells(line, by)) for n, line in lines]
    if any(map(_is_number, rows[0][1])):
        layout = _without_header(source, rows)
    else:
        layout = _from_header(source, rows[0])
        rows = rows[1:]
        if layout.is_hesai and rows and CHECKSUM.fullmatch(rows[-1][1][0]):
            rows.pop()
    if not rows:
        raise InputError(source, "file", "at least one channel", "a header alone")
    channels = [_channel(source, layout, row) for row in rows]
    if layout.number is None:
        return channels
    first = 1 if layout.is_hesai or all(c.number for c in channels) else 0
    return sorted_by_id(source, channels, first)


def _cells(line: str, separator: str | None) -> tuple[str, ...]:
    """Split a line into cells without blanks and quotes; empty cells at the end are dropped."""
    cells = [cell.strip().strip('"').strip() for cell in line.strip().split(separator)]
    while len(cells) > 1 and not cells[-1]:
        cells.pop()
    return tuple(cells)


def _is_number(cell: str) -> bool:
    """Whether a cell is a number; NaN and infinity are rejected later, with a reason."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _without_header(source: str, rows: Sequence[Line]) -> Layout:
    """Return the layout of one or two columns: elevation, azimuth offset."""
    first = rows[0][0]
    width = len(rows[0][1])
    if width > 2:
        expected = "one or two columns (elevation, azimuth offset), or a header"
        raise InputError(source, first, expected, f"{width} columns")
    for where, cells in rows:
        if len(cells) != width:
            expected = f"as many columns as in {first}, {width}"
            raise InputError(source, where, expected, len(cells))
    return Layout(width, 0, 1 if width == 2 else None)


def _from_header(source: str, header: Line) -> Layout:
    where, cells = header
    names = [_normalized(cell) for cell in cells]
    columns: list[int | None] = []
    for role, known in NAMES.items():
        fitting = [k for k, name in enumerate(names) if name in known]
        if len(fitting) > 1:
            both = " and ".join(repr(cells[k]) for k in fitting)
            raise InputError(source, where, f"one column of the {role}", both)
        columns.append(fitting[0] if fitting else None)
    elevation, azimuth, number = columns
    if elevation is None:
        raise InputError(source, where, LAYOUTS, quoted(", ".join(cells)))
    known_names = set().union(*NAMES.values())
    for cell, name in zip(cells, names, strict=True):
        if name not in known_names and name.startswith(ANGLE_PREFIXES):
            expected = "elevation_deg or azimuth_offset_deg as the name of a column of angles"
            raise InputError(source, where, expected, quoted(cell))
    # Hesai's header has an id and the bare name Azimuth; a user's own table says azimuth_offset.
    bare = azimuth is not None and cells[azimuth].lower() == "azimuth"
    sign = -1.0 if bare and number is not None else 1.0
    return Layout(len(names), elevation, azimuth, number, azimuth_sign=sign)


def _normalized(name: str) -> str:
    """Normalize a name: ``Elevation (deg)`` is ``elevation``."""
    name = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    # Known names are short; on a long one the pattern takes time by the square of its length.
    return UNIT.sub("", name) if len(name) <= MAX_QUOTE else name


def _channel(source: str, layout: Layout, row: Line) -> Channel:
    where, cells = row
    if len(cells) > layout.width:
        expected = f"no more columns than the header, {layout.width}"
        raise InputError(source, where, expected, len(cells))
    cells += ("",) * (layout.width - len(cells))
    number = None if layout.number is None else parse_id(source, where, cells[layout.number])
    elevation = parse_number(source, where, "the elevation", cells[layout.elevation])
    offset = 0.0
    if layout.azimuth is not None:
        offset = parse_number(source, where, "the azimuth offset", cells[layout.azimuth])
    return checked_channel(
        source, where, number, elevation, offset_deg=layout.azimuth_sign * offset
    )


def read_angles(path: str | Path) -> list[Channel]:
    """Read the channels of a LiDAR from a file; its content decides the layout, not its name.
    Layouts: plain columns (counter-clockwise offsets), Hesai's angle correction (clockwise),
    Ouster's metadata (JSON, clockwise), Velodyne's calibration of the ROS driver (YAML, radians).
    Channels are sorted by id if the file has ids, else in the file's order. A file of none of these
    layouts, or with a wrong value, raises `InputError`."""
    path = Path(path)
    source = str(path)
    text = decode_text(read_bytes(path))
    if not text.strip():
        raise InputError(source, "file", "channel angles", "an empty file")
    channels = driver_channels(source, text)
    return read_columns(source, text) if channels is None else channels
