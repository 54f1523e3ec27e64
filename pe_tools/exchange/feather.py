"""Feather tables (Arrow files), read and written with pyarrow.

An Arrow file is a stream of messages between a magic word and a footer. It is read as that stream,
not by its footer: so the messages whose size is checked are those that are unpacked.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import pyarrow
from pyarrow import feather

MAGIC = b"ARROW1"
"""First bytes of an Arrow file; its stream begins after two more."""
STREAM = 8
DICTIONARY, RECORDS = 2, 3
"""Types of the messages that have values, of `MessageHeader` in Arrow's Message.fbs."""
MAX_ROWS = 100_000
"""Columns of the null type have rows without a byte."""


def table_bytes(
    columns: Sequence[str],
    rows: Sequence[Sequence[Any]],
    whole: Collection[str],
    metadata: Mapping[str, str],
) -> bytes:
    """Return the bytes of a feather table.

    The columns of `whole` hold integers, sensor_name text, and all others floats.
    """
    own = {"sensor_name": pyarrow.string(), **dict.fromkeys(whole, pyarrow.int64())}
    types = [(name, own.get(name, pyarrow.float64())) for name in columns]
    schema = pyarrow.schema(types, metadata=dict(metadata))
    by_column = {name: [row[k] for row in rows] for k, name in enumerate(columns)}
    data = io.BytesIO()
    table = pyarrow.table(by_column, schema=schema)
    feather.write_feather(table, data, compression="uncompressed")
    return data.getvalue()


def rows_of(data: bytes) -> list[dict[str, Any]] | None:
    """Return the rows of a feather table, each by column name; None if the data are no such table.

    The caller has checked `unpacked_bytes`. A table of more than `MAX_ROWS` rows is none of a rig.

    Only version 2 of feather, the Arrow file format, is read. A damaged file of the obsolete
    version 1 would crash the process inside pyarrow. pyarrow reads offsets and lengths unchecked,
    so `validate` checks them all before values are read.
    """
    if not data.startswith(MAGIC):
        return None
    try:
        table = pyarrow.ipc.open_stream(data[STREAM:]).read_all()
        if len(table) > MAX_ROWS:
            return None
        table.validate(full=True)
        rows: list[dict[str, Any]] = table.to_pylist()
    except Exception:  # pyarrow's own, OSError, UnicodeDecodeError, OverflowError, MemoryError
        return None
    return rows


def unpacked_bytes(data: bytes) -> int | None:
    """Return how many bytes the values of a feather table have, unpacked; None for other data.

    A compressed buffer begins with its length before compression (Arrow columnar format, "IPC
    messages"): nothing is unpacked to read it.
    """
    if not data.startswith(MAGIC):
        return None
    try:
        reader = pyarrow.ipc.MessageReader.open_stream(data[STREAM:])
        return sum(_buffer_bytes(m.metadata.to_pybytes(), m.body) for m in reader)
    except Exception:  # pyarrow's own, OSError, struct.error, OverflowError, MemoryError
        return None


def _buffer_bytes(head: bytes, body: Any) -> int:
    """Return the unpacked bytes of all buffers of a message with a flatbuffer `head`."""
    message = _Flat(head, struct.unpack_from("<I", head)[0])
    kind = head[at] if (at := message.field(1)) else 0
    if kind not in (DICTIONARY, RECORDS):
        return 0
    batch = message.table(2)
    if kind == DICTIONARY:
        batch = batch.table(1)
    is_packed, total = bool(batch.field(3)), 0
    for offset, length in batch.pairs(2):
        unpacked = -1
        if is_packed and length > 0:
            (unpacked,) = struct.unpack_from("<q", body, offset)
        size = length if unpacked == -1 else unpacked  # -1: this buffer is not compressed
        if size < 0:
            raise ValueError("a negative length")
        total += size
    return total


class _Flat:
    """A table of a flatbuffer at a position of its bytes."""

    def __init__(self, data: bytes, at: int) -> None:
        self._data, self._at = data, at

    def field(self, number: int) -> int:
        """Return the position of a field; 0 for one that is left out."""
        known = self._at - struct.unpack_from("<i", self._data, self._at)[0]
        entry = 4 + 2 * number
        if entry >= struct.unpack_from("<H", self._data, known)[0]:
            return 0
        offset: int = struct.unpack_from("<H", self._data, known + entry)[0]
        return self._at + offset if offset else 0

    def table(self, number: int) -> _Flat:
        """Return the table that a field refers to."""
        at = self.field(number)
        return _Flat(self._data, at + struct.unpack_from("<I", self._data, at)[0])

    def pairs(self, number: int) -> Iterator[tuple[int, int]]:
        """Yield the pairs of 64-bit integers of a vector."""
        if at := self.field(number):
            at += struct.unpack_from("<I", self._data, at)[0]
            for k in range(struct.unpack_from("<I", self._data, at)[0]):
                yield struct.unpack_from("<qq", self._data, at + 4 + 16 * k)
