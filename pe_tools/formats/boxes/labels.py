"""The common form of boxes from all layouts, and checks that the layouts share."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from pe_core.base.errors import InputError
from pe_core.base.files import quoted
from pe_core.base.values import MAX_NAME
from pe_core.prior.boxes import COLUMNS, MAX_M, SIZES, Boxes, is_class_name

GROUND = (0.0, 0.0, 0.0)
MAX_REASONS = 20
OTHER_CLASSES = "of other unknown classes"
"""Maximum number of reasons for boxes left out; further classes are counted together."""
FIRST_SIZE = COLUMNS.index(SIZES[0])
Origin = tuple[float, float, float]
BoxNumbers = tuple[float, float, float, float, float, float, float]
"""A box as in `boxes.COLUMNS`: axes as the ground frame's, yaw in radians."""


@dataclass(slots=True)
class Labels:
    """Boxes of one or more files, each with the default origin of its layout."""

    source: str
    names: list[str] = field(default_factory=list)
    rows: list[BoxNumbers] = field(default_factory=list)
    origins: list[Origin] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)

    def add(self, where: str, name: str, row: BoxNumbers, origin: Origin = GROUND) -> None:
        """Add a box; `where` is its location in the file, for messages."""
        for column, value in zip(SIZES, row[FIRST_SIZE : FIRST_SIZE + 3], strict=True):
            if not value > 0.0:
                expected = f"a {column} above 0 m"
                raise InputError(self.source, where, expected, f"{value:g}")
        for column, value in zip(COLUMNS, row, strict=True):
            if not abs(value) <= MAX_M:
                expected = f"{column} within +-{MAX_M:g}"
                raise InputError(self.source, where, expected, f"{value:g}")
        if not is_class_name(name) or len(name) > MAX_NAME:
            raise InputError(self.source, where, "a class in printable letters", quoted(name))
        self.names.append(name)
        self.rows.append(row)
        self.origins.append(origin)

    def count_left_out(self, reason: str, count: int = 1) -> None:
        """Count boxes that are left out; beyond `MAX_REASONS`, reasons are counted together."""
        is_listed = reason in self.left_out or len(self.left_out) < MAX_REASONS
        self.left_out[reason if is_listed else OTHER_CLASSES] += count

    def boxes(self, origin: Origin | None = None) -> Boxes:
        """Return the boxes in the ground frame; `origin` replaces the layouts' own."""
        columns = np.array(self.rows, dtype=np.float64).T
        columns[:3] += np.array(self.origins).T if origin is None else np.array([origin]).T
        left_out = tuple(self.left_out.items())
        names = np.array(self.names)
        try:
            x, y, z, length, width, height, yaw = columns
            return Boxes(
                names=names,
                x=x,
                y=y,
                z=z,
                length=length,
                width=width,
                height=height,
                yaw=yaw,
                origin=origin,
                left_out=left_out,
            )
        except InputError as error:
            raise error.at(self.source) from None


def joined(parts: Iterable[Labels], source: str) -> Labels:
    """Return all boxes of several files."""
    whole = Labels(source)
    for part in parts:
        whole.names += part.names
        whole.rows += part.rows
        whole.origins += part.origins
        for reason, count in part.left_out.items():
            whole.count_left_out(reason, count)
    return whole
