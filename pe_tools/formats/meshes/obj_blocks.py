"""Regular OBJ files, as programs write them, read in blocks of bytes instead of line by line.

In a regular file, vertices are ``v`` and numbers, faces are ``f`` and indices from 1, and every
statement begins in the first column. `regular_statements` returns all other lines to the caller.
"""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Offsets = NDArray[np.int64]

NEWLINE, BLANK = b"\n"[0], b" "[0]
MAX_INDEX_DIGITS = 18
"""Maximum digits of an index that always fit in 64 bits."""
POINT_LETTERS = np.isin(np.arange(256), list(b"v 0123456789+-.eE\n"))
LETTER, SPACE, SLASH, DIGIT = 1, 2, 3, 4
FACE_LETTERS = np.zeros(256, np.uint8)
for _sort, _letters in ((LETTER, b"f"), (SPACE, b" \n"), (SLASH, b"/"), (DIGIT, b"0123456789")):
    FACE_LETTERS[list(_letters)] = _sort


class ObjContent(NamedTuple):
    """Content of a file: points, the corners of all faces in one list, the number of each face.

    Corners are indices from 0. `others` are all other lines, `before` the number of faces before
    each of them.
    """

    points: NDArray[np.float64]
    corners: Offsets
    counts: Offsets
    others: list[bytes]
    before: Offsets


class _Block(NamedTuple):
    """The joined bytes of some lines, and the position of each line's newline."""

    text: Bytes
    ends: Offsets


def regular_statements(data: bytes) -> ObjContent | None:
    """Return the content of a file; None if it has to be read line by line."""
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n")
    if b"\\" in data or b"\r" in data or not data:
        return None
    text = np.frombuffer(data if data.endswith(b"\n") else data + b"\n", np.uint8)
    ends = np.flatnonzero(text == NEWLINE)
    starts = np.concatenate([[0], ends[:-1] + 1])
    first, second = text[starts], text[np.minimum(starts + 1, len(text) - 1)]
    is_point, is_face = ((first == ord(k)) & (second == BLANK) for k in "vf")
    points = _points(_block(text, starts, ends, is_point))
    faces = _faces(_block(text, starts, ends, is_face))
    if points is None or faces is None:
        return None
    skipped = (first == ord("v")) & ((second == ord("n")) | (second == ord("t")))
    is_other = ~(is_point | is_face | skipped)
    lines = zip(starts[is_other], ends[is_other], strict=True)
    others = [text[a : b + 1].tobytes() for a, b in lines]
    # A vertex or a face with an unusual beginning is for the reader of lines.
    if any(line.split(None, 1)[:1] in ([b"v"], [b"f"]) for line in others):
        return None
    return ObjContent(points, *faces, others, np.cumsum(is_face)[is_other])


def _block(text: Bytes, starts: Offsets, ends: Offsets, is_member: NDArray[np.bool_]) -> _Block:
    """Return the lines of one sort, which come in runs."""
    edges = np.flatnonzero(np.diff(is_member.view(np.int8), prepend=0, append=0))
    runs = [text[starts[a] : ends[b - 1] + 1] for a, b in edges.reshape(-1, 2).tolist()]
    sizes = (ends - starts)[is_member] + 1
    return _Block(np.concatenate([text[:0], *runs]), np.cumsum(sizes) - 1)


def _points(block: _Block) -> NDArray[np.float64] | None:
    """Points (N, 3) of lines with equally many numbers: three, or more, which are ignored."""
    text, ends = block
    if not len(ends) or not POINT_LETTERS[text].all():
        return None
    if np.count_nonzero(text == ord("v")) != len(ends):
        return None
    begins = np.flatnonzero((text[:-1] == BLANK) & (text[1:] > BLANK)) + 1
    columns = len(begins) // len(ends)
    if columns < 3 or not _each_has(columns, begins, ends):
        return None
    blank = np.where(text == ord("v"), np.uint8(BLANK), text)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            numbers = np.fromstring(blank.tobytes(), sep=" ")
        except (DeprecationWarning, ValueError):  # a word is not a number
            return None
    if len(numbers) != len(begins) or not np.isfinite(numbers).all():
        return None
    return np.ascontiguousarray(numbers.reshape(-1, columns)[:, :3])


def _each_has(count: int, begins: Offsets, ends: Offsets) -> bool:
    """Whether each line (by `ends`) has `count` words (by `begins`)."""
    if count < 1 or len(begins) != count * len(ends):
        return False
    last, following = begins[count - 1 :: count], begins[count::count]
    return bool((last < ends).all()) and bool((following > ends[:-1]).all())


def _faces(block: _Block) -> tuple[Offsets, Offsets] | None:
    """The corners of all faces in one list, from 0, and the number of corners of each face."""
    text, ends = block
    sort = FACE_LETTERS[text]
    if not len(ends) or not sort.all() or np.count_nonzero(sort == LETTER) != len(ends):
        return None
    is_digit = sort == DIGIT
    begins, stops = (np.flatnonzero(is_digit[1:] != is_digit[:-1]) + 1).reshape(-1, 2).T
    leads = sort[begins - 1] == SPACE  # the first number of a corner: the vertex
    if ((sort[1:] == SLASH) & (sort[:-1] == SPACE)).any():
        return None  # a corner begins with a slash
    begins, stops = begins[leads], stops[leads]
    if len(begins) and int((stops - begins).max()) > MAX_INDEX_DIGITS:
        return None
    if _each_has(3, begins, ends):
        counts = np.full(len(ends), 3)
    else:
        counts = np.diff(np.searchsorted(begins, ends), prepend=0)
    return _whole_numbers(text, begins, stops) - 1, counts


def _whole_numbers(text: Bytes, begins: Offsets, stops: Offsets) -> Offsets:
    """Parse integers with the digits from `begins` to before `stops`."""
    values = np.zeros(len(begins), np.int64)
    digit_counts = (stops - begins).astype(np.int8)
    for power in range(int(digit_counts.max(initial=0))):
        digits = text[stops - (1 + power)] - np.uint8(ord("0"))
        if power >= int(digit_counts.min()):
            digits *= digit_counts > power  # beyond the end of shorter numbers
        values += np.multiply(digits, 10**power, dtype=np.int64)
    return values
