"""The memory that a score needs, estimated before it starts; too much is refused in one line.

A test holds the estimates to measured peaks: neither is more than `FACTOR` times the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from ..base.errors import InputError
from ..base.memory import available_bytes, size_text
from ..geometry.grids import PerceptionSpace
from ..metric.entropy import ApCurve
from ..scene.rig import Sensor
from ..scene.vehicle import Vehicle
from ..sensors import GridKernel
from ..sensors.kernels import block_voxels
from .sampling import FIRST_SAMPLES, MIN_SAMPLES

Grouped = Sequence[Sequence[Sensor]]
"""Sensors whose measurements are summed, and kept, together."""

FACTOR = 2.0
"""Maximum ratio of an estimate and the measured memory, either way."""
COLUMN_BYTES = 10
"""Memory of a column and a class: the density, a copy, and arrays made of it."""
TREE_BYTES = 300
"""Memory of a triangle of the vehicle, once rays are cast (measured)."""
PLANE_BYTES = 24
"""Memory of a voxel of a thread's planes: counts, sums, precision, entropy, weights."""
SAMPLE_BYTES = 600
"""Memory of a sampled voxel (measured: 270 to 420 while sampling, 590 with 32 sensors)."""
COARSER = (2, 4, 5, 10, 20)
"""Factors of the voxel's side that a message suggests."""


def grid_bytes(
    space: PerceptionSpace,
    groups: Grouped,
    kernels: Mapping[tuple[str, ApCurve | None], GridKernel],
    vehicle: Vehicle | None,
    classes: int,
    workers: int,
) -> int:
    """Return the memory of a grid score [bytes]; `kernels` is by kind and own AP curve."""
    total = columns_bytes(space, classes) + workers * block_voxels(space) * PLANE_BYTES
    total += 0 if vehicle is None else len(vehicle.triangles) * TREE_BYTES
    for key, kernel in kernels.items():
        matching = [group for group in groups if (group[0].kind, group[0].curve) == key]
        total += kernel.memory_bytes(matching, space, workers)
    return total


def columns_bytes(space: PerceptionSpace, classes: int) -> int:
    """Return the memory of the prior on the ground of a space [bytes]."""
    nx, ny, _ = space.shape
    return nx * ny * classes * COLUMN_BYTES


def require_room_for(space: PerceptionSpace, needed: Callable[[PerceptionSpace], int]) -> None:
    """Refuse a score of a grid that takes more memory than there is.

    `needed` returns the memory that a score of a space takes [bytes]. The message of the
    `InputError` has how much it takes, how much there is, and what would fit.
    """
    there, amount = available_bytes(), needed(space)
    if there is not None and amount > there:
        fitting = next((s.interval for s in _coarser(space) if needed(s) <= there), None)
        ways = [f"samples = {FIRST_SAMPLES}"]
        ways += [] if fitting is None else [f"interval = {fitting:g}"]
        _refuse(amount, there, f"; try {' or '.join(ways)}")


def samples_bytes(samples: int, columns: int) -> int:
    """Return the memory [bytes] of a sampled score; `columns` is the prior's part of it."""
    return columns + samples * SAMPLE_BYTES


def require_room_for_samples(samples: int, columns: int) -> None:
    """Refuse a sample that takes more memory than there is; `columns` is the prior's part [bytes].

    The message of the `InputError` says how many voxels would fit.
    """
    there, amount = available_bytes(), samples_bytes(samples, columns)
    if samples and there is not None and amount > there:
        max_samples = max(0, there - columns) // SAMPLE_BYTES
        fitting = 1 << max(0, max_samples.bit_length() - 1)
        _refuse(amount, there, f"; try samples = {fitting}" if fitting >= MIN_SAMPLES else "")


def _refuse(amount: int, there: int, ways: str) -> None:
    expected = f"what fits in the {size_text(there)} of memory that are free{ways}"
    raise InputError("score", "memory", expected, f"about {size_text(amount)}")


def _coarser(space: PerceptionSpace) -> Iterator[PerceptionSpace]:
    """Yield spaces of the same bounds with larger voxels, if these fill the bounds exactly."""
    for times in COARSER:
        try:
            yield PerceptionSpace(space.x, space.y, space.z, space.interval * times)
        except InputError:  # the bounds are no whole number of such voxels
            continue
