"""Wavefront OBJ: a tolerant reader and an exact writer."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError, require_memory
from pe_core.base.files import decode_text
from pe_core.scene.mesh import Mesh

from .mesh import TEXT_UNFOLDS, fan, fan_size, gathered, make_mesh, require_room
from .obj_blocks import ObjContent, regular_statements


@dataclass(slots=True)
class _Statements:
    """Content of the lines: the corners of all faces in one list, with their vertices and lines."""

    points: list[float] = field(default_factory=list)
    point_lines: list[int] = field(default_factory=list)
    corners: list[int] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    labels: list[int] = field(default_factory=list)
    face_lines: list[int] = field(default_factory=list)


def read_obj(path: Path, data: bytes) -> Mesh:
    """Read the faces of an OBJ file; coordinates are metres in the ground frame.

    Parts are the `o` names, or the `g` names of a file without `o`. Faces before the first name
    belong to a part with the file's stem as its name. A name is all of the rest of its line.
    Polygons are cut into fans; faces of two vertices are ignored. Errors name the line.
    """
    source = str(path)
    if b"\0" in data:
        raise InputError(source, "file", "OBJ text", "binary data")
    require_memory(source, "file", len(data) * TEXT_UNFOLDS)
    return _read_blocks(path, data) or _read_lines(path, data)


def _read_blocks(path: Path, data: bytes) -> Mesh | None:
    """Read a regular file in blocks; None if it has to be read line by line."""
    content = regular_statements(data)
    if content is None or not content.corners.size:
        return None
    if not 0 <= int(content.corners.min()) <= int(content.corners.max()) < len(content.points):
        return None
    source = str(path)
    require_room(source, fan_size(content.counts))
    names = {path.stem: 0}
    labels = _labels(content, names)
    if (content.counts == 3).all():
        corners = content.corners.reshape(-1, 3)
    else:
        positions, faces = fan(content.counts)
        corners, labels = content.corners[positions], labels[faces]
    return make_mesh(source, gathered(content.points, corners), labels, list(names))


def _labels(content: ObjContent, names: dict[str, int]) -> NDArray[np.int32]:
    """The part of each face, from the names in the other lines; `names` gets new names."""
    # All lines together: a single letter can show how the file is encoded.
    lines = decode_text(b"".join(content.others)).split("\n")
    keyword = "o" if any(line.split(None, 1)[:1] == ["o"] for line in lines) else "g"
    labels = np.zeros(len(content.counts), np.int32)
    for line, first in zip(lines, content.before.tolist(), strict=False):
        if line.split(None, 1)[:1] == [keyword]:
            name = line.strip()[1:].strip()
            labels[first:] = names.setdefault(name, len(names)) if name else 0
    return labels


def _read_lines(path: Path, data: bytes) -> Mesh:
    """Read any file line by line: the reference for `_read_blocks`, and the source of errors."""
    source = str(path)
    lines = _logical_lines(decode_text(data))
    keyword = "o" if any(line.split(None, 1)[:1] == ["o"] for line in lines) else "g"
    names = {path.stem: 0}
    scan = _scan(source, lines, keyword, names)
    _check(source, lines, scan)
    points = np.array(scan.points, dtype=np.float64).reshape(-1, 3)
    counts = np.array(scan.counts, dtype=np.int64)
    require_room(source, fan_size(counts))
    corners, faces = fan(counts)
    triangles = points[np.array(scan.corners, dtype=np.int64)[corners]]
    return make_mesh(source, triangles, np.array(scan.labels, dtype=np.int32)[faces], list(names))


def dump_obj(path: Path, mesh: Mesh) -> bytes:
    """Return the OBJ text: shared vertices, shortest exact floats, triangles in their order.

    A part name that an `o` line cannot hold raises `InputError`.
    """
    for name in mesh.part_names:
        whole = name.encode("utf-8", "ignore").decode() == name  # no lone surrogates
        plain = not set(name) & set("\0\r\n") and not name.endswith("\\")
        if not (whole and plain and name and name == name.strip()):
            raise InputError(str(path), "part_names", "names that fit on one line", repr(name))
    # Vertices are compared by bits: as floats, 0.0 and -0.0 would be equal.
    index: dict[tuple[int, ...], int] = {}
    corners = np.ascontiguousarray(mesh.triangles).view(np.int64).reshape(-1, 3).tolist()
    order = [index.setdefault(tuple(corner), len(index) + 1) for corner in corners]
    points = np.array(list(index), dtype=np.int64).view(np.float64).tolist()
    lines = ["# metres, x forward, y left, z up"]
    lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in points]
    if list(dict.fromkeys(mesh.parts.tolist())) != list(range(len(mesh.part_names))):
        lines += [f"o {name}" for name in mesh.part_names]  # keeps the order of the parts
    last = -1
    for face, part in enumerate(mesh.parts.tolist()):
        if part != last:
            lines.append(f"o {mesh.part_names[part]}")
            last = part
        lines.append("f {} {} {}".format(*order[3 * face : 3 * face + 3]))
    return ("\n".join(lines) + "\n").encode()


def _logical_lines(text: str) -> list[str]:
    """Lines with continuations joined; empty lines replace the joined ones, to keep numbers."""
    lines = text.split("\n")
    if "\\" not in text:
        return lines
    first = 0
    while first < len(lines):
        last = first
        while last + 1 < len(lines) and _goes_on(lines[last]):
            last += 1
        if last > first:
            pieces = [line[:-1] for line in lines[first:last]]
            lines[first] = " ".join([*pieces, lines[last]])
            lines[first + 1 : last + 1] = [""] * (last - first)
        first = last + 1
    return lines


def _goes_on(line: str) -> bool:
    # A comment may end with a Windows path, whose backslash must not join the next line.
    return line.endswith("\\") and not line.lstrip().startswith("#")


def _scan(source: str, lines: list[str], keyword: str, names: dict[str, int]) -> _Statements:
    scan = _Statements()
    label = 0
    for number, line in enumerate(lines, 1):
        words = line.split()
        kind = words[0] if words else ""
        try:
            if kind == "v":
                x, y, z = map(float, words[1:4])
                scan.points += (x, y, z)
                scan.point_lines.append(number)
            elif kind == "f":
                _scan_face(scan, line)
                scan.labels.append(label)
                scan.face_lines.append(number)
            elif kind == keyword:
                name = line.strip()[1:].strip()
                label = names.setdefault(name, len(names)) if name else 0
        except ValueError as error:
            expected = "v with three numbers" if kind == "v" else "f with vertex indices"
            raise InputError(source, f"line {number}", expected, _quote(line)) from error
    return scan


def _scan_face(scan: _Statements, line: str) -> None:
    words = line.partition("#")[0].split()
    point_count = len(scan.points) // 3
    for word in words[1:]:
        i = int(word.partition("/")[0])
        # Indices from 0; index 0 and relative indices that reach too far back become negative.
        scan.corners.append(i - 1 if i > 0 else point_count + i if i < 0 else -1)
    scan.counts.append(len(words) - 1)


def _check(source: str, lines: list[str], scan: _Statements) -> None:
    total = len(scan.point_lines)
    # Python's min and max, because an index can be too large for a NumPy integer.
    if scan.corners and not 0 <= min(scan.corners) <= max(scan.corners) < total:
        bad = next(k for k, i in enumerate(scan.corners) if not 0 <= i < total)
        number = scan.face_lines[int(np.searchsorted(np.cumsum(scan.counts), bad, side="right"))]
        expected = f"vertex indices within the {total} vertices"
        raise InputError(source, f"line {number}", expected, _quote(lines[number - 1]))
    wild = np.flatnonzero(~np.isfinite(np.array(scan.points, dtype=np.float64)))
    if wild.size:
        number = scan.point_lines[int(wild[0]) // 3]
        raise InputError(source, f"line {number}", "finite numbers", _quote(lines[number - 1]))


def _quote(line: str) -> str:
    text = " ".join(line.split())
    return repr(text if len(text) <= 60 else text[:57] + "...")
