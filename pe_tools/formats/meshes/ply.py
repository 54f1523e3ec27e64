"""PLY: ASCII and binary of either byte order."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError, require_memory
from pe_core.base.files import decode_text
from pe_core.scene.mesh import Mesh

from .mesh import TEXT_UNFOLDS, fan, fan_size, gathered, make_mesh, require_room

_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    "i1": ("char", "int8"),
    "u1": ("uchar", "uint8"),
    "i2": ("short", "int16"),
    "u2": ("ushort", "uint16"),
    "i4": ("int", "int32"),
    "u4": ("uint", "uint32"),
    "f4": ("float", "float32"),
    "f8": ("double", "float64"),
}
_CODES = {word: code for code, words in _TYPES.items() for word in words}
MAX_HEADER_BYTES = 1 << 20
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

    def bytes_of(self, length: int) -> int:
        """Return the bytes of a value, or of a list with `length` values."""
        count = np.dtype(self.count_type).itemsize if self.count_type else 0
        return np.dtype(self.type).itemsize * length + count


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


def read_ply(path: Path, data: bytes) -> Mesh:
    """Read a PLY file's faces as one part with the file's stem as its name.

    Coordinates are metres in the ground frame. Polygons are cut into fans. Other elements and
    properties are ignored.
    """
    source = str(path)
    header, body = _split(source, data)
    elements, order = _parse_header(source, header)
    if not order:
        # An ASCII body is converted to a binary one in which every value is a double.
        body = _numbers(source, body).tobytes()
    columns: dict[str, dict[str, Column]] = {}
    offset = 0
    for element in elements:
        columns[element.name], offset = _read_element(source, element, body, offset)
    points = _points(source, columns.get("vertex", {}))
    faces = _faces(source, columns.get("face", {}), len(points))
    require_room(source, fan_size(faces.counts))
    corners = faces.values.astype(np.int64)
    is_triangles = (faces.counts == 3).all()
    corners = corners.reshape(-1, 3) if is_triangles else corners[fan(faces.counts)[0]]
    triangles = gathered(points, corners)
    return make_mesh(source, triangles, np.zeros(len(triangles), np.int32), [path.stem])


def _split(source: str, data: bytes) -> tuple[list[str], bytes]:
    # All lines of the header have the ending of the first line: a binary body may start with a
    # byte that looks like the second half of a line ending.
    ending = next((e for e in (b"\r\n", b"\n", b"\r") if data.startswith(b"ply" + e)), None)
    if ending is None:
        raise InputError(source, "header", "'ply' on the first line", repr(data[:16]))
    last = ending + b"end_header" + ending
    end = data.find(last, 0, MAX_HEADER_BYTES)
    if end < 0:
        whole = len(data) <= MAX_HEADER_BYTES
        found = "the end of the file" if whole else f"none in {MAX_HEADER_BYTES:,} bytes"
        raise InputError(source, "header", "end_header", found)
    return decode_text(data[:end]).split("\n"), data[end + len(last) :]


def _parse_header(source: str, lines: list[str]) -> tuple[list[Element], str]:
    """Return the elements, with byte orders in their types, and the byte order: '' if ASCII."""
    elements: list[Element] = []
    names: set[str] = set()
    order: str | None = None
    for number, line in enumerate(lines, 1):
        match line.split():
            case ["format", kind, "1.0"] if kind in _ORDERS:
                order = _ORDERS[kind]
            # No file has a longer count, and int() refuses texts beyond some length.
            case ["element", name, count] if count.isdecimal() and len(count) < 16:
                elements.append(Element(name, int(count)))
                names.clear()
            case ["property", *words] if elements and order is not None:
                item = _property(source, number, words, order)
                if item.name in names:
                    raise InputError(source, f"line {number}", "a new name", repr(item.name))
                names.add(item.name)
                elements[-1].properties.append(item)
            case [] | ["ply"] | ["comment" | "obj_info", *_]:
                pass
            case _:
                expected = "format, element or property, well-formed and in order"
                raise InputError(source, f"line {number}", expected, repr(line[:60]))
    if order is None:
        raise InputError(source, "header", "a format line", "none")
    return elements, order


def _property(source: str, number: int, words: list[str], order: str) -> Property:
    def code(word: str) -> str:
        return order + _CODES[word] if order else "<f8"

    match words:
        case ["list", count, kind, name] if count in _CODES and kind in _CODES:
            return Property(name, code(kind), code(count))
        case [kind, name] if kind in _CODES:
            return Property(name, code(kind))
    found = repr(" ".join(words)[:60])
    raise InputError(source, f"line {number}", "a property of known type and a name", found)


def _numbers(source: str, body: bytes) -> NDArray[np.float64]:
    require_memory(source, "data", len(body) * TEXT_UNFOLDS)
    words = decode_text(body).split()
    try:
        return np.array(list(map(float, words)), dtype="<f8")
    except ValueError as error:
        found = str(error).rpartition(": ")[2][:60]
        raise InputError(source, "data", "numbers only", found) from error


def _points(source: str, vertex: dict[str, Column]) -> NDArray[np.float64]:
    axes = [vertex[axis] for axis in "xyz" if axis in vertex]
    if len(axes) < 3 or any((axis.counts != 1).any() for axis in axes):
        found = ", ".join(vertex) or "none"
        raise InputError(source, "element vertex", "properties x, y and z", found)
    return np.stack([axis.values.astype(np.float64) for axis in axes], axis=1)


def _faces(source: str, face: dict[str, Column], points: int) -> Column:
    """Return the face lists, with every index checked."""
    faces = face.get("vertex_indices", face.get("vertex_index"))
    if faces is None:
        found = ", ".join(face) or "none"
        raise InputError(source, "element face", "a list called vertex_indices", found)
    values = faces.values
    whole = values.dtype.kind in "iu" and values.size > 0
    if whole and 0 <= int(values.min()) <= int(values.max()) < points:  # the usual case
        return faces
    # In this form of the condition NaN is refused, too.
    bad = np.flatnonzero(~((values >= 0) & (values < points) & (values == np.floor(values))))
    if bad.size:
        row = int(np.searchsorted(np.cumsum(faces.counts), bad[0], side="right"))
        expected = f"vertex indices within the {points} vertices"
        raise InputError(source, f"face[{row}]", expected, str(values[bad[0]]))
    return faces


def _read_element(
    source: str, element: Element, data: bytes, offset: int
) -> tuple[dict[str, Column], int]:
    """Read the element's rows from `offset` on; return its columns and where the next one begins.

    Data that end too early, or a list's length that is no integer of at least 0, raise
    `InputError`.
    """
    properties = element.properties
    if not element.count or not properties:
        nothing = Column(np.zeros(0, np.int64), np.zeros(0))
        return {item.name: nothing for item in properties}, offset
    # The rows have to fit even if all lists are empty.
    least, left = sum(i.bytes_of(0 if i.count_type else 1) for i in properties), len(data) - offset
    if element.count * least > left:
        found = f"data for at most {left // least:,}"
        raise InputError(source, f"element {element.name}", f"{element.count} rows", found)
    # Nearly all files have lists of equal length (triangles), which NumPy reads at once.
    first, _ = _walk(source, replace(element, count=1), data, offset)
    rows = _even_rows(element, data, offset, [int(c.counts[0]) for c in first.values()])
    if rows is None:
        return _walk(source, element, data, offset)
    columns = {}
    for i, item in enumerate(properties):
        values = rows[f"values{i}"]
        counts = np.full(len(rows), values.shape[1], dtype=np.int64)
        columns[item.name] = Column(counts, values.ravel())
    return columns, offset + rows.nbytes


def _even_rows(
    element: Element, data: bytes, offset: int, lengths: list[int]
) -> NDArray[np.void] | None:
    """Read all rows as one structured array; None if lists differ in length."""
    pairs = list(zip(element.properties, lengths, strict=True))
    row = sum(item.bytes_of(length) for item, length in pairs)
    if row > MAX_ROW_BYTES or offset + element.count * row > len(data):
        return None
    fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
    for i, (item, length) in enumerate(pairs):
        if item.count_type:
            fields.append((f"count{i}", item.count_type))
        fields.append((f"values{i}", item.type, (length,)))
    rows = np.frombuffer(data, np.dtype(fields), element.count, offset)
    for i, (item, length) in enumerate(pairs):
        if item.count_type and (rows[f"count{i}"] != length).any():
            return None
    return rows


def _walk(source: str, element: Element, data: bytes, offset: int) -> tuple[dict[str, Column], int]:
    """Read row by row: for lists of different lengths, and to find the row where data end."""
    needed = element.count * len(element.properties) * WALKED_BYTES
    require_memory(source, f"element {element.name}", needed)
    counts: list[list[int]] = [[] for _ in element.properties]
    values: list[list[NDArray[Any]]] = [[] for _ in element.properties]

    def take(code: str, count: int) -> NDArray[Any]:
        nonlocal offset
        start, offset = offset, offset + count * np.dtype(code).itemsize
        if offset > len(data):
            found = f"the end of the file in row {row}"
            raise InputError(source, f"element {element.name}", f"{element.count} rows", found)
        return np.frombuffer(data[start:offset], code)

    for row in range(element.count):
        for i, item in enumerate(element.properties):
            length = 1
            if item.count_type:
                (size,) = take(item.count_type, 1)
                if size < 0 or not float(size).is_integer():
                    field_name = f"{element.name}[{row}]"
                    raise InputError(source, field_name, "a list length from 0 up", str(size))
                length = int(size)
            counts[i].append(length)
            values[i].append(take(item.type, length))
    columns = {
        item.name: Column(np.array(counts[i], dtype=np.int64), np.concatenate(values[i]))
        for i, item in enumerate(element.properties)
    }
    return columns, offset
