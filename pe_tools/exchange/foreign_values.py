"""Text, JSON and numbers of other programs' files: reading, checks against limits, writing."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import TEXT_BYTES, decode_text, read_bytes
from pe_core.base.serialization import dump_json, parse_json
from pe_core.base.table_reader import Table
from pe_core.base.values import FINITE, Number, Whole, vector
from pe_core.geometry.poses import METRES, ROTATION, ROTATION_DEG, Pose
from pe_core.sensors.camera.lens import COEFFICIENT, FOCAL
from pe_core.sensors.camera.lens import PLACE as PRINCIPAL_POINT
from pe_core.sensors.camera.model import FARTHEST, PIXELS
from pe_core.sensors.field_of_view import MIN_RANGE
from pe_core.sensors.lidar.model import RANGE, STEPS

Written = Mapping[str, bytes]
"""Bytes by file name."""


def text_of(path: Path, max_bytes: int = TEXT_BYTES) -> str:
    """Return a file's text."""
    return decode_text(read_bytes(path, max_bytes))


def json_of(path: Path, max_bytes: int = TEXT_BYTES) -> Any:
    """Return the data of a JSON file. Raise `InputError` when it is not valid JSON."""
    return parse_json(path, text_of(path, max_bytes))


def json_bytes(data: Any) -> bytes:
    """Return data as a JSON file's bytes."""
    return dump_json(data).encode()


def json_rows(path: Path, data: Any, field: str = "") -> list[Table]:
    """Return a list of JSON objects as tables; `field` is the name of the list in messages."""
    if not isinstance(data, list):
        raise InputError(path, field or "document", "a list", type(data).__name__)
    return [Table(row, str(path), f"{field}[{k}]") for k, row in enumerate(data)]


def plain_number(value: float) -> str:
    """Return a number as text that reads back to the same bits; -0.0 is written as 0.0."""
    number = float(value) + 0.0
    return repr(0.0 if number == 0.0 else number)


def spaced(values: Sequence[float]) -> str:
    """Return numbers as text, separated by blanks."""
    return " ".join(plain_number(v) for v in values)


def pose_from(
    source: object, field: str, position: Any, angles: Any, *, degrees: bool = False
) -> Pose:
    """Return the pose of a position and of roll, pitch, yaw.

    Parameters
    ----------
    source, field : object, str
        File and place in it, for messages.
    position : (3,) sequence of float
        Position [m].
    angles : (3,) sequence of float
        Roll, pitch, yaw [rad], or [deg] if `degrees`.
    degrees : bool
        Whether the angles are in degrees.

    Raises
    ------
    InputError
        When a value is missing, not finite or out of range.
    """
    checked_position = vector(source, f"{field} position", position, 3, METRES)
    if degrees:
        checked_angles = vector(source, f"{field} rotation", angles, 3, ROTATION_DEG)
        return Pose.from_degrees(checked_position, checked_angles)
    x, y, z = checked_position
    roll, pitch, yaw = vector(source, f"{field} rotation", angles, 3, ROTATION)
    return Pose((x, y, z), (roll, pitch, yaw))


def named_numbers(table: Table, keys: Sequence[str]) -> tuple[float, ...]:
    """Return the finite numbers of a table at some keys, in the order of the keys."""
    return tuple(table.number(key, rule=FINITE) for key in keys)


__all__ = [
    "COEFFICIENT",
    "FARTHEST",
    "FOCAL",
    "MIN_RANGE",
    "PIXELS",
    "PRINCIPAL_POINT",
    "RANGE",
    "STEPS",
]
__all__ += ["AZIMUTH", "CHANNELS", "ELEVATION", "FOV_RAD", "figure", "figures", "whole_figure"]

QUARTER = math.pi / 2.0
ELEVATION = Number(-QUARTER, QUARTER, unit="rad", noun="angle")
AZIMUTH = Number(-4.0 * math.pi, 4.0 * math.pi, unit="rad", noun="angle")
FOV_RAD = Number(0.0, math.pi, above=True, below=True, unit="rad", noun="angle")
"""Field of view of a pinhole."""
CHANNELS = Whole(1, 10_000, "channels")
PLAIN = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
"""Syntax of a number in a file. Python's float() also accepts 1_0 and non-ASCII digits."""
MAX_LENGTH = 400
"""Maximum characters of a number; a float written in full has up to 325 digits after the point."""


def figure(source: object, field: str, value: Any, rule: Number = FINITE) -> float:
    """Return a value, a number or its text, as a float that satisfies a rule.

    Raises
    ------
    InputError
        When the value is not a number, not finite or out of the rule's range.
    """
    if not isinstance(value, str):
        return rule.checked(source, field, value)
    text = value.strip()
    if len(text) > MAX_LENGTH or not PLAIN.fullmatch(text):
        raise InputError(source, field, rule.expected_text(), shown(value))
    number = float(text)
    if not rule.holds(number):
        raise InputError(source, field, rule.expected_text(number), shown(value))
    return number


def whole_figure(source: object, field: str, value: Any, rule: Whole = PIXELS) -> int:
    """Return a value, a number or its text, as an integer that satisfies a rule.

    Raises
    ------
    InputError
        When the value is not an integer or out of the rule's range.
    """
    if isinstance(value, str) and len(value) <= MAX_LENGTH and PLAIN.fullmatch(value.strip()):
        number = float(value)
        return rule.checked(source, field, number if math.isfinite(number) else value)
    return rule.checked(source, field, value)


def figures(
    source: object, field: str, text: Any, counts: Sequence[int] | None, rule: Number = FINITE
) -> list[float]:
    """Return the numbers in a text, which are separated by blanks.

    Parameters
    ----------
    source, field : object, str
        File and place in it, for messages.
    text : str
        The numbers.
    counts : sequence of int or None
        Allowed counts of numbers; None allows any count.
    rule : Number
        Rule for each number.

    Raises
    ------
    InputError
        When the count is not allowed, or a number is malformed, not finite or out of range.
    """
    words = str(text).split() if isinstance(text, str) else [text]
    if counts is not None and len(words) not in counts:
        expected_counts = " or ".join(map(str, counts))
        raise InputError(source, field, f"{expected_counts} numbers", shown(text))
    return [figure(source, field, word, rule) for word in words]


MAX_FRAMES = 10_000
"""Maximum frames of a file: URDF links, ROS transforms, frames of a kit, rows of a table."""
MAX_SENSORS = 1_000
"""Maximum sensors of an imported rig."""
MAX_BEAMS = 1_000_000
"""Maximum beams that a file lists one by one; they take some 70 MB of text."""
BEAM_BYTES = 256 << 20
"""Maximum size of a file that lists beams."""
MAX_LINE_LENGTH = 10_000
"""Maximum characters of a line that is parsed."""


def require_at_most(source: object, field: str, count: int, most: int, noun: str) -> None:
    """Raise `InputError` when `count` exceeds `most`; `noun` names what is counted."""
    if count > most:
        raise InputError(source, field, f"at most {most:,} {noun}", f"{count:,}")
