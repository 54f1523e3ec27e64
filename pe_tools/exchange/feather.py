"""Feather tables (Arrow files), read and written with pyarrow."""

from __future__ import annotations

import io
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import pyarrow
from pyarrow import feather

MAGIC = b"ARROW1"
"""First bytes of an Arrow file."""


def table_bytes(
    columns: Mapping[str, Sequence[Any]], whole: Collection[str], metadata: Mapping[str, str]
) -> bytes:
    """Return the bytes of a feather table.

    Parameters
    ----------
    columns : mapping of str to sequence
        Values by column name, all of one length.
    whole : collection of str
        Names of the columns of integers. Other columns hold floats; sensor_name holds text.
    metadata : mapping of str to str
        Metadata of the table.
    """
    types = {name: _kind(name, values, whole) for name, values in columns.items()}
    schema = pyarrow.schema(types.items(), metadata=dict(metadata))
    data = io.BytesIO()
    table = pyarrow.table(dict(columns), schema=schema)
    feather.write_feather(table, data, compression="uncompressed")
    return data.getvalue()


def rows_of(data: bytes) -> list[dict[str, Any]] | None:
    """Return the rows of a feather table, each by column name; None if the data are no such table.

    Only version 2 of feather, the Arrow file format, is read. A damaged file of the obsolete
    version 1 would crash the process inside pyarrow. pyarrow reads offsets and lengths unchecked,
    so `validate` checks them all before values are read.
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
