"""The first dimensions of the Sobol' sequence, scrambled: integers only, so no bit differs.

The scrambling is Owen's, by hashing (Laine and Karras 2011; the constants are Vegdahl's, as in
Burley 2020, "Practical Hash-based Owen Scrambling"). It takes away the regularity that a pattern of
beams may be in step with, and each run of a power of two of the points remains a net.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Words = NDArray[np.uint32]

BITS = 32
WORD = (1 << BITS) - 1
PRIMITIVE = (
    (0, (1,)),
    (1, (1, 3)),
    (1, (1, 3, 1)),
    (2, (1, 1, 1)),
    (1, (1, 1, 3, 3)),
    (4, (1, 3, 5, 13)),
)
"""Of each dimension but the first, which is the van der Corput sequence: the inner coefficients of
a primitive polynomial as a number, and first direction numbers m (Joe and Kuo 2008)."""
DIMENSIONS = 1 + len(PRIMITIVE)
MASKS = ((0x55555555, 1), (0x33333333, 2), (0x0F0F0F0F, 4), (0x00FF00FF, 8), (0x0000FFFF, 16))
ODDS = (0x9E3779B9, 0x85EBCA6B, 0xC2B2AE35)
"""Tell the dimensions' seeds apart; and mix them (the last two are MurmurHash3's)."""


def scrambled_sobol(count: int, shift: Sequence[float]) -> Floats:
    """(count, D) points in [0, 1), scrambled by D numbers in [0, 1); D is 7 at most."""
    columns = [_sobol(count, dimension) for dimension in range(len(shift))]
    scrambled = [
        _scrambled(c, _seed(s, d)) for d, (c, s) in enumerate(zip(columns, shift, strict=True))
    ]
    return np.stack(scrambled, axis=1) / float(1 << BITS)


def _sobol(count: int, dimension: int) -> Words:
    """One coordinate of the points, in 32 bits."""
    points = np.zeros(count, np.uint32)
    number = np.arange(count, dtype=np.uint32)
    for bit, word in enumerate(_directions(dimension)[: max(count - 1, 1).bit_length()]):
        points ^= ((number >> np.uint32(bit)) & np.uint32(1)) * np.uint32(word)
    return points


def _directions(dimension: int) -> list[int]:
    """Direction numbers of a dimension: what each bit of a point's number adds."""
    if dimension == 0:
        return [1 << (BITS - 1 - bit) for bit in range(BITS)]
    inner, odd = PRIMITIVE[dimension - 1]
    degree = len(odd)
    words = [m << (BITS - 1 - bit) for bit, m in enumerate(odd)]
    for bit in range(degree, BITS):
        word = words[bit - degree] ^ (words[bit - degree] >> degree)
        for back in range(1, degree):
            word ^= words[bit - back] * (inner >> (degree - 1 - back) & 1)
        words.append(word)
    return words


def _seed(shift: float, dimension: int) -> int:
    """Mix a number in [0, 1) and a dimension into 32 bits."""
    seed = (int(shift * (1 << BITS)) + (dimension + 1) * ODDS[0]) & WORD
    for odd, down in ((ODDS[1], 16), (ODDS[2], 13)):
        seed = ((seed ^ (seed >> down)) * odd) & WORD
    return seed ^ (seed >> 16)


def _scrambled(points: Words, seed: int) -> Words:
    """Flip each bit by a hash of the bits above it."""
    x = _reversed(points)
    x ^= x * np.uint32(0x3D20ADEA)
    x += np.uint32(seed)
    x *= np.uint32((seed >> 16) | 1)
    x ^= x * np.uint32(0x05526C56)
    x ^= x * np.uint32(0x53A22864)
    return _reversed(x)


def _reversed(words: Words) -> Words:
    """Mirror the bits of each word."""
    x = words.copy()
    for mask, step in MASKS:
        x = ((x >> np.uint32(step)) & np.uint32(mask)) | ((x & np.uint32(mask)) << np.uint32(step))
    return x
