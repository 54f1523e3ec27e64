"""Boxes as CSV: class, x, y, z of the centre, length, width, height [m], yaw [deg]."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from functools import lru_cache

from pe_core.base.csv_text import csv_text, unmarked
from pe_core.base.errors import InputError
from pe_core.base.files import MAX_QUOTE, parse_number, quoted
from pe_core.prior.boxes import COLUMNS, Boxes, degrees_of

from .labels import BoxNumbers, Labels

CLASS = "class"
SEPARATORS = ",;\t"
UNIT = re.compile(r"[ _]*[(\[]?(deg|degrees|m)[)\]]?$")


def read_csv(source: str, lines: Sequence[tuple[int, str]]) -> Labels:
    """Read boxes from numbered lines; columns are in any order, other columns are ignored."""
    separator = next(s for s in ";\t," if s in lines[0][1])
    header = _header(source, lines[0], separator)
    where_is = {name: header.index(name) for name in (CLASS, *COLUMNS)}
    labels = Labels(source)
    for number, line in lines[1:]:
        where, cells = f"line {number}", _cells(source, number, line, separator)
        if len(cells) != len(header):
            expected = f"as many columns as the header, {len(header)}"
            raise InputError(source, where, expected, len(cells))
        labels.add(where, unmarked(cells[where_is[CLASS]]), _row(source, where, cells, where_is))
    return labels


@lru_cache(maxsize=1)
def csv_bytes(boxes: Boxes) -> bytes:
    """Return boxes as a file that gives the same bits when it is read.

    It is cached for the last boxes, which do not change: a search writes them every few seconds.
    """
    columns = [getattr(boxes, c) for c in COLUMNS[:-1]] + [degrees_of(boxes.yaw)]
    rows = zip(boxes.names.tolist(), *(c.tolist() for c in columns), strict=True)
    return (",".join((CLASS, *COLUMNS)) + "\n" + csv_text(rows, quote_texts=True)).encode()


def _header(source: str, line: tuple[int, str], separator: str) -> list[str]:
    cells = _cells(source, *line, separator)
    # Known names are short; on a long one the pattern takes time by the square of its length.
    lowered = [cell.lower() for cell in cells]
    names = [UNIT.sub("", name) if len(name) <= MAX_QUOTE else name for name in lowered]
    required = (CLASS, *COLUMNS)
    for name in required:
        if names.count(name) != 1:
            expected = f"a header with {', '.join(required)}, each once"
            found = f"{name} twice" if name in names else f"no {name} in {quoted(line[1].strip())}"
            raise InputError(source, f"line {line[0]}", expected, found)
    return names


def _cells(source: str, number: int, line: str, separator: str) -> list[str]:
    try:
        row = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error as error:
        raise InputError(source, f"line {number}", "a line of CSV", error) from None
    return [cell.strip() for cell in row]


def _row(source: str, where: str, cells: Sequence[str], where_is: dict[str, int]) -> BoxNumbers:
    x, y, z, length, width, height, yaw = (
        parse_number(source, where, c, cells[where_is[c]]) for c in COLUMNS
    )
    return x, y, z, length, width, height, math.radians(yaw)
