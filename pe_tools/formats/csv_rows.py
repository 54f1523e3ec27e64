"""Rows of a CSV table whose header names the columns, in any order."""

import csv
import re
from collections.abc import Callable, Iterator, Sequence

from pe_core.base.errors import InputError
from pe_core.base.files import quoted

SEPARATORS = ";\t,"
"""Separators of cells; the first of them in a header is that of its table."""
DECLARED = re.compile(r'"?sep=(.?)"?', re.IGNORECASE)
"""First line of a table as spreadsheets write it: names the separator (a tab at its end is cut)."""


def separated(lines: Sequence[tuple[int, str]]) -> tuple[str, Sequence[tuple[int, str]]]:
    """Return the separator of a table of numbered lines, and the lines from the header on. A first
    line `sep=;` names the separator; else the header has it, or it is a comma."""
    declared = DECLARED.fullmatch(lines[0][1].strip()) if lines else None
    if declared is not None:
        return declared[1] or "\t", lines[1:]
    header = lines[0][1] if lines else ""
    return next((s for s in SEPARATORS if s in header), ","), lines


def csv_rows(
    source: str,
    lines: Sequence[tuple[int, str]],
    required: Sequence[str],
    separator: str = ",",
    column: Callable[[str], str] = str.lower,
) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield the rows of numbered lines: "line N", and the cells by column; the header is first.
    `column` returns the name of a column from its cell. A column of `required` that is not there
    once, or a row with more or fewer cells than the header raises `InputError`."""
    if not lines:
        raise InputError(source, "file", f"a header with {', '.join(required)}", "none")
    (first, header), *rows = lines
    names = [column(cell) for cell in _cells(source, f"line {first}", header, separator)]
    for name in required:
        if names.count(name) != 1:
            expected = f"a header with {', '.join(required)}, each once"
            found = f"{name} twice" if name in names else f"no {name} in {quoted(header.strip())}"
            raise InputError(source, f"line {first}", expected, found)
    for number, line in rows:
        where = f"line {number}"
        cells = _cells(source, where, line, separator)
        if len(cells) != len(names):
            expected = f"as many columns as the header, {len(names)}"
            raise InputError(source, where, expected, len(cells))
        yield where, dict(zip(names, cells, strict=True))


def _cells(source: str, where: str, line: str, separator: str) -> list[str]:
    try:
        row = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error as error:
        raise InputError(source, where, "a line of CSV", error) from None
    return [cell.strip() for cell in row]
