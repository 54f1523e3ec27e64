"""One channel of an angle file, and the checks that every layout shares."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ....errors import InputError
from ....text.cells import quoted

MAX_ELEVATION_DEG = 90.0
MAX_OFFSET_DEG = 180.0
DECIMALS = 9
"""Degrees are rounded to what a saved study holds, so that its copy has the same beams."""

WHOLE = re.compile(r"\d{1,9}", re.ASCII)


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel's angles.

    Parameters
    ----------
    where : str
        Its place in the file, for messages (``line 3``).
    number : int or None
        Its id, if the file has ids.
    elevation_deg : float
        Above the horizon [deg].
    azimuth_offset_deg : float
        Counter-clockwise seen from above [deg].
    """

    where: str
    number: int | None
    elevation_deg: float
    azimuth_offset_deg: float


def checked(
    source: str, where: str, number: int | None, elevation_deg: float, offset_deg: float
) -> Channel:
    """Return a channel whose angles are in their range and rounded."""
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
    """Return a channel's id, a whole number >= 0."""
    if not WHOLE.fullmatch(text):
        raise InputError(source, where, "a whole number for the channel's id", quoted(text))
    return int(text)


def by_id(source: str, channels: Sequence[Channel], first: int) -> list[Channel]:
    """Return the channels sorted by id, which must run from `first` up without a gap."""
    found: dict[int | None, Channel] = {}
    for channel in channels:
        if channel.number is None or channel.number < first:
            raise InputError(source, channel.where, f"a channel id >= {first}", channel.number)
        if channel.number in found:
            again = f"{channel.number} again, after {found[channel.number].where}"
            raise InputError(source, channel.where, "a channel id used once", again)
        found[channel.number] = channel
    ids = range(first, first + len(found))
    for number in ids:
        if number not in found:
            expected = f"angles for it, as ids run without a gap from {first}"
            raise InputError(source, f"channel {number}", expected, "none")
    return [found[number] for number in ids]
