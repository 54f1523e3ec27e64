"""Feather tables, by pyarrow."""

from __future__ import annotations

import io
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import pyarrow
from pyarrow import feather

MAGIC = b"ARROW1"
"""How an Arrow file begins."""


def table_bytes(
    columns: Mapping[str, Sequence[Any]], whole: Collection[str], metadata: Mapping[str, str]
) -> bytes:
    """Return a table of texts and numbers, those of the columns `whole` whole ones."""
    kinds = {name: _kind(name, values, whole) for name, values in columns.items()}
    schema = pyarrow.schema(kinds.items(), metadata=dict(metadata))
    data = io.BytesIO()
    table = pyarrow.table(dict(columns), schema=schema)
    feather.write_feather(table, data, compression="uncompressed")
    return data.getvalue()


def rows_of(data: bytes) -> list[dict[str, Any]] | None:
    """Return a table's rows by name of column; None of what is no feather table.

    Of the two versions of feather the second, Arrow's own file, is read: damage in one of the
    first, which nobody writes any more, ends the process within pyarrow. Offsets and lengths are
    taken as they stand; `validate` looks at all of them before a value is asked for.
    """
    if not data.startswith(MAGIC):
        return None
    try:
        table = feather.read_table(io.BytesIO(data), memory_map=False)
        table.validate(full=True)
        rows: list[dict[str, Any]] = table.to_pylist()
    except Exception:  # pyarrow's own, OSError, UnicodeDecodeError, OverflowError, MemoryError
        return None
    return rows


def _kind(name: str, values: Sequence[Any], whole: Collection[str]) -> Any:
    if name in whole:
        return pyarrow.int64()
    return pyarrow.string() if name == "sensor_name" else pyarrow.float64()
