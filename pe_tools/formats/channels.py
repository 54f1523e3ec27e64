"""A channel of a LiDAR as files of angles have it, and the checks that all their layouts share."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pe_core.base.errors import InputError
from pe_core.base.files import quoted

MAX_ELEVATION_DEG = 90.0
MAX_OFFSET_DEG = 180.0
DECIMALS = 9
"""Degrees are rounded as a saved study stores them, so that its copy has the same beams."""
INTEGER = re.compile(r"\d{1,9}", re.ASCII)


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel's angles [deg]: above the horizon, and counter-clockwise seen from above. `where`
    is its location in the file, for messages; `number` its id, if the file has ids."""

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
