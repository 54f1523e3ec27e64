"""Wavefront OBJ: faces of any polygons, with the names of objects or groups."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
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
COMMENT_BEHIND = re.compile(rb"^([vf] [^#\n]*)#.*", re.MULTILINE)
BLANKS_IN_FRONT = re.compile(rb"^[ \v\f]+", re.MULTILINE)
NEWLINE = ord("\n")
BLANK = ord(" ")
SLASH = ord("/")
IS_SPACE = np.array([bytes([code]).isspace() for code in range(256)])
NO_WORDS = np.frombuffer(b"vf#\n", np.uint8)
"""What begins a vertex, its normal or texture, a face, a comment, and an empty line."""
LINES_AT_ONCE = 1 << 15
MAX_QUOTE = 60


@dataclass(frozen=True, slots=True)
class TextLines:
    """Lines of a text: `text` (N,) its bytes, `begins` and `ends` (L,) of each line in it. A line
    ends before its newline, which the last one has, too."""

    text: NDArray[np.uint8]
    begins: NDArray[np.int64]
    ends: NDArray[np.int64]

    @classmethod
    def of(cls, data: bytes) -> "TextLines":
        """Return the lines of a text that ends with a newline."""
        text = np.frombuffer(data, np.uint8)
        ends = np.flatnonzero(text == NEWLINE)
        return cls(text, np.concatenate([[0], ends[:-1] + 1])[: len(ends)], ends)

    def __len__(self) -> int:
        return len(self.ends)

    def __iter__(self) -> Iterator[bytes]:
        return (self.line(row) for row in range(len(self)))

    def line(self, row: int) -> bytes:
        """Return a line without its newline."""
        return self.text[self.begins[row] : self.ends[row]].tobytes()

    def begin_with(self, head: bytes) -> NDArray[np.bool_]:
        """Whether each line (L,) begins with two bytes, of which neither is a newline."""
        first, second = head
        after = np.minimum(self.begins + 1, len(self.text) - 1)
        begin: NDArray[np.bool_] = self.text[self.begins] == first
        return begin & (self.text[after] == second)

    def chosen(self, some: NDArray[np.bool_]) -> "TextLines":
        """Return the lines with these flags (L,). Neighbours are copied together."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], some, [False]])))
        runs = zip(self.begins[edges[::2]], self.ends[edges[1::2] - 1], strict=True)
        return TextLines.of(b"".join([self.text[a : b + 1].tobytes() for a, b in runs]))


def read_obj(path: Path, data: bytes) -> Mesh:
    """Read the faces of an OBJ file in its own axes, in metres.

    Parts are the `o` names, or the `g` names of a file without `o`; a name is all of the rest of
    its line. Faces before the first name belong to a part with the file's stem as its name.
    Indices that count backwards are those of the vertices so far.
    """
    source = str(path)
    if b"\0" in data:
        raise InputError(source, "file", "OBJ text", "binary data")
    lines = TextLines.of(_statements(data))
    is_vertex = lines.begin_with(VERTEX)
    is_face = lines.begin_with(FACE)
    points = _points(source, lines.chosen(is_vertex))
    faces = lines.chosen(is_face)
    corners, counts = _numbers(source, faces, np.dtype(np.int64), "f with vertex indices")
    vertices_so_far = np.repeat(np.cumsum(is_vertex)[is_face], counts)
    corners = np.where(corners < 0, corners + vertices_so_far, corners - 1)
    wrong = np.flatnonzero((corners < 0) | (corners >= len(points)))
    if len(wrong):
        face = faces.line(int(np.searchsorted(np.cumsum(counts), wrong[0], side="right")))
        expected = f"vertex indices within the {len(points)} vertices"
        raise InputError(source, "faces", expected, _quote(face))
    require_room(source, triangle_count(counts))
    found = triangulate(source, points[corners], counts)
    with_words = np.flatnonzero(~np.isin(lines.text[lines.begins], NO_WORDS))
    others = {row: lines.line(row) for row in with_words.tolist()}
    names, labels = _labels(path.stem, others, is_face)
    words = (line.split(None, 1)[0] for line in others.values())
    skipped = Counter(SKIPPED[word] for word in words if word in SKIPPED)
    notes = mesh_notes(skipped, counts, found.crossing)
    return make_mesh(source, found.triangles, labels[found.polygons], names, notes=notes)


