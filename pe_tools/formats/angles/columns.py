"""Channel angles of a LiDAR in columns: a plain table, or Hesai's angle correction file.

Here is also what all layouts share: a channel, and the checks of its values.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pe_core.base.errors import InputError
from pe_core.base.files import MAX_QUOTE, numbered_lines, parse_number, quoted

MAX_ELEVATION_DEG = 90.0
MAX_OFFSET_DEG = 180.0
DECIMALS = 9
"""Degrees are rounded as a saved study stores them, so that its copy has the same beams."""
INTEGER = re.compile(r"\d{1,9}", re.ASCII)
NAMES = {
    "elevation": {"elevation", "elevations", "elev", "vertical", "vert"},
    "azimuth": {
        *("azimuth", "azimuth_offset", "azimuth_offsets"),
        *("horizontal", "horizontal_offset", "horiz"),
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
LAYOUTS = "a column named elevation, or Hesai or Velodyne channel angles"


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel's angles.

    Parameters
    ----------
    where : str
        Location in the file, for messages (``line 3``).
    number : int or None
        The channel's id, if the file has ids.
    elevation_deg : float
        Angle above the horizon [deg].
    azimuth_offset_deg : float
        Angle counter-clockwise seen from above [deg].
    """

    where: str
    number: int | None
    elevation_deg: float
    azimuth_offset_deg: float


def checked_channel(
    source: str, where: str, number: int | None, elevation_deg: float, offset_deg: float
) -> Channel:
    """Return a channel with rounded angles, or raise `InputError` if one is out of range."""
    for what, angle, limit in (
        ("an elevation", elevation_deg, MAX_ELEVATION_DEG),
        ("an azimuth offset", offset_deg, MAX_OFFSET_DEG),
    ):
        if not abs(angle) <= limit:
            raise InputError(source, where, f"{what} within +-{limit:g} degrees", f"{angle:g}")
    # + 0.0: no negative zero, which would be written out
    return Channel(
        where, number, round(elevation_deg, DECIMALS) + 0.0, round(offset_deg, DECIMALS) + 0.0
    )


def parse_id(source: str, where: str, text: str) -> int:
    """Return a channel's id, an integer >= 0."""
    if not INTEGER.fullmatch(text):
        raise InputError(source, where, "a whole number for the channel's id", quoted(text))
    return int(text)


def sorted_by_id(source: str, channels: Sequence[Channel], first: int) -> list[Channel]:
    """Return the channels sorted by id; ids must run from `first` up without a gap."""
    channel_by_id: dict[int | None, Channel] = {}
    for channel in channels:
        if channel.number is None or channel.number < first:
            raise InputError(source, channel.where, f"a channel id >= {first}", channel.number)
        if channel.number in channel_by_id:
            again = f"{channel.number} again, after {channel_by_id[channel.number].where}"
            raise InputError(source, channel.where, "a channel id used once", again)
        channel_by_id[channel.number] = channel
    ids = range(first, first + len(channel_by_id))
    for number in ids:
        if number not in channel_by_id:
            expected = f"angles for it, as ids run without a gap from {first}"
            raise InputError(source, f"channel {number}", expected, "none")
    return [channel_by_id[number] for number in ids]


@dataclass(frozen=True, slots=True)
class Line:
    """A line's number and cells."""

    line: int
    cells: tuple[str, ...]

    @property
    def where(self) -> str:
        """The location, for messages."""
        return f"line {self.line}"


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
    """Read channels from columns separated by commas, semicolons, tabs or spaces.

    Raises
    ------
    InputError
        When there is no column of elevations, or a row is invalid.
    """
    rows = _rows(text)
    if not rows:
        raise InputError(source, "file", "channel angles", "only comments")
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
    return sorted_by_id(source, channels, first)


def _rows(text: str) -> list[Line]:
    """Split the lines, without Hesai's preamble; the first line decides the separator."""
    lines = numbered_lines(text)
    while lines and lines[0][1].strip().lower().startswith(PREAMBLE):
        lines = lines[1:]
    separator = next((s for s in ";,\t" if lines and s in lines[0][1]), None)
    return [Line(n, _cells(line, separator)) for n, line in lines]


def _cells(line: str, separator: str | None) -> tuple[str, ...]:
    """Split a line into cells without blanks and quotes; empty cells at the end are dropped."""
    cells = [cell.strip().strip('"').strip() for cell in line.strip().split(separator)]
    while len(cells) > 1 and not cells[-1]:
        cells.pop()
    return tuple(cells)


def _without_checksum(rows: list[Line]) -> list[Line]:
    return rows[:-1] if rows and CHECKSUM.fullmatch(rows[-1].cells[0]) else rows


def _is_number(cell: str) -> bool:
    """Whether a cell is a number; NaN and infinity are rejected later, with a reason."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _without_header(source: str, rows: Sequence[Line]) -> Layout:
    """Return the layout of one or two columns: elevation, azimuth offset."""
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
    names = [_normalized(cell) for cell in header.cells]
    columns = {role: _column(source, header, names, role) for role in NAMES}
    elevation, azimuth, number = (columns[role] for role in NAMES)
    if elevation is None:
        raise InputError(source, header.where, LAYOUTS, quoted(", ".join(header.cells)))
    _check_unknown(source, header, names)
    # Hesai's header has an id and the bare name Azimuth; a user's own table says azimuth_offset.
    bare = azimuth is not None and header.cells[azimuth].lower() == "azimuth"
    sign = -1.0 if bare and number is not None else 1.0
    return Layout(len(names), elevation, azimuth, number, sign)


def _normalized(name: str) -> str:
    """Normalize a name: ``Elevation (deg)`` is ``elevation``."""
    name = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    # Known names are short; on a long one the pattern takes time by the square of its length.
    return UNIT.sub("", name) if len(name) <= MAX_QUOTE else name


def _column(source: str, header: Line, names: Sequence[str], role: str) -> int | None:
    """Index of the only column of a role; None if there is none."""
    columns = [i for i, name in enumerate(names) if name in NAMES[role]]
    if len(columns) > 1:
        both = " and ".join(repr(header.cells[i]) for i in columns)
        raise InputError(source, header.where, f"one column of the {role}", both)
    return columns[0] if columns else None


def _check_unknown(source: str, header: Line, names: Sequence[str]) -> None:
    """Reject a column that looks like an angle but has no known name."""
    known_names = set().union(*NAMES.values())
    for cell, name in zip(header.cells, names, strict=True):
        if name not in known_names and name.startswith(ANGLE_PREFIXES):
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
    return checked_channel(source, row.where, number, elevation, layout.azimuth_sign * offset)
