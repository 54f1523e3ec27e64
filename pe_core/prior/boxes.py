"""Labelled boxes: checked columns, and the report on boxes used and left out."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import Floats, read_only
from ..base.errors import InputError, shown
from ..base.values import A_PATH, Number, numbers, vector

KNOWN_CLASSES = ("car", "pedestrian", "cyclist", "truck", "cone")
"""The paper's classes, in their order in a prior; others follow alphabetically."""
COLUMNS = ("x", "y", "z", "length", "width", "height", "yaw")
SIZES = ("length", "width", "height")
MAX_M = 1e9
"""Maximum magnitude of a number [m]: arithmetic is safe up to here."""
YAW_DECIMALS = 9
"""Yaws are rounded to this many decimals of a degree: a copy in a file has the same bits."""
ORIGIN = Number(cap=1e6, unit="m")
OUTSIDE = "outside the space"
MAX_CLASSES = 64
"""Maximum number of classes. Data sets have up to 30; thousands are probably track numbers."""


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Labelled boxes in the ground frame; equal when they hold the same boxes.

    Parameters
    ----------
    names : (N,) str
        Class of each box.
    x, y, z : (N,) float
        Centres [m]; z too is the centre, half a height above the bottom.
    length, width, height : (N,) float
        Sizes [m]; the length lies along the heading.
    yaw : (N,) float
        Heading, counter-clockwise from x seen from above [rad].
    file : str, optional
        The file of the boxes, as the user named it.
    origin : (x, y, z) float, optional
        Origin of the labels' frame in the ground frame, if the user gave it [m].
    left_out : sequence of (reason, count)
        Boxes of the file that are not used.

    Raises
    ------
    InputError
        When columns differ in length, a number is not finite, a size is not positive, a name is
        empty or cannot be printed, or there are more than 64 names.
    """

    names: NDArray[np.str_]
    x: Floats
    y: Floats
    z: Floats
    length: Floats
    width: Floats
    height: Floats
    yaw: Floats
    file: str | None = None
    origin: tuple[float, float, float] | None = None
    left_out: tuple[tuple[str, int], ...] = ()
    digest: str = field(init=False, repr=False, default="")

    def __post_init__(self) -> None:
        names = np.array(self.names, dtype=np.str_).reshape(-1)
        for name in set(names.tolist()):
            if not is_class_name(name):
                raise InputError("boxes", "class", "a name in printable letters", shown(name))
        object.__setattr__(self, "names", read_only(names))
        for column in COLUMNS:
            values = _column(column, getattr(self, column), len(names))
            object.__setattr__(self, column, read_only(values))
        degrees = self.yaw * (180.0 / math.pi)
        degrees = np.round(degrees - 360.0 * np.rint(degrees / 360.0), YAW_DECIMALS) + 0.0
        object.__setattr__(self, "yaw", read_only(degrees * (math.pi / 180.0)))
        if self.file is not None:
            object.__setattr__(self, "file", A_PATH.checked("boxes", "file", self.file))
        if self.origin is not None:
            object.__setattr__(self, "origin", vector("boxes", "origin", self.origin, 3, ORIGIN))
        if (count := len(set(names.tolist()))) > MAX_CLASSES:
            expected = f"at most {MAX_CLASSES} names (is this the column of the class?)"
            raise InputError(self.source, "class", expected, f"{count:,}")
        digest = hashlib.sha256("\n".join(names.tolist()).encode("utf-8", "surrogatepass"))
        for column in COLUMNS:
            digest.update(getattr(self, column).tobytes())
        object.__setattr__(self, "digest", digest.hexdigest())

    def __len__(self) -> int:
        return len(self.names)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Boxes) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    @classmethod
    def of(cls, table: Any) -> Boxes:
        """Return the boxes of a table in memory, yaw in radians.

        `table` is a mapping or a structured array with the columns class, x, y, z, length, width,
        height, yaw, or a sequence of such rows.
        """
        if isinstance(table, np.ndarray) and table.dtype.names:
            table = {name: table[name] for name in table.dtype.names}
        if not isinstance(table, Mapping):
            table = _columns_of(table)
        for name in ("class", *COLUMNS):
            if name not in table:
                raise InputError("boxes", name, "a column of that name", "none")
        return cls(table["class"], *(table[c] for c in COLUMNS))

    @property
    def classes(self) -> tuple[str, ...]:
        """Names of the classes: the paper's in its order, then others alphabetically."""
        present = set(self.names.tolist())
        return (*(c for c in KNOWN_CLASSES if c in present), *sorted(present - {*KNOWN_CLASSES}))

    @property
    def source(self) -> str:
        """Name of the boxes in messages."""
        return self.file or "boxes"


@dataclass(frozen=True, slots=True)
class BoxReport:
    """How many boxes a prior uses, and why others are left out, as (reason, count).

    ``str()`` of the report is one line.
    """

    source: str
    taken: int
    left_out: tuple[tuple[str, int], ...] = ()

    def __str__(self) -> str:
        line = f"{self.source}: {self.taken:,} {_boxes(self.taken)} taken"
        total = sum(count for _, count in self.left_out)
        if not total:
            return line
        reasons = ", ".join(f"{count:,} {reason}" for reason, count in self.left_out)
        return f"{line}, {total:,} left out ({reasons})"


def _boxes(count: int) -> str:
    return "box" if count == 1 else "boxes"


def _columns_of(rows: Any) -> dict[str, Sequence[Any]]:
    """Columns of a sequence of rows."""
    names = ("class", *COLUMNS)
    if not isinstance(rows, Sequence) or isinstance(rows, (str, bytes)):
        raise InputError(
            "boxes", "table", "columns or rows (read_boxes reads a file)", type(rows).__name__
        )
    for i, row in enumerate(rows):
        if not isinstance(row, Sequence) or isinstance(row, str) or len(row) != len(names):
            raise InputError("boxes", f"box {i}", ", ".join(names), shown(row))
    return {name: [row[k] for row in rows] for k, name in enumerate(names)}


def is_class_name(name: str) -> bool:
    """Whether a text can be the name of a class: it survives being written to a line of a file."""
    return bool(name) and name.isprintable() and name == name.strip()


def _column(name: str, values: ArrayLike, count: int) -> Floats:
    """Return one column as a new array of finite floats, or raise for its first wrong box."""
    array = numbers(values)
    if array is None:
        raise InputError("boxes", name, "numbers", "something else")
    column = array.reshape(-1) + 0.0  # no negative zeros
    if len(column) != count:
        raise InputError("boxes", name, f"{count} numbers, one for each box", len(column))
    wrong = ~(np.abs(column) <= MAX_M)
    expected = "a finite number"
    if name in SIZES:
        wrong |= ~(column > 0.0)
        expected = "a length above 0 m"
    if wrong.any():
        first = int(np.flatnonzero(wrong)[0])
        raise InputError("boxes", f"box {first}: {name}", expected, column[first])
    return column


def degrees_of(yaw: Floats) -> Floats:
    """Return yaws [rad] in degrees, rounded as in a file."""
    return np.round(yaw * (180.0 / math.pi), YAW_DECIMALS)
