"""Channel angles in columns: a plain table, or Hesai's angle correction file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ....errors import InputError
from ....text.cells import LONGEST_QUOTE, numbered_lines, parse_number, quoted
from .channels import Channel, by_id, checked, parse_id

NAMES = {
    "elevation": {"elevation", "elevations", "elev", "vertical", "vert"},
    "azimuth": {
        *("azimuth", "azimuth_offset", "azimuth_offsets"),
        *("horizontal", "horizontal_offset", "horiz"),
    },
    "id": {"id", "laser", "laser_id", "channel", "channel_id", "ring"},
}
"""Column names, lower case, words joined by _, without their unit."""

UNIT = re.compile(r"(_(deg|degrees?|angles?))+$")
LIKE_AN_ANGLE = ("az", "elev", "hor", "vert")
"""How a column begins that is not to be passed over in silence when its name is not known."""

PREAMBLE = "eeff"
CHECKSUM = re.compile(r"[0-9a-fA-F]{64}")
"""Hesai's files may begin with ``EEFF,1,1`` and end with the SHA-256 of the rest."""

LAYOUTS = "a column named elevation, or Hesai or Velodyne channel angles"


@dataclass(frozen=True, slots=True)
class Line:
    """A line's number and its cells."""

    line: int
    cells: tuple[str, ...]

    @property
    def where(self) -> str:
        """The line, for messages."""
        return f"line {self.line}"


@dataclass(frozen=True, slots=True)
class Layout:
    """Which column holds what; `azimuth_sign` turns offsets counter-clockwise."""

    width: int
    elevation: int
    azimuth: int | None = None
    number: int | None = None
    azimuth_sign: float = 1.0

    @property
    def is_hesai(self) -> bool:
        """Whether offsets are clockwise and ids begin with 1."""
        return self.azimuth_sign < 0.0


def read_columns(source: str, text: str) -> list[Channel]:
    """Read channels from columns separated by commas, semicolons, tabs or spaces.

    Raises
    ------
    InputError
        When there is no column of elevations, or a row is wrong.
    """
    rows = _rows(text)
    if not rows:
        raise InputError(source, "file", "channel angles", "comments alone")
    if any(_is_number(cell) for cell in rows[0].cells):
        layout = _without_header(source, rows)
    else:
        layout = _from_header(source, rows[0])
        rows = _without_checksum(rows[1:]) if layout.is_hesai else rows[1:]
    if not rows:
        raise InputError(source, "file", "at least one channel", "a header alone")
    channels = [_channel(source, layout, row) for row in rows]
    if layout.number is None:
        return channels
    first = 1 if layout.is_hesai or all(c.number for c in channels) else 0
    return by_id(source, channels, first)


def _rows(text: str) -> list[Line]:
    """Cells of the lines, without Hesai's preamble; the first line tells the separator."""
    lines = numbered_lines(text)
    while lines and lines[0][1].strip().lower().startswith(PREAMBLE):
        lines = lines[1:]
    separator = next((s for s in ";,\t" if lines and s in lines[0][1]), None)
    return [Line(n, _cells(line, separator)) for n, line in lines]


def _cells(line: str, separator: str | None) -> tuple[str, ...]:
    """Cells without blanks and quotes around them; empty ones at the end are dropped."""
    cells = [cell.strip().strip('"').strip() for cell in line.strip().split(separator)]
    while len(cells) > 1 and not cells[-1]:
        cells.pop()
    return tuple(cells)


def _without_checksum(rows: list[Line]) -> list[Line]:
    return rows[:-1] if rows and CHECKSUM.fullmatch(rows[-1].cells[0]) else rows


def _is_number(cell: str) -> bool:
    """Whether a cell was meant as a number; NaN and infinity are refused later, with a reason."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _without_header(source: str, rows: Sequence[Line]) -> Layout:
    """One or two columns: elevation, azimuth offset."""
    width = len(rows[0].cells)
    if width > 2:
        expected = "one or two columns (elevation, azimuth offset), or a header"
        raise InputError(source, rows[0].where, expected, f"{width} columns")
    for row in rows:
        if len(row.cells) != width:
            expected = f"as many columns as in {rows[0].where}, {width}"
            raise InputError(source, row.where, expected, len(row.cells))
    return Layout(width, 0, 1 if width == 2 else None)


def _from_header(source: str, header: Line) -> Layout:
    names = [_plain(cell) for cell in header.cells]
    columns = {role: _column(source, header, names, role) for role in NAMES}
    elevation, azimuth, number = (columns[role] for role in NAMES)
    if elevation is None:
        raise InputError(source, header.where, LAYOUTS, quoted(", ".join(header.cells)))
    _check_unknown(source, header, names)
    # Hesai's header has an id and says Azimuth, no more; a table of one's own says azimuth_offset.
    bare = azimuth is not None and header.cells[azimuth].lower() == "azimuth"
    sign = -1.0 if bare and number is not None else 1.0
    return Layout(len(names), elevation, azimuth, number, sign)


def _plain(name: str) -> str:
    """``Elevation (deg)`` as ``elevation``."""
    plain = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    # A name of ours is short; on a long one the pattern would take the square of its length.
    return UNIT.sub("", plain) if len(plain) <= LONGEST_QUOTE else plain


def _column(source: str, header: Line, names: Sequence[str], role: str) -> int | None:
    """Index of the one column of that role, None if there is none."""
    found = [i for i, name in enumerate(names) if name in NAMES[role]]
    if len(found) > 1:
        both = " and ".join(repr(header.cells[i]) for i in found)
        raise InputError(source, header.where, f"one column of the {role}", both)
    return found[0] if found else None


def _check_unknown(source: str, header: Line, names: Sequence[str]) -> None:
    """Refuse a column that looks like an angle but is not one of the known names."""
    known = set().union(*NAMES.values())
    for cell, name in zip(header.cells, names, strict=True):
        if name not in known and name.startswith(LIKE_AN_ANGLE):
            expected = "elevation_deg or azimuth_offset_deg as the name of a column of angles"
            raise InputError(source, header.where, expected, quoted(cell))


def _channel(source: str, layout: Layout, row: Line) -> Channel:
    if len(row.cells) > layout.width:
        expected = f"no more columns than the header, {layout.width}"
        raise InputError(source, row.where, expected, len(row.cells))

    def cell(index: int) -> str:
        return row.cells[index] if index < len(row.cells) else ""

    number = None if layout.number is None else parse_id(source, row.where, cell(layout.number))
    elevation = parse_number(source, row.where, "the elevation", cell(layout.elevation))
    offset = 0.0
    if layout.azimuth is not None:
        offset = parse_number(source, row.where, "the azimuth offset", cell(layout.azimuth))
    return checked(source, row.where, number, elevation, layout.azimuth_sign * offset)
