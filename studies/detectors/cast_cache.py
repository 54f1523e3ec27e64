"""RegionVoxels of many scenes, cast once for a placement and kept in a file for its other seeds."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from pe_core import InputError
from pe_core.base import read_bytes, write_bytes

from .casting import RegionVoxels

MAX_BYTES = 1 << 30
FIELDS = ("cells", "counts", "centers", "labels", "beams")
PER_VOXEL = 2
"""The first so many fields have a row a voxel, the others a row an object."""


def cached(
    path: Path | None, count: int, cast: Callable[[int], RegionVoxels]
) -> list[RegionVoxels]:
    """Return the voxels of scenes 0 to `count` - 1, from a file if it has them, else cast.

    Parameters
    ----------
    path : Path or None
        Where they are kept; None: nowhere.
    count : int
    cast : callable
        Casts the scene of a number.
    """
    if path is not None and path.exists():
        scenes = _unpacked(path)
        if len(scenes) == count:
            return scenes
    scenes = [cast(number) for number in range(count)]
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path, _packed(scenes))
    return scenes


def _packed(scenes: Sequence[RegionVoxels]) -> bytes:
    data = io.BytesIO()
    arrays = {name: np.concatenate([getattr(s, name) for s in scenes]) for name in FIELDS}
    lengths = np.array([(len(s.cells), len(s.labels)) for s in scenes]).reshape(-1, 2)
    np.savez(data, lengths=lengths, **arrays)
    return data.getvalue()


def _unpacked(path: Path) -> list[RegionVoxels]:
    try:
        with np.load(io.BytesIO(read_bytes(path, MAX_BYTES)), allow_pickle=False) as data:
            ends = np.cumsum(data["lengths"], axis=0)[:-1]
            parts = [
                np.split(data[name], ends[:, int(k >= PER_VOXEL)]) for k, name in enumerate(FIELDS)
            ]
    except (ValueError, KeyError, OSError, EOFError) as error:
        raise InputError(path, "file", "scenes that were cast (delete it)", error) from None
    return [
        RegionVoxels(**dict(zip(FIELDS, arrays, strict=True)))
        for arrays in zip(*parts, strict=True)
    ]
