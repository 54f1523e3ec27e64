"""How much a foreign file may hold: counted before any work is done on it."""

from __future__ import annotations

from ..errors import InputError

MAX_FRAMES = 10_000
"""Frames of a file: links of a URDF, transforms of ROS, frames of a kit, rows of a table."""
MAX_SENSORS = 1_000
"""Sensors of a rig that is read."""
MAX_BEAMS = 1_000_000
"""Beams that are listed one by one: some 70 MB of text."""
BEAM_BYTES = 256 << 20
"""The greatest file with such lists."""
LONGEST_LINE = 10_000
"""Characters of a line that is taken apart."""


def require_at_most(source: object, field: str, count: int, most: int, noun: str) -> None:
    """Raise `InputError` when there are more than `most`."""
    if count > most:
        raise InputError(source, field, f"at most {most:,} {noun}", f"{count:,}")
