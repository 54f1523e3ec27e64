"""Boxes as CSV: class, x, y, z of the centre, length, width, height [m], yaw [deg]."""

import math
import re
from collections.abc import Sequence
from functools import lru_cache

from pe_core.base.files import MAX_QUOTE, csv_text, parse_number, unmarked
from pe_core.prior.boxes import COLUMNS, Boxes, degrees_of

from ..csv_rows import csv_rows, separated
from .labels import Labels

CLASS = "class"
UNIT = re.compile(r"[ _]*[(\[]?(deg|degrees|m)[)\]]?$")


def read_csv(source: str, lines: Sequence[tuple[int, str]]) -> Labels:
    """Read boxes from numbered lines; columns are in any order, other columns are ignored."""
    separator, rows = separated(lines)
    labels = Labels(source)
    for where, cells in csv_rows(source, rows, (CLASS, *COLUMNS), separator, column=_column):
        x, y, z, length, width, height, yaw = (
            parse_number(source, where, column, cells[column]) for column in COLUMNS
        )
        row = x, y, z, length, width, height, math.radians(yaw)
        labels.add(where, unmarked(cells[CLASS]), row)
    return labels


def _column(cell: str) -> str:
    """Return the name of a column: in lower case, without the unit."""
    # Known names are short; on a long one the pattern takes time by the square of its length.
    name = cell.lower()
    return UNIT.sub("", name) if len(name) <= MAX_QUOTE else name


@lru_cache(maxsize=1)
def csv_bytes(boxes: Boxes) -> bytes:
    """Return boxes as a file that gives the same bits when it is read. It is cached for the last
    boxes, which do not change: a search writes them every few seconds."""
    columns = [getattr(boxes, c) for c in COLUMNS[:-1]] + [degrees_of(boxes.yaw)]
    rows = zip(boxes.names.tolist(), *(c.tolist() for c in columns), strict=True)
    return (",".join((CLASS, *COLUMNS)) + "\n" + csv_text(rows, quote_texts=True)).encode()
