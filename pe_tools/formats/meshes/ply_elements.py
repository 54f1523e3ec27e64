"""The data part of a PLY file: rows of elements, also with lists, as columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError
from pe_core.base.memory import require_memory

MAX_ROW_BYTES = 2**31 - 1
"""Maximum bytes of a row that NumPy can read at once."""
WALKED_BYTES = 200
"""Memory of a value or list that is read individually (measured)."""


@dataclass(frozen=True, slots=True)
class Property:
    """One value in each row; with a `count_type`, a list after its length."""

    name: str
    type: str
    count_type: str | None = None


@dataclass(frozen=True, slots=True)
class Element:
    """An element: `count` rows with the same properties."""

    name: str
    count: int
    properties: list[Property] = field(default_factory=list)


class Column(NamedTuple):
    """One property of all rows: the number of values of each row, and all values in one list."""

    counts: NDArray[np.int64]
    values: NDArray[Any]


def read_element(
    source: str, element: Element, data: bytes, offset: int
) -> tuple[dict[str, Column], int]:
    """Read the element's rows from `offset` on.

    Returns
    -------
    columns : dict of str to Column
    offset : int
        Start of the next element.

    Raises
    ------
    InputError
        The data end too early, or a list's length is not an integer of at least 0.
    """
    if not element.count or not element.properties:
        nothing = Column(np.zeros(0, np.int64), np.zeros(0))
        return {item.name: nothing for item in element.properties}, offset
    _require_possible(source, element, len(data) - offset)
    # Nearly all files have lists of equal length (triangles), which NumPy reads at once.
    rows = _even_rows(element, data, offset, _first_lengths(source, element, data, offset))
    if rows is None:
        return _walk(source, element, data, offset)
    columns = {}
    for i, item in enumerate(element.properties):
        values = rows[f"values{i}"]
        counts = np.full(len(rows), values.shape[1], dtype=np.int64)
        columns[item.name] = Column(counts, values.ravel())
    return columns, offset + rows.nbytes


def _row_bytes(element: Element, lengths: Sequence[int]) -> int:
    """Bytes of a row whose properties have `lengths` values each."""
    return sum(
        np.dtype(item.type).itemsize * length
        + (np.dtype(item.count_type).itemsize if item.count_type else 0)
        for item, length in zip(element.properties, lengths, strict=True)
    )


def _require_possible(source: str, element: Element, bytes_left: int) -> None:
    """Refuse a number of rows that does not fit even if all lists are empty."""
    min_row_bytes = _row_bytes(
        element, [0 if item.count_type else 1 for item in element.properties]
    )
    if element.count * min_row_bytes > bytes_left:
        found = f"data for at most {bytes_left // min_row_bytes:,}"
        raise InputError(source, f"element {element.name}", f"{element.count} rows", found)


def _first_lengths(source: str, element: Element, data: bytes, offset: int) -> list[int]:
    first = Element(element.name, 1, element.properties)
    columns, _ = _walk(source, first, data, offset)
    return [int(column.counts[0]) for column in columns.values()]


def _even_rows(
    element: Element, data: bytes, offset: int, lengths: list[int]
) -> NDArray[np.void] | None:
    """Read all rows as one structured array; None if lists differ in length."""
    row = _row_bytes(element, lengths)
    if row > MAX_ROW_BYTES or offset + element.count * row > len(data):
        return None
    fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
    for i, (item, length) in enumerate(zip(element.properties, lengths, strict=True)):
        if item.count_type:
            fields.append((f"count{i}", item.count_type))
        fields.append((f"values{i}", item.type, (length,)))
    layout = np.dtype(fields)
    rows = np.frombuffer(data, layout, element.count, offset)
    for i, (item, length) in enumerate(zip(element.properties, lengths, strict=True)):
        if item.count_type and (rows[f"count{i}"] != length).any():
            return None
    return rows


def _walk(source: str, element: Element, data: bytes, offset: int) -> tuple[dict[str, Column], int]:
    """Read row by row: for lists of different lengths, and to find the row where data end."""
    require_memory(source, f"element {element.name}", _walk_bytes(element))
    counts: list[list[int]] = [[] for _ in element.properties]
    values: list[list[NDArray[Any]]] = [[] for _ in element.properties]
    for row in range(element.count):
        for i, item in enumerate(element.properties):
            length = 1
            try:
                if item.count_type:
                    size, offset = _take(data, item.count_type, 1, offset)
                    length = _length(source, element, row, size[0])
                taken, offset = _take(data, item.type, length, offset)
            except EOFError as error:
                expected, found = f"{element.count} rows", f"the end of the file in row {row}"
                raise InputError(source, f"element {element.name}", expected, found) from error
            counts[i].append(length)
            values[i].append(taken)
    columns = {
        item.name: Column(np.array(counts[i], dtype=np.int64), np.concatenate(values[i]))
        for i, item in enumerate(element.properties)
    }
    return columns, offset


def _walk_bytes(element: Element) -> int:
    return element.count * len(element.properties) * WALKED_BYTES


def _take(data: bytes, code: str, count: int, offset: int) -> tuple[NDArray[Any], int]:
    end = offset + count * np.dtype(code).itemsize
    if end > len(data):
        raise EOFError
    return np.frombuffer(data[offset:end], code), end


def _length(source: str, element: Element, row: int, size: Any) -> int:
    if size < 0 or not float(size).is_integer():
        raise InputError(source, f"{element.name}[{row}]", "a list length from 0 up", str(size))
    return int(size)
