"""Labelled boxes: checked columns, how often each column and layer of the space is in a box.

A report tells which boxes were used and left out. All counts are integers, so the result does not
depend on the order of the boxes.
"""

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import Floats, Ints, mapped, read_only
from ..base.errors import InputError, shown
from ..base.notebook import ShortRepr
from ..base.values import A_PATH, Number, numbers, vector
from ..geometry.grids import PerceptionSpace
from .classes import Shape, normed

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
ROWS_AT_ONCE = 1 << 18
TIE_DECIMALS = 9
"""Edges are rounded to this many decimals of a voxel: a box whose edge runs through voxel centres
owns those at its lower edge, whatever the rounding errors."""
STRAIGHT = 1e-12
"""A sine or cosine below this counts as zero: the box is parallel to the grid."""


@dataclass(frozen=True, slots=True, eq=False)
class Boxes(ShortRepr):
    """Labelled boxes in the ground frame; equal when they hold the same boxes.

    `InputError` when columns differ in length, a number is not finite, a size is not positive, a
    name is empty or cannot be printed, or there are more than 64 names.

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
            object.__setattr__(
                self, "origin", vector("boxes", "origin", self.origin, count=3, rule=ORIGIN)
            )
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
    def of(cls, table: Any) -> "Boxes":
        """Return the boxes of a table in memory, yaw in radians.

        `table` is a mapping, a structured array or a data frame (pandas, polars) with the columns
        class, x, y, z, length, width, height, yaw, or a sequence of such rows, which may be
        mappings.
        """
        if not isinstance(table, Mapping):
            names = table.dtype.names if isinstance(table, np.ndarray) else _names_of(table)
            table = {name: table[name] for name in names} if names else _columns_of(table)
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


def _names_of(table: Any) -> list[str]:
    """Names of the columns of a data frame; none of anything else."""
    return list(getattr(table, "columns", ()))


def _columns_of(rows: Any) -> dict[str, Sequence[Any]]:
    """Columns of a sequence of rows."""
    names = ("class", *COLUMNS)
    if not isinstance(rows, Sequence) or isinstance(rows, (str, bytes)):
        raise InputError(
            "boxes", "table", "columns or rows (read_boxes reads a file)", type(rows).__name__
        )
    if rows and all(isinstance(row, Mapping) for row in rows):
        rows = [[_cell(i, row, name) for name in names] for i, row in enumerate(rows)]
    for i, row in enumerate(rows):
        if not isinstance(row, Sequence) or isinstance(row, str) or len(row) != len(names):
            raise InputError("boxes", f"box {i}", ", ".join(names), shown(row))
    return {name: [row[k] for row in rows] for k, name in enumerate(names)}


def _cell(number: int, row: Mapping[str, Any], name: str) -> Any:
    """Return a value of a row by its column."""
    if name not in row:
        raise InputError("boxes", f"box {number}: {name}", "a value of that name", "none")
    return row[name]


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


class Voxelised(NamedTuple):
    """The density of every class on one space, and the report on the boxes."""

    shapes: tuple[Shape, ...]
    report: BoxReport


@lru_cache(maxsize=2)
def voxelised(boxes: Boxes, space: PerceptionSpace) -> Voxelised:
    """Return boxes as densities over a space, class by class in the order of `Boxes.classes`.

    A voxel belongs to a box if its centre lies inside. A box without any voxel centre (thinner than
    a voxel) gets the column or layer of its own centre. A class without boxes in the space has no
    mass. `InputError` when no box is in the space. The last two results are cached.
    """
    shapes = []
    inside = 0
    for name in boxes.classes:
        shape, count = _class_counts(_Footprints(boxes, np.flatnonzero(boxes.names == name)), space)
        shapes.append(shape)
        inside += count
    if not inside:
        bounds = ", ".join(f"{a} {list(getattr(space, a))}" for a in "xyz")
        expected = f"a box in the space ({bounds}), in the ground frame of the vehicle"
        raise InputError(boxes.source, "boxes", expected, f"all {len(boxes):,} outside")
    outside = len(boxes) - inside
    reasons = (*([(OUTSIDE, outside)] if outside else []), *boxes.left_out)
    return Voxelised(tuple(shapes), BoxReport(boxes.source, inside, reasons))


class _Footprints:
    """Centres and half sizes of some boxes, and cosine and sine of their yaws. The sines are those
    of `math`, which are the same in all builds of NumPy."""

    def __init__(self, boxes: Boxes, index: Ints) -> None:
        self.x = boxes.x[index]
        self.y = boxes.y[index]
        self.z = boxes.z[index]
        self.along = boxes.length[index] / 2.0
        self.across = boxes.width[index] / 2.0
        self.up = boxes.height[index] / 2.0
        self.cos, self.sin = (mapped(turn, boxes.yaw[index]) for turn in (math.cos, math.sin))
        for values in (self.cos, self.sin):
            values[np.abs(values) < STRAIGHT] = 0.0


def _class_counts(boxes: _Footprints, space: PerceptionSpace) -> tuple[Shape, int]:
    """Return the density of a class, and how many of its boxes are in the space."""
    nx, ny, nz = space.shape
    first, last = _layers(boxes, space)
    layers = last - first
    steps = np.zeros(
        (nx, ny + 1), np.int64
    )  # differences along y: a run of columns costs two additions
    columns = np.zeros(len(layers), np.int64)
    for which, i, start, end in _rows(boxes, space):
        np.add.at(steps, (i, start), layers[which])
        np.subtract.at(steps, (i, end), layers[which])
        np.add.at(columns, which, end - start)
    thin = np.flatnonzero(columns == 0)
    i = voxel_of(boxes.x[thin], space, 0)
    j = voxel_of(boxes.y[thin], space, 1)
    inside = (i >= 0) & (j >= 0)
    thin = thin[inside]
    i = i[inside]
    j = j[inside]
    np.add.at(steps, (i, j), layers[thin])
    np.subtract.at(steps, (i, j + 1), layers[thin])
    columns[thin] = 1
    rises = np.zeros(nz + 1, np.int64)
    np.add.at(rises, first, columns)
    np.subtract.at(rises, last, columns)
    ground = np.cumsum(steps, axis=1)[:, :-1]
    profile = np.cumsum(rises)[:-1]
    shape = normed(ground.astype(float), profile)
    for values in shape:
        read_only(values)  # the caller gets the cached arrays
    return shape, int(((columns > 0) & (layers > 0)).sum())


def _layers(boxes: _Footprints, space: PerceptionSpace) -> tuple[Ints, Ints]:
    """First layer of each box, and the one after its last."""
    first = _first_center(boxes.z - boxes.up, space, 2)
    last = _first_center(boxes.z + boxes.up, space, 2)
    own = voxel_of(boxes.z, space, 2)
    thin = (first == last) & (own >= 0)
    return np.where(thin, own, first), np.where(thin, own + 1, last)


def _rows(boxes: _Footprints, space: PerceptionSpace) -> Iterator[tuple[Ints, Ints, Ints, Ints]]:
    """Yield rows of columns inside boxes: box, index along x, first along y, one past the last."""
    reach = np.abs(boxes.cos) * boxes.along + np.abs(boxes.sin) * boxes.across
    first = _first_center(boxes.x - reach, space, 0)
    counts = _first_center(boxes.x + reach, space, 0) - first
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    for start in range(0, total, ROWS_AT_ONCE):
        row = np.arange(start, min(start + ROWS_AT_ONCE, total))
        which = np.searchsorted(ends, row, side="right")
        i = first[which] + row - (ends - counts)[which]
        low, high = _across(boxes, which, space.centers(0)[i] - boxes.x[which])
        low, high = (boxes.y[which] + edge for edge in (low, high))
        begin, end = (_first_center(edge, space, 1) for edge in (low, high))
        yield which, i, begin, np.maximum(begin, end)


def _across(boxes: _Footprints, which: Ints, dx: Floats) -> tuple[Floats, Floats]:
    """Where a line along y, at `dx` from the boxes' centres, enters and leaves their rectangles.
    Both are offsets in y from the centre: the line is clipped to the strip between the long sides
    and to the strip between the short ones."""
    cos = boxes.cos[which]
    sin = boxes.sin[which]
    long_low, long_high = _strip(sin * dx, boxes.across[which], cos)
    short_low, short_high = _strip(-cos * dx, boxes.along[which], sin)
    return np.maximum(long_low, short_low), np.minimum(long_high, short_high)


def _strip(middle: Floats, half: Floats, slope: Floats) -> tuple[Floats, Floats]:
    """Solve |slope * y - middle| <= half for y; all y where the slope is zero."""
    parallel = slope == 0.0
    slope = np.where(parallel, 1.0, slope)
    center = middle / slope
    reach = half / np.abs(slope)
    low = center - reach
    high = center + reach
    return np.where(parallel, -np.inf, low), np.where(parallel, np.inf, high)


def _first_center(edge: Floats, space: PerceptionSpace, axis: int) -> Ints:
    """Index of the first voxel centre at or above an edge, 0 to the number of voxels."""
    steps = (edge - space.origin[axis]) / space.interval - 0.5
    clipped = np.clip(steps, 0.0, space.shape[axis])
    return np.ceil(np.round(clipped, TIE_DECIMALS)).astype(np.int64)


def voxel_of(value: Floats, space: PerceptionSpace, axis: int) -> Ints:
    """Index of the voxel that holds a coordinate, -1 outside the space."""
    count = space.shape[axis]
    steps = np.clip((value - space.origin[axis]) / space.interval, -1.0, count)
    index = np.floor(np.round(steps, TIE_DECIMALS)).astype(np.int64)
    return np.where(index < count, index, -1)