def _statements(data: bytes) -> bytes:
    """The text without tabs, blanks in front, and comments behind numbers; it ends with a newline.
    Lines that go on behind a backslash are joined; a comment may end with one, of a path of
    Windows."""
    data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\t", b" ")
    if b"\\\n" in data:
        data = COMMENT_LINE.sub(b"", data).replace(b"\\\n", b" ")
    data = data.removeprefix(b"\xef\xbb\xbf") + b"\n"
    if data.startswith(b" ") or b"\n " in data:
        data = BLANKS_IN_FRONT.sub(b"", data)
    return COMMENT_BEHIND.sub(rb"\1", data) if b"#" in data else data


def _points(source: str, lines: TextLines) -> NDArray[np.float64]:
    """The points (N, 3); further numbers of a line, its colour or weight, are ignored."""
    expected = "v with three numbers"
    numbers, counts = _numbers(source, lines, np.dtype(float), expected)
    short = np.flatnonzero(counts < 3)
    if len(short):
        raise InputError(source, "file", expected, _quote(lines.line(short[0])))
    firsts = np.cumsum(counts) - counts
    points: NDArray[np.float64] = numbers[firsts[:, None] + np.arange(3)]
    return points


def _numbers(
    source: str, lines: TextLines, dtype: np.dtype[Any], expected: str
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """The numbers of all lines in one list, and how many each line has."""
    text = lines.text.copy()
    text[lines.begins] = BLANK
    counts = np.zeros(len(lines), np.int64)
    for start in range(0, len(lines), LINES_AT_ONCE):
        rows = slice(start, start + LINES_AT_ONCE)
        begins = lines.begins[rows]
        counts[rows] = _blank_behind_slashes(
            text[begins[0] : lines.ends[rows][-1] + 1], begins - begins[0]
        )
    if not counts.any():
        return np.zeros(0, dtype), counts
    try:
        with refusing_unread_text():
            numbers = np.fromstring(text.tobytes(), dtype, sep=" ")
    except (DeprecationWarning, ValueError):
        numbers = np.zeros(0, dtype)
    if len(numbers) != int(counts.sum()):
        wrong = next((line for line in lines if not _is_numeric(line, dtype)), lines.line(0))
        raise InputError(source, "file", expected, _quote(wrong))
    return numbers, counts


def _blank_behind_slashes(text: NDArray[np.uint8], begins: NDArray[np.int64]) -> NDArray[np.int64]:
    """Blank what follows the first slash of each word, in place; return the number of words of each
    line. Each line begins with a blank, at `begins` (L,)."""
    space = IS_SPACE.take(text)
    words = np.flatnonzero(space[:-1] > space[1:])
    counts = np.diff(np.searchsorted(words, begins), append=len(words))
    is_slash = text == SLASH
    if is_slash.any():
        slashes = np.cumsum(is_slash, dtype=np.int32)
        before_word = np.maximum.accumulate(np.where(space, slashes, 0))
        text[slashes > before_word] = BLANK
    return counts


def _is_numeric(line: bytes, dtype: np.dtype[Any]) -> bool:
    kind = float if dtype.kind == "f" else int
    try:
        return all(kind(word.partition(b"/")[0]) is not None for word in line.split()[1:])
    except ValueError:
        return False


def _labels(
    stem: str, others: dict[int, bytes], is_face: NDArray[np.bool_]
) -> tuple[list[str], NDArray[np.int32]]:
    """Names of the parts, and the part of each face. `others` are the lines that begin with another
    word than those of vertices and faces, by row."""
    rows: dict[bytes, list[int]] = {OBJECT: [], GROUP: []}
    for row, line in others.items():
        if line[:1] in rows and line[1:2] in (b" ", b""):
            rows[line[:1]].append(row)
    begins = rows[OBJECT] or rows[GROUP]
    # All names together: a single letter can show how the file is encoded.
    texts = decode_text(b"\n".join(others[row][1:] for row in begins)).split("\n")
    names = {stem: 0}
    labels = np.zeros(int(np.count_nonzero(is_face)), np.int32)
    faces_before = np.cumsum(is_face)
    for row, text in zip(begins, texts, strict=False):
        name = text.strip()
        labels[faces_before[row] :] = names.setdefault(name, len(names)) if name else 0
    return list(names), labels


def _quote(line: bytes) -> str:
    text = " ".join(line.decode("latin-1").split())
    return repr(text if len(text) <= MAX_QUOTE else f"{text[: MAX_QUOTE - 3]}...")
