"""PNG files of eight bits, written with NumPy and zlib: the same pixels are the same bytes.

Pictures and masks need only a part of the format (ISO/IEC 15948): grey, colour, colour with alpha,
and a palette. Rows of colours are filtered by the rule that the standard recommends, the minimum
sum of absolute differences.
"""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pe_core.base.errors import InputError

Bytes = NDArray[np.uint8]

MAGIC = b"\x89PNG\r\n\x1a\n"
GREY, COLOR, INDEXED, COLOR_ALPHA = 0, 2, 3, 6
"""Colour types."""
TYPES = {1: GREY, 3: COLOR, 4: COLOR_ALPHA}
"""By channels."""
LEVEL = 7
"""9 takes three times as long for a hundredth less."""
PALETTE = 256
"""Colours of a palette at most."""


def png_bytes(pixels: Bytes, palette: Bytes | None = None) -> bytes:
    """Return a picture as a PNG file.

    Parameters
    ----------
    pixels : (H, W), (H, W, 3) or (H, W, 4) uint8
        Grey, sRGB, or sRGB with alpha, the top row first; with a palette (H, W) indices into it.
    palette : (N, 3) uint8, optional
        At most 256 colours.

    Raises
    ------
    InputError
        When the pixels have another shape or type, or there are none.
    """
    rows = _checked(pixels)
    kind = TYPES[rows.shape[2]] if palette is None else INDEXED
    colors = None if palette is None else _checked_palette(palette, rows)
    height, width = rows.shape[:2]
    head = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    lines = _filtered(rows) if kind in (COLOR, COLOR_ALPHA) else _plain(rows)
    chunks = [_chunk(b"IHDR", head)]
    if colors is not None:
        chunks.append(_chunk(b"PLTE", colors.tobytes()))
    chunks += [_chunk(b"IDAT", zlib.compress(lines.tobytes(), LEVEL)), _chunk(b"IEND", b"")]
    return MAGIC + b"".join(chunks)


def as_bytes(colors: ArrayLike) -> Bytes:
    """Convert colours from 0 to 1, of any shape, to the integers of a file, 0 to 255."""
    return np.round(np.clip(np.asarray(colors, float), 0.0, 1.0) * 255.0).astype(np.uint8)


def _checked(pixels: Bytes) -> Bytes:
    """Return pixels as (H, W, channels), or raise `InputError`."""
    shaped = np.asarray(pixels)
    rows = shaped[..., None] if shaped.ndim == 2 else shaped
    if rows.dtype != np.uint8 or rows.ndim != 3 or rows.shape[2] not in TYPES or not rows.size:
        expected = "(H, W), (H, W, 3) or (H, W, 4) bytes"
        raise InputError("picture", "pixels", expected, f"{shaped.shape} {shaped.dtype}")
    return np.ascontiguousarray(rows)


def _checked_palette(palette: Bytes, rows: Bytes) -> Bytes:
    colors = np.asarray(palette)
    fits = colors.dtype == np.uint8 and colors.ndim == 2 and colors.shape[1] == 3
    if not fits or not 0 < len(colors) <= PALETTE or rows.shape[2] != 1:
        expected = f"(N, 3) bytes, N at most {PALETTE}, and indices (H, W)"
        raise InputError("picture", "palette", expected, f"{colors.shape} {colors.dtype}")
    if int(rows.max()) >= len(colors):
        raise InputError("picture", "pixels", f"indices below {len(colors)}", int(rows.max()))
    return np.ascontiguousarray(colors)


def _plain(rows: Bytes) -> Bytes:
    """Rows without a filter, each after the number of that filter."""
    return np.pad(rows.reshape(len(rows), -1), ((0, 0), (1, 0)))


def _filtered(rows: Bytes) -> Bytes:
    """Rows with the best filter of each, after the number of the filter."""
    tried = np.stack([line.reshape(len(rows), -1) for line in _filters(rows)])
    size = np.abs(tried.view(np.int8).astype(np.int16)).sum(axis=2, dtype=np.int64)
    best = np.argmin(size, axis=0)
    lines = tried[best, np.arange(len(rows))]
    return np.concatenate([best.astype(np.uint8)[:, None], lines], axis=1)


def _filters(rows: Bytes) -> list[Bytes]:
    """All five filters of pixels (H, W, channels), by number."""
    before = np.pad(rows, ((1, 0), (1, 0), (0, 0)))
    left, up, corner = before[1:, :-1], before[:-1, 1:], before[:-1, :-1]
    a, b, c = (side.astype(np.int16) for side in (left, up, corner))
    mean = ((a + b) // 2).astype(np.uint8)
    return [rows, rows - left, rows - up, rows - mean, rows - _paeth(a, b, c)]


def _paeth(a: NDArray, b: NDArray, c: NDArray) -> Bytes:
    """Of left, up and upper left, the value nearest to ``a + b - c``; the first one of a tie."""
    to_a, to_b, to_c = np.abs(b - c), np.abs(a - c), np.abs(a + b - 2 * c)
    nearest = np.where((to_a <= to_b) & (to_a <= to_c), a, np.where(to_b <= to_c, b, c))
    return nearest.astype(np.uint8)


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
