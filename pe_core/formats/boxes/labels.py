"""What every layout of boxes is read into, and the checks they share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ...errors import InputError
from ...prior.boxes import COLUMNS, MAX_M, SIZES, Boxes, name_is_fit
from ...text.cells import quoted

GROUND = (0.0, 0.0, 0.0)
FIRST_SIZE = COLUMNS.index(SIZES[0])
Origin = tuple[float, float, float]
Row = tuple[float, float, float, float, float, float, float]
"""A box as in `boxes.COLUMNS`: axes as the ground frame's, yaw in radians."""


@dataclass(slots=True)
class Labels:
    """Boxes of one or more files, each with the origin its layout has by default."""

    source: str
    names: list[str] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)
    origins: list[Origin] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)

    def add(self, where: str, name: str, row: Row, origin: Origin = GROUND) -> None:
        """Take a box; `where` says which one, for messages."""
        for column, value in zip(SIZES, row[FIRST_SIZE : FIRST_SIZE + 3], strict=True):
            if not value > 0.0:
                expected = f"a {column} above 0 m"
                raise InputError(self.source, where, expected, f"{value:g}")
        for column, value in zip(COLUMNS, row, strict=True):
            if not abs(value) <= MAX_M:
                expected = f"{column} within +-{MAX_M:g}"
                raise InputError(self.source, where, expected, f"{value:g}")
        if not name_is_fit(name):
            raise InputError(self.source, where, "a class in printable letters", quoted(name))
        self.names.append(name)
        self.rows.append(row)
        self.origins.append(origin)

    def leave_out(self, reason: str) -> None:
        """Count a box that is not taken."""
        self.left_out[reason] += 1

    def leave_unknown(self, name: str) -> None:
        """Count a box of a class that none of ours stands for."""
        self.leave_out(f"of unknown class {quoted(name)}")

    def boxes(self, origin: Origin | None = None) -> Boxes:
        """Return the boxes in the ground frame; `origin` replaces the layouts' own."""
        columns = np.array(self.rows, dtype=np.float64).T
        columns[:3] += np.array(self.origins).T if origin is None else np.array([origin]).T
        x, y, z, length, width, height, yaw = columns
        left_out = tuple(self.left_out.items())
        names = np.array(self.names)
        return Boxes(names, x, y, z, length, width, height, yaw, origin=origin, left_out=left_out)


def joined(parts: Iterable[Labels], source: str) -> Labels:
    """Return all boxes of several files."""
    whole = Labels(source)
    for part in parts:
        whole.names += part.names
        whole.rows += part.rows
        whole.origins += part.origins
        whole.left_out += part.left_out
    return whole
