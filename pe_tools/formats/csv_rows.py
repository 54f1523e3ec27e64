"""Rows of a CSV table whose header names the columns, in any order."""

import csv
from collections.abc import Callable, Iterator, Sequence

from pe_core.base.errors import InputError
from pe_core.base.files import quoted


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
