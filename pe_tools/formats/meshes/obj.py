"""Wavefront OBJ: faces of any polygons, with the names of objects or groups."""

import re
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text
from pe_core.scene.mesh import Mesh

from .mesh import make_mesh, mesh_notes, require_room
from .polygons import triangle_count, triangulate
from .whole_numbers import refusing_unread_text

VERTEX = b"v "
FACE = b"f "
OBJECT = b"o"
GROUP = b"g"
SKIPPED = {b"l": "line", b"p": "point", b"curv": "curve", b"curv2": "curve", b"surf": "surface"}
"""Statements with geometry that is no polygon, and what it is."""
COMMENT_LINE = re.compile(rb"^[ \t]*#.*", re.MULTILINE)
AFTER_SLASH = re.compile(rb"/\S*")
MAX_QUOTE = 60


def read_obj(path: Path, data: bytes) -> Mesh:
    """Read the faces of an OBJ file in its own axes, in metres.

    Parts are the `o` names, or the `g` names of a file without `o`; a name is all of the rest of
    its line. Faces before the first name belong to a part with the file's stem as its name.
    Indices that count backwards are those of the vertices so far.
    """
    source = str(path)
    if b"\0" in data:
        raise InputError(source, "file", "OBJ text", "binary data")
    lines = _statements(data)
    heads = np.array([line[: len(VERTEX)] for line in lines], f"S{len(VERTEX)}")
    is_vertex = heads == VERTEX
    is_face = heads == FACE
    others = np.flatnonzero(~(is_vertex | is_face)).tolist()
    points = _points(source, [lines[k] for k in np.flatnonzero(is_vertex)])
    faces = [lines[k] for k in np.flatnonzero(is_face)]
    corners, counts = _numbers(source, faces, np.dtype(np.int64), "f with vertex indices")
    vertices_so_far = np.repeat(np.cumsum(is_vertex)[is_face], counts)
    corners = np.where(corners < 0, corners + vertices_so_far, corners - 1)
    wrong = np.flatnonzero((corners < 0) | (corners >= len(points)))
    if len(wrong):
        face = faces[int(np.searchsorted(np.cumsum(counts), wrong[0], side="right"))]
        expected = f"vertex indices within the {len(points)} vertices"
        raise InputError(source, "faces", expected, _quote(face))
    require_room(source, triangle_count(counts))
    found = triangulate(source, points[corners], counts)
    names, labels = _labels(path.stem, lines, others, is_face)
    words = _other_words([lines[row] for row in others])
    skipped = Counter(SKIPPED[word] for word in words if word in SKIPPED)
    notes = mesh_notes(skipped, counts, found.crossing)
    return make_mesh(source, found.triangles, labels[found.polygons], names, notes=notes)


def _statements(data: bytes) -> list[bytes]:
    """The lines without tabs, blanks in front, and comments behind numbers. Lines that go on
    behind a backslash are joined; a comment may end with one, of a path of Windows."""
    data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\t", b" ")
    if b"\\\n" in data:
        data = COMMENT_LINE.sub(b"", data).replace(b"\\\n", b" ")
    lines = data.removeprefix(b"\xef\xbb\xbf").split(b"\n")
    if data.startswith(b" ") or b"\n " in data:
        lines = [line.lstrip() for line in lines]
    if b"#" in data:
        numeric = (VERTEX, FACE)
        lines = [x.partition(b"#")[0] if x.startswith(numeric) else x for x in lines]
    return lines


def _points(source: str, lines: list[bytes]) -> NDArray[np.float64]:
    """The points (N, 3); further numbers of a line, its colour or weight, are ignored."""
    expected = "v with three numbers"
    numbers, counts = _numbers(source, lines, np.dtype(float), expected)
    short = np.flatnonzero(counts < 3)
    if len(short):
        raise InputError(source, "file", expected, _quote(lines[short[0]]))
    firsts = np.cumsum(counts) - counts
    points: NDArray[np.float64] = numbers[firsts[:, None] + np.arange(3)]
    return points


def _numbers(
    source: str, lines: list[bytes], dtype: np.dtype[Any], expected: str
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """The numbers of all lines in one list, and how many each line has."""
    counts = np.array([len(line.split()) for line in lines], np.int64) - 1
    text = b" ".join([line[len(VERTEX) :] for line in lines])
    if b"/" in text:
        text = AFTER_SLASH.sub(b"", text)
    if not counts.any():
        return np.zeros(0, dtype), counts
    try:
        with refusing_unread_text():
            numbers = np.fromstring(text, dtype, sep=" ")
    except (DeprecationWarning, ValueError):
        numbers = np.zeros(0, dtype)
    if len(numbers) != int(counts.sum()):
        wrong = next((line for line in lines if not _is_numeric(line, dtype)), lines[0])
        raise InputError(source, "file", expected, _quote(wrong))
    return numbers, counts


def _is_numeric(line: bytes, dtype: np.dtype[Any]) -> bool:
    kind = float if dtype.kind == "f" else int
    try:
        return all(kind(word.partition(b"/")[0]) is not None for word in line.split()[1:])
    except ValueError:
        return False


def _labels(
    stem: str, lines: list[bytes], others: list[int], is_face: NDArray[np.bool_]
) -> tuple[list[str], NDArray[np.int32]]:
    """Names of the parts, and the part of each face. `others` are the rows that are neither a
    vertex nor a face."""
    rows: dict[bytes, list[int]] = {OBJECT: [], GROUP: []}
    for row in others:
        line = lines[row]
        if line[:1] in rows and line[1:2] in (b" ", b""):
            rows[line[:1]].append(row)
    begins = rows[OBJECT] or rows[GROUP]
    # All names together: a single letter can show how the file is encoded.
    texts = decode_text(b"\n".join(lines[row][1:] for row in begins)).split("\n")
    names = {stem: 0}
    labels = np.zeros(int(np.count_nonzero(is_face)), np.int32)
    faces_before = np.cumsum(is_face)
    for row, text in zip(begins, texts, strict=False):
        name = text.strip()
        labels[faces_before[row] :] = names.setdefault(name, len(names)) if name else 0
    return list(names), labels


def _other_words(lines: list[bytes]) -> list[bytes]:
    """The first word of each statement that is no vertex, its normal or texture, and no face."""
    return [line.split(None, 1)[0] for line in lines if line[:1] not in (b"v", b"f", b"", b"#")]


def _quote(line: bytes) -> str:
    text = " ".join(line.decode("latin-1").split())
    return repr(text if len(text) <= MAX_QUOTE else f"{text[: MAX_QUOTE - 3]}...")
