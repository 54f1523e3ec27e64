"""Stanford PLY: text and binary, with faces of any polygons."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError, require_name
from pe_core.scene.mesh import Mesh

from .mesh import make_mesh, mesh_notes, require_room
from .polygons import triangle_count, triangulate
from .whole_numbers import refusing_unread_text

MAX_HEADER_BYTES = 1 << 20
END = b"end_header"
ASCII = "ascii"
ORDERS = {ASCII: "", "binary_little_endian": "<", "binary_big_endian": ">"}
TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"}
TYPES |= {"float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2"}
TYPES |= {"uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"}
CORNERS = ("vertex_indices", "vertex_index")
POINTS = "vertex"
FACES = "face"
SKIPPED = {"edge": "edge", "tristrips": "set of triangle strips"}
"""Elements with geometry that is no polygon, and what it is."""


@dataclass(frozen=True, slots=True)
class _Property:
    """A property: its type, and of a list the type of its length."""

    name: str
    type: str
    length_type: str = ""


@dataclass(frozen=True, slots=True)
class _Element:
    name: str
    count: int
    properties: list[_Property]


@dataclass(frozen=True, slots=True)
class _PlyBody:
    """The values behind the header: numbers of text, or bytes in an order ("<", ">")."""

    source: str
    values: NDArray[Any]
    order: str

    def size(self, type_name: str) -> int:
        """Items that a value takes."""
        return np.dtype(type_name).itemsize if self.order else 1

    def take(self, type_name: str, starts: NDArray[np.int64]) -> NDArray[Any]:
        """Values of a type that begin at some items."""
        size = self.size(type_name)
        if len(starts) and int(starts.max()) + size > len(self.values):
            raise InputError(self.source, "file", "a whole .ply file", "an end in its elements")
        if not self.order:
            return self.values[starts]
        if len(starts) > 1 and (np.diff(starts) == starts[1] - starts[0]).all():
            return self._evenly_spaced(type_name, starts)
        items = self.values[starts[:, None] + np.arange(size)]
        return np.ascontiguousarray(items).view(self.order + type_name)[:, 0]

    def _evenly_spaced(self, type_name: str, starts: NDArray[np.int64]) -> NDArray[Any]:
        """Values of a type that begin at items of equal distances."""
        spaced: NDArray[Any] = np.ndarray(
            shape=(len(starts),),
            dtype=self.order + type_name,
            buffer=self.values,
            offset=int(starts[0]),
            strides=(int(starts[1] - starts[0]),),
        )
        return np.array(spaced)

    def length(self, type_name: str, start: int) -> int:
        """The length of a list that begins at an item."""
        if not self.order:
            return self._checked(float(self.values[start])) if start < len(self.values) else 0
        raw = self.values[start : start + self.size(type_name)].tobytes()
        return int.from_bytes(raw, "little" if self.order == "<" else "big")

    def lengths(self, type_name: str, starts: NDArray[np.int64]) -> NDArray[np.int64]:
        """The lengths of lists that begin at some items."""
        lengths = self.take(type_name, starts)
        for length in np.unique(lengths).tolist():
            self._checked(length)
        return lengths.astype(np.int64)

    def _checked(self, length: float) -> int:
        """The length of a list: a whole number of items that the file may have."""
        if not 0 <= length <= len(self.values) or length != int(length):
            expected = "lists of whole lengths that end in the file"
            raise InputError(self.source, "file", expected, f"a length of {length:g}")
        return int(length)


def read_ply(path: Path, data: bytes) -> Mesh:
    """Read the faces of a PLY file in its own axes, in metres; they are one part with the file's
    stem as its name. Other elements than vertices and faces are skipped."""
    source = str(path)
    elements, body = _header(source, data)
    start = 0
    columns: dict[str, dict[str, Any]] = {}
    skipped: Counter[str] = Counter()
    for element in elements:
        starts, start = _starts(body, element, start)
        columns.setdefault(element.name, {}).update(
            (each.name, (each, starts[:, k])) for k, each in enumerate(element.properties)
        )
        if element.name in SKIPPED:
            skipped[SKIPPED[element.name]] += element.count
    points = _points(body, columns.get(POINTS, {}))
    corners, counts = _polygons(body, columns.get(FACES, {}))
    if corners.size and not 0 <= int(corners.min()) <= int(corners.max()) < len(points):
        found = f"{corners.min()} to {corners.max()}"
        raise InputError(source, "faces", f"indices within the {len(points)} vertices", found)
    require_room(source, triangle_count(counts))
    cut = triangulate(source, points[corners], counts)
    notes = mesh_notes(skipped, counts, cut.crossing)
    return make_mesh(source, cut.triangles, np.zeros_like(cut.polygons), [path.stem], notes=notes)


def _header(source: str, data: bytes) -> tuple[list[_Element], _PlyBody]:
    """The elements, and what is behind the header."""
    end = data.find(END, 0, MAX_HEADER_BYTES)
    begin = data.find(b"\n", end) + 1
    if not data.startswith(b"ply") or end < 0 or begin == 0:
        raise InputError(source, "header", "ply ... end_header", data[:20])
    elements: list[_Element] = []
    kind = ""
    for line in data[:end].decode("latin-1").splitlines():
        match line.split():
            case ["format", kind, _]:
                require_name(source, "format", kind, ORDERS)
            case ["element", name, count] if count.isdecimal() and len(count) < 16:
                elements.append(_Element(name, int(count), []))
            case ["property", "list", length, of, name] if elements:
                elements[-1].properties.append(
                    _Property(name, _type(source, of), _type(source, length))
                )
            case ["property", of, name] if elements:
                elements[-1].properties.append(_Property(name, _type(source, of)))
            case ["element" | "property", *_]:
                raise InputError(source, "header", "an element with properties", line)
    order = ORDERS.get(kind, "")
    if not kind:
        raise InputError(source, "format", "one of " + ", ".join(ORDERS), "none")
    return elements, _PlyBody(source, _values(source, data[begin:], order), order)


def _type(source: str, name: str) -> str:
    require_name(source, "header", name, TYPES)
    return TYPES[name]


def _values(source: str, data: bytes, order: str) -> NDArray[Any]:
    if order:
        return np.frombuffer(data, np.uint8)
    try:
        with refusing_unread_text():
            return np.fromstring(data, sep=" ") if data.strip() else np.zeros(0)
    except (DeprecationWarning, ValueError) as error:
        raise InputError(source, "file", "numbers behind the header", str(error)) from error


def _starts(body: _PlyBody, element: _Element, at: int) -> tuple[NDArray[np.int64], int]:
    """Where each property (R, K) of each row begins, of a list its length; and where all end."""
    least = sum(body.size(each.length_type or each.type) for each in element.properties)
    if element.count * max(least, 1) > len(body.values) - at:
        found = f"{element.count:,} of {element.name}"
        raise InputError(body.source, "file", "as many elements as the header names", found)
    if not element.count:
        return np.zeros((0, len(element.properties)), np.int64), at
    rows = np.arange(element.count)
    first, end = _row(body, element, at)
    even = np.array(first)[None, :] + (rows * (end - at))[:, None]
    lists = [k for k, each in enumerate(element.properties) if each.length_type]
    if not lists:
        return even, at + element.count * (end - at)
    if int(even[-1, -1]) < len(body.values):
        lengths = [_lengths(body, element.properties[k], even[:, k]) for k in lists]
        if all((each == each[0]).all() for each in lengths):
            return even, at + element.count * (end - at)
    for row in range(element.count):
        even[row], at = _row(body, element, at)
    return even, at


def _lengths(body: _PlyBody, of: _Property, starts: NDArray[np.int64]) -> NDArray[Any]:
    """The lengths of lists that would begin at some items, where it is not sure that they do."""
    whole = starts + body.size(of.length_type) <= len(body.values)
    return body.take(of.length_type, starts[whole])


def _row(body: _PlyBody, element: _Element, at: int) -> tuple[list[int], int]:
    """Where each property of the row at an item begins, and where the row ends."""
    begins = []
    for each in element.properties:
        begins.append(at)
        if each.length_type:
            size = body.size(each.length_type) + body.length(each.length_type, at) * body.size(
                each.type
            )
        else:
            size = body.size(each.type)
        at += size
        if at > len(body.values):
            found = f"an end in {element.name}"
            raise InputError(body.source, "file", "a whole .ply file", found)
    return begins, at


def _points(body: _PlyBody, columns: dict[str, Any]) -> NDArray[np.float64]:
    if not {"x", "y", "z"} <= columns.keys():
        raise InputError(body.source, "header", "vertices with x, y and z", ", ".join(columns))
    axes = [body.take(columns[axis][0].type, columns[axis][1]) for axis in "xyz"]
    return np.stack(axes, axis=1).astype(np.float64)


def _polygons(
    body: _PlyBody, columns: dict[str, Any]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The corners of all faces in one list, and how many each face has."""
    name = next((each for each in CORNERS if each in columns), None)
    if name is None or not columns[name][0].length_type:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    of, starts = columns[name]
    counts = body.lengths(of.length_type, starts)
    if len(counts) and (counts == counts[0]).all():
        first = starts + body.size(of.length_type)
        steps = range(int(counts[0]))
        apart = [body.take(of.type, first + step * body.size(of.type)) for step in steps]
        return _whole(body, np.stack(apart, axis=1).ravel()) if apart else counts[:0], counts
    within = np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)
    firsts = np.repeat(starts + body.size(of.length_type), counts)
    corners = body.take(of.type, firsts + within * body.size(of.type))
    return _whole(body, corners), counts


def _whole(body: _PlyBody, corners: NDArray[Any]) -> NDArray[np.int64]:
    whole: NDArray[np.int64] = corners.astype(np.int64)
    if (whole != corners).any():
        raise InputError(body.source, "faces", "whole numbers", float(corners[whole != corners][0]))
    return whole
