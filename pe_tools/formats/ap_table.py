"""Tables of AP by measurement, in text."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text, numbered_lines, parse_number, quoted, read_bytes
from pe_tools.formats.ap_fit import ApTable

COLUMNS = ("m", "ap", "n")


def read_ap_table(path: str | Path) -> ApTable:
    """Read a CSV with the columns m and ap, and optionally n, the number of objects of each point.

    Lines that begin with ``#`` are comments. Other columns are ignored.

    Raises
    ------
    InputError
        One line with the file, the line's number, what was expected and what was found.
    """
    source = str(path)
    data = read_bytes(Path(path))
    if b"\0" in data:
        raise InputError(source, "file", "a table in text (CSV)", "binary data")
    rows = numbered_lines(decode_text(data))
    if not rows:
        raise InputError(source, "file", "a table with the columns m and ap", "nothing")
    names = [name.lower() for name in _cells(source, *rows[0])]
    for name in COLUMNS[:2]:
        if names.count(name) != 1:
            found = ", ".join(names)
            raise InputError(
                source, f"line {rows[0][0]}", f"one column named {name}", quoted(found)
            )
    values = [_values(source, k, names, _cells(source, k, line)) for k, line in rows[1:]]
    m, ap, n = np.array(values, dtype=float).reshape(-1, 3).T
    return ApTable(m, ap, n, source)


def _cells(source: str, number: int, line: str) -> list[str]:
    try:
        row = next(csv.reader([line], skipinitialspace=True))
    except csv.Error as error:
        raise InputError(source, f"line {number}", "a line of CSV", error) from None
    return [cell.strip() for cell in row]


def _values(
    source: str, line: int, names: Sequence[str], cells: Sequence[str]
) -> tuple[float, float, float]:
    """m, ap and n of a row, checked."""
    where = f"line {line}"
    if len(cells) != len(names):
        raise InputError(source, where, f"{len(names)} columns", len(cells))
    row = dict(zip(names, cells, strict=True))
    m, ap, n = (parse_number(source, where, name, row.get(name, "1")) for name in COLUMNS)
    if m < 0.0:
        raise InputError(source, where, "m of 0 or more", m)
    if not 0.0 <= ap <= 1.0:
        raise InputError(source, where, "ap between 0 and 1", ap)
    if n <= 0.0:
        raise InputError(source, where, "n above 0", n)
    return m, ap, n
