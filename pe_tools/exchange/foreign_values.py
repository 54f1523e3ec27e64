"""Text, JSON and numbers of other programs' files: reading, checks against limits, writing."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import TEXT_BYTES, decode_text, read_bytes
from pe_core.base.table_reader import Table, parse_json
from pe_core.base.values import FINITE, Number, Whole, vector
from pe_core.geometry.poses import METRES, ROTATION, ROTATION_DEG, Pose
from pe_core.sensors.camera.lens import COEFFICIENT as COEFFICIENT
from pe_core.sensors.camera.lens import FOCAL as FOCAL
from pe_core.sensors.camera.lens import PLACE
from pe_core.sensors.camera.model import FARTHEST as FARTHEST
from pe_core.sensors.camera.model import PIXELS as PIXELS
from pe_core.sensors.field_of_view import MIN_RANGE as MIN_RANGE
from pe_core.sensors.lidar.model import RANGE as RANGE
from pe_core.sensors.lidar.model import STEPS as STEPS

Written = Mapping[str, bytes]  # Bytes by file name
Export = tuple[Written, list[str]]  # Files, and messages on what they cannot hold
# Keys of a pose in most formats
XYZ = ("x", "y", "z")
RPY = ("roll", "pitch", "yaw")
PRINCIPAL_POINT = PLACE
QUARTER = math.pi / 2.0
ELEVATION = Number(-QUARTER, QUARTER, unit="rad", noun="angle")
AZIMUTH = Number(-4.0 * math.pi, 4.0 * math.pi, unit="rad", noun="angle")
CHANNELS = Whole(1, 10_000, "channels")
PLAIN = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
"""Syntax of a number in a file. Python's float() also accepts 1_0 and non-ASCII digits."""
MAX_LENGTH = 400
"""Maximum characters of a number; a float written in full has up to 325 digits after the point."""
MAX_FRAMES = 10_000
"""Maximum frames of a file: URDF links, ROS transforms, frames of a kit, rows of a table."""
MAX_SENSORS = 1_000  # Maximum sensors of an imported rig
MAX_BEAMS = 1_000_000  # Maximum beams that a file lists one by one; they take some 70 MB of text
BEAM_BYTES = 256 << 20  # Maximum size of a file that lists beams
MAX_LINE_LENGTH = 10_000  # Maximum characters of a line that is parsed


def text_of(path: Path, max_bytes: int = TEXT_BYTES) -> str:
    """Return a file's text."""
    return decode_text(read_bytes(path, max_bytes))


def json_of(path: Path, max_bytes: int = TEXT_BYTES) -> Any:
    """Return the data of a JSON file. Raise `InputError` when it is not valid JSON."""
    return parse_json(path, text_of(path, max_bytes))


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
    """Return the pose of a position [m] and of roll, pitch, yaw, in radians unless `degrees`. A
    value that is missing, not finite or out of range raises `InputError`."""
    x, y, z = vector(source, f"{field} position", position, count=3, rule=METRES)
    rule = ROTATION_DEG if degrees else ROTATION
    roll, pitch, yaw = vector(source, f"{field} rotation", angles, count=3, rule=rule)
    if degrees:
        return Pose.from_degrees((x, y, z), (roll, pitch, yaw))
    return Pose((x, y, z), (roll, pitch, yaw))


def pose_numbers(pose: Pose, *, degrees: bool = False) -> dict[str, float]:
    """Return the coordinates [m] and the angles of a pose by key, in radians unless `degrees`."""
    angles = pose.rotation_deg if degrees else pose.rpy
    return dict(zip((*XYZ, *RPY), (*pose.position, *angles), strict=True))


def named_numbers(table: Table, keys: Sequence[str]) -> tuple[float, ...]:
    """Return the finite numbers of a table at some keys, in the order of the keys."""
    return tuple(table.number(key, rule=FINITE) for key in keys)


def figure(source: object, field: str, value: Any, rule: Number = FINITE) -> float:
    """Return a value, a number or its text, as a float that meets a rule, or raise `InputError`."""
    if not isinstance(value, str):
        return rule.checked(source, field, value)
    text = value.strip()
    number = float(text) if len(text) <= MAX_LENGTH and PLAIN.fullmatch(text) else math.nan
    if not rule.holds(number):
        raise InputError(source, field, rule.expected_text(number), shown(value))
    return number


def whole_figure(source: object, field: str, value: Any, rule: Whole = PIXELS) -> int:
    """Return a value, a number or its text, as an int that meets a rule, or raise `InputError`."""
    if isinstance(value, str) and len(value) <= MAX_LENGTH and PLAIN.fullmatch(value.strip()):
        number = float(value)
        return rule.checked(source, field, number if math.isfinite(number) else value)
    return rule.checked(source, field, value)


def figures(
    source: object, field: str, text: Any, count: int | None, rule: Number = FINITE
) -> list[float]:
    """Return the `count` numbers in a text, separated by blanks, that meet a rule each. None allows
    any count. Another count, or a number that breaks the rule, raises `InputError`."""
    words = text.split() if isinstance(text, str) else [text]
    if count not in (None, len(words)):
        raise InputError(source, field, f"{count} numbers", shown(text))
    return [figure(source, field, word, rule) for word in words]


@dataclass(frozen=True, slots=True)
class ForeignNumbers:
    """Numbers of an element of a file, by key: None if it is absent, `InputError` if it is wrong.
    `get` returns the value of a key, a number or its text, or None; `field` is its name in
    messages."""

    source: object
    get: Callable[[str], Any]
    field: Callable[[str], str]

    def number(self, key: str, rule: Number = FINITE) -> float | None:
        """Return the number of a key that meets a rule."""
        value = self.get(key)
        return None if value is None else figure(self.source, self.field(key), value, rule)

    def whole(self, key: str, rule: Whole = PIXELS) -> int | None:
        """Return the integer of a key that meets a rule."""
        value = self.get(key)
        return None if value is None else whole_figure(self.source, self.field(key), value, rule)

    def numbers(self, keys: Sequence[str], rule: Number = FINITE) -> list[float] | None:
        """Return the numbers of several keys; None if one of them is absent."""
        values = [self.number(key, rule) for key in keys]
        return None if None in values else [value for value in values if value is not None]


def require_at_most(source: object, field: str, count: int, most: int, noun: str) -> None:
    """Raise `InputError` when `count` exceeds `most`; `noun` names what is counted."""
    if count > most:
        raise InputError(source, field, f"at most {most:,} {noun}", f"{count:,}")
