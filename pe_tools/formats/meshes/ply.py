"""PLY: ASCII and binary of either byte order."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text
from pe_core.base.memory import require_memory
from pe_core.scene.mesh import Mesh

from .mesh import TEXT_UNFOLDS, fan, fan_size, gathered, make_mesh, require_room
from .ply_elements import Column, Element, Property, read_element

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
MAX_HEADER_BYTES = 1 << 20
_CODES = {word: code for code, words in _TYPES.items() for word in words}


def read_ply(path: Path, data: bytes) -> Mesh:
    """Read a PLY file's faces as one part with the file's stem as its name.

    Coordinates are metres in the ground frame. Polygons are cut into fans. Other elements and
    properties are ignored.

    Raises
    ------
    InputError
        The file is not PLY, or its header is malformed. Positions, faces or triangles are missing.
        A vertex index is out of range, a coordinate is not finite, or the data end too early.
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
        columns[element.name], offset = read_element(source, element, body, offset)
    points = _points(source, columns.get("vertex", {}))
    faces = _faces(source, columns.get("face", {}), len(points))
    require_room(source, fan_size(faces.counts))
    triangles = gathered(points, _corners(faces))
    return make_mesh(source, triangles, np.zeros(len(triangles), np.int32), [path.stem])


def _corners(faces: Column) -> NDArray[np.int64]:
    """Indices (T, 3) of the triangles of faces cut into fans."""
    indices = faces.values.astype(np.int64)
    if (faces.counts == 3).all():
        return indices.reshape(-1, 3)
    return indices[fan(faces.counts)[0]]


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
    if _all_within(values, points):
        return faces
    # In this form of the condition NaN is refused, too.
    bad = np.flatnonzero(~((values >= 0) & (values < points) & (values == np.floor(values))))
    if bad.size:
        row = int(np.searchsorted(np.cumsum(faces.counts), bad[0], side="right"))
        expected = f"vertex indices within the {points} vertices"
        raise InputError(source, f"face[{row}]", expected, str(values[bad[0]]))
    return faces


def _all_within(values: NDArray[Any], points: int) -> bool:
    """Whether all values are surely valid indices; may be False for some that are valid."""
    whole = values.dtype.kind in "iu" and values.size > 0
    return whole and 0 <= int(values.min()) <= int(values.max()) < points
