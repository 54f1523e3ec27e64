"""A prior given voxel by voxel: weights on the ground, or on all voxels, of a space."""

import hashlib
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

from ..base.arrays import Floats, read_only_copy
from ..base.errors import InputError, require_kind
from ..base.files import read_bytes
from ..base.notebook import ShortRepr
from ..base.values import A_PATH, numbers
from ..geometry.grids import PerceptionSpace
from .boxes import MAX_CLASSES, voxel_of
from .classes import Shape

NPY_BYTES = 2**28  # Largest file of weights


@dataclass(frozen=True, slots=True, eq=False)
class Grid(ShortRepr):
    """Weights in the ground frame; equal when they hold the same numbers on the same space.

    `InputError` when the shape is not that of the space, a weight is negative or not finite, none
    is above 0, or weights that differ by height have more than 64 layers.

    `weights` (nx, ny): Weight of each column, the same at all heights, or of each voxel; at least
        0.
    `space`: The space of the weights. In another space each voxel has the weight at its centre.
    `file`: The .npy file of the weights, as the user named it.
    """

    weights: Floats
    space: PerceptionSpace
    file: str | None = None
    digest: str = field(init=False, repr=False, default="")

    def __post_init__(self) -> None:
        require_kind("grid", "space", self.space, PerceptionSpace)
        shape = self.space.shape
        array = numbers(self.weights)
        if array is None or array.shape not in (shape, shape[:2]):
            found: Any = "no array" if array is None else f"shape {array.shape}"
            raise InputError("grid", "weights", f"shape {shape[:2]} or {shape}", found)
        if array.ndim == 3 and (array == array[:, :, :1]).all():
            array = array[:, :, 0]
        if not (array >= 0.0).all() or not 0.0 < array.sum() < np.inf:
            raise InputError("grid", "weights", "finite numbers >= 0, one above 0", "others")
        if array.ndim == 3 and shape[2] > MAX_CLASSES:
            expected = f"at most {MAX_CLASSES} layers where weights differ by height"
            raise InputError("grid", "space", expected, shape[2])
        if self.file is not None:
            object.__setattr__(self, "file", A_PATH.checked("grid", "file", self.file))
        object.__setattr__(self, "weights", read_only_copy(array, np.float64))
        digest = hashlib.sha256(f"{self.space} {array.shape}".encode())
        digest.update(self.weights.tobytes())
        object.__setattr__(self, "digest", digest.hexdigest())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Grid) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of what has a density of its own: all heights, or each layer of voxels."""
        if self.weights.ndim == 2:
            return ("any",)
        low = self.space.centers(2) - self.space.interval / 2.0
        return tuple(f"z from {z + 0.0:.6g} m" for z in low)

    def shapes(self, space: PerceptionSpace) -> list[Shape]:
        """Return the density of each of `layers` on a space; the sum of all is not normalised."""
        x, y, z = (voxel_of(space.centers(axis), self.space, axis) for axis in range(3))
        inside = (x >= 0)[:, None] & (y >= 0)
        columns = np.where(inside.T, self.weights[np.ix_(x, y)].T, 0.0).T
        layers = columns[:, :, None] if columns.ndim == 2 else columns
        shapes = []
        for k in range(layers.shape[2]):
            profile = (z >= 0 if columns.ndim == 2 else z == k).astype(float)
            count = profile.sum()
            shapes.append((layers[:, :, k] * count, profile / count if count else profile))
        return shapes


def read_grid(path: Path, space: PerceptionSpace) -> Grid:
    """Read weights from a .npy file of NumPy; `InputError` where it is none for this space."""
    data = read_bytes(path, NPY_BYTES)
    file = io.BytesIO(data)
    try:
        header = npy.read_magic(file), npy.read_array_header_1_0(file)  # type: ignore[no-untyped-call]
        (_, (shape, _, dtype)) = header
        if shape not in (space.shape, space.shape[:2]) or dtype.kind not in "fiu":
            expected = f"numbers of shape {space.shape[:2]} or {space.shape}"
            raise InputError(path, "weights", expected, f"{dtype} of shape {shape}")
        file.seek(0)
        return Grid(npy.read_array(file, allow_pickle=False), space)  # type: ignore[no-untyped-call]
    except InputError as error:
        raise error.at(path) from None
    except Exception as error:  # of NumPy and of Python's tokenizer
        found = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(path, "file", "a NumPy .npy array", found) from error


def grid_bytes(grid: Grid) -> bytes:
    """Return the .npy file of a grid's weights."""
    file = io.BytesIO()
    npy.write_array(file, grid.weights, (1, 0), allow_pickle=False)  # type: ignore[no-untyped-call]
    return file.getvalue()
