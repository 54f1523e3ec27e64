"""PNG files, read back by the rules of the format."""

import struct
import zlib

import numpy as np
import pytest

from pe_core import InputError
from pe_tools import graphics


def chunks(png):
    """Names and contents of a file's chunks, their sums checked."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, found = 8, []
    while at < len(png):
        (size,) = struct.unpack(">I", png[at : at + 4])
        name, data = png[at + 4 : at + 8], png[at + 8 : at + 8 + size]
        (told,) = struct.unpack(">I", png[at + 8 + size : at + 12 + size])
        assert told == zlib.crc32(name + data)
        found.append((name, data))
        at += 12 + size
    return found


def decoded(png):
    """Pixels (H, W, channels) of a file of eight bits, one byte after the other."""
    parts = dict(chunks(png))
    width, height, depth, kind, *rest = struct.unpack(">IIBBBBB", parts[b"IHDR"])
    assert depth == 8 and rest == [0, 0, 0]
    n = {0: 1, 2: 3, 3: 1, 6: 4}[kind]
    lines = np.frombuffer(zlib.decompress(parts[b"IDAT"]), np.uint8).reshape(height, -1).tolist()
    above, rows = [0] * (width * n), []
    for number, *line in lines:
        row = []
        for k, value in enumerate(line):
            left, corner = (row[k - n], above[k - n]) if k >= n else (0, 0)
            up = above[k]
            guess = left + up - corner
            nearest = min((left, up, corner), key=lambda v: abs(guess - v))
            row.append((value + (0, left, up, (left + up) // 2, nearest)[number]) % 256)
        rows.append(row)
        above = row
    return np.array(rows, np.uint8).reshape(height, width, n)


@pytest.mark.parametrize("shape", [(1, 1), (5, 7), (5, 7, 3), (6, 4, 4)])
def test_a_picture_is_read_back(shape):
    """Noise and slopes, so that every filter is taken by some row."""
    pixels = np.random.default_rng(0).integers(0, 256, shape, np.uint8)
    slope = np.add.outer(np.arange(shape[0]) * 9, np.arange(shape[1]) * 5).astype(np.uint8)
    for each in (
        pixels,
        np.broadcast_to(slope.reshape(slope.shape + (1,) * (len(shape) - 2)), shape),
    ):
        found = decoded(graphics.png_bytes(each))
        np.testing.assert_array_equal(found.reshape(shape), each)


def test_a_palette_is_kept():
    palette = np.array([[1, 2, 3], [250, 0, 9]], np.uint8)
    png = graphics.png_bytes(np.eye(3, dtype=np.uint8), palette)
    assert dict(chunks(png))[b"PLTE"] == palette.tobytes()
    np.testing.assert_array_equal(decoded(png)[..., 0], np.eye(3))


def test_what_is_no_picture_is_refused():
    palette = np.zeros((2, 3), np.uint8)
    for pixels, colors in (
        (np.zeros((3, 3)), None),
        (np.zeros((3, 3, 2), np.uint8), None),
        (np.zeros((0, 3), np.uint8), None),
        (np.full((3, 3), 2, np.uint8), palette),
        (np.zeros((3, 3, 3), np.uint8), palette),
        (np.zeros((3, 3), np.uint8), np.zeros((257, 3), np.uint8)),
    ):
        with pytest.raises(InputError, match="expected"):
            graphics.png_bytes(pixels, colors)


def test_colours_become_whole_numbers():
    found = graphics.as_bytes([-0.1, 0.0, 0.5, 1.0, 1.2])
    assert found.dtype == np.uint8 and found.tolist() == [0, 0, 128, 255, 255]
