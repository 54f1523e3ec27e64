"""Feather tables, by pyarrow."""

from __future__ import annotations

import io
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import pyarrow
from pyarrow import feather


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
    """Return a table's rows by name of column; None of what is no feather table."""
    try:
        rows: list[dict[str, Any]] = feather.read_table(io.BytesIO(data)).to_pylist()
    except pyarrow.ArrowException:
        return None
    return rows


def _kind(name: str, values: Sequence[Any], whole: Collection[str]) -> Any:
    if name in whole:
        return pyarrow.int64()
    return pyarrow.string() if name == "sensor_name" else pyarrow.float64()
