"""PNG files of eight bits, written with NumPy and zlib: the same pixels are the same bytes.
Pictures and masks need only a part of the format (ISO/IEC 15948): grey, colour, colour with alpha.
Rows of colours are filtered by the rule that the standard recommends, the minimum sum of absolute
differences."""

import struct
import zlib

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pe_core.base.errors import InputError

Bytes = NDArray[np.uint8]

MAGIC = b"\x89PNG\r\n\x1a\n"
TYPES = {1: 0, 3: 2, 4: 6}  # Colour types by channels: grey, colour, colour with alpha
LEVEL = 7  # 9 takes three times as long for a hundredth less


def png_bytes(pixels: Bytes) -> bytes:
    """Return pixels (H, W), (H, W, 3) or (H, W, 4) as a PNG file, the top row first. They are grey,
    sRGB, or sRGB with alpha. `InputError` for another shape or type, or no pixels."""
    shaped = np.asarray(pixels)
    rows = shaped[..., None] if shaped.ndim == 2 else shaped
    if rows.dtype != np.uint8 or rows.ndim != 3 or rows.shape[2] not in TYPES or not rows.size:
        expected = "(H, W), (H, W, 3) or (H, W, 4) bytes"
        raise InputError("picture", "pixels", expected, f"{shaped.shape} {shaped.dtype}")
    height, width, channels = rows.shape
    head = struct.pack(">IIBBBBB", width, height, 8, TYPES[channels], 0, 0, 0)
    if channels == 1:  # each row after the number of its filter: none
        lines = np.pad(rows.reshape(height, -1), ((0, 0), (1, 0)))
    else:
        lines = _filtered(np.ascontiguousarray(rows))
    data = zlib.compress(lines.tobytes(), LEVEL)
    chunks = (_chunk(b"IHDR", head), _chunk(b"IDAT", data), _chunk(b"IEND", b""))
    return MAGIC + b"".join(chunks)


def as_bytes(colors: ArrayLike) -> Bytes:
    """Convert colours from 0 to 1, of any shape, to the integers of a file, 0 to 255."""
    return np.round(np.clip(np.asarray(colors, float), 0.0, 1.0) * 255.0).astype(np.uint8)


def _filtered(rows: Bytes) -> Bytes:
    """Rows of pixels (H, W, channels) with the best filter of each, after the filter's number."""
    before = np.pad(rows, ((1, 0), (1, 0), (0, 0)))
    left = before[1:, :-1]
    up = before[:-1, 1:]
    corner = before[:-1, :-1]
    a, b, c = (side.astype(np.int16) for side in (left, up, corner))
    mean = ((a + b) // 2).astype(np.uint8)
    # Paeth: of left, up and upper left the nearest to a + b - c; the first one of a tie.
    to_a = np.abs(b - c)
    to_b = np.abs(a - c)
    to_c = np.abs(a + b - 2 * c)
    nearest = np.where((to_a <= to_b) & (to_a <= to_c), a, np.where(to_b <= to_c, b, c))
    filters = [rows, rows - left, rows - up, rows - mean, rows - nearest.astype(np.uint8)]
    tried = np.stack([line.reshape(len(rows), -1) for line in filters])
    size = np.abs(tried.view(np.int8).astype(np.int16)).sum(axis=2, dtype=np.int64)
    best = np.argmin(size, axis=0)
    lines = tried[best, np.arange(len(rows))]
    return np.concatenate([best.astype(np.uint8)[:, None], lines], axis=1)


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
