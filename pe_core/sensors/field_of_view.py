"""What a sensor sees: its range, the directions of its field of view, pictures."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Flags, Floats, Ints
from ..base.errors import InputError
from ..base.values import Number
from ..scene.rig import Sensor, SensorModel

LIGHT_M_S = 299_792_458.0
NEAREST = 0.0
"""Default minimum range [m]."""
SHORTEST_RANGE_M = 0.001
"""Least maximum range: what reaches less far is a typing error, and its square is 0."""
MIN_RANGE = Number(0.0, cap=1e5, unit="m", noun="length")
STEP_M = 0.01
"""A limited range is at least this much above the minimum range."""
FREE = -1  # Value of a free ray in place of a part


def checked_ranges(
    name: str, min_range: float, max_range: float, max_rule: Number
) -> tuple[float, float]:
    """Return the checked minimum and maximum range [m]. `InputError` when a range breaks its rule,
    or the minimum is not below the maximum."""
    far = max_rule.checked(name, "max_range", max_range)
    near = MIN_RANGE.checked(name, "min_range", min_range) + 0.0
    if not near < far:
        raise InputError(name, "min_range", f"a length below max_range, {far:g} m", f"{near:g}")
    return near, far


_whole: WeakKeyDictionary[SensorModel, SensorModel] = WeakKeyDictionary()
"""Models by those whose range was limited."""


def limited(model: Any, range_m: float) -> Any:
    """Return a model with `max_range` at most a range [m], above its minimum range."""
    limit = max(range_m, model.min_range + STEP_M)
    if limit >= model.max_range:
        return model
    short = replace(model, max_range=limit)
    _whole[short] = model
    return short


def at_whole_range(sensor: Sensor) -> Sensor:
    """Return the sensor of which `limited` made this one; without it the same object."""
    model = _whole.get(sensor.model)
    return sensor if model is None else replace(sensor, model=model)


@dataclass(frozen=True, slots=True, eq=False)
class ViewPatch:
    """A sensor's field of view as a mesh on the unit sphere. `directions` (N, 3) are unit vectors,
    sensor frame; `faces` (F, 3) indices into them, counter-clockwise as seen from outside."""

    directions: Floats
    faces: Ints


def grid_faces(index: Ints, *, closed: bool) -> Ints:
    """Return triangles (F, 3) of a grid of points (R, C); `closed` rows are rings. Rows go up and
    columns to the right as seen from outside. Triangles with the same point twice, as at a pole,
    are left out."""
    if closed:
        index = np.hstack([index, index[:, :1]])
    a = index[:-1, :-1]
    b = index[:-1, 1:]
    c = index[1:, 1:]
    d = index[1:, :-1]
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=2)
    faces = faces.reshape(-1, 3)
    pairs = ((0, 1), (1, 2), (2, 0))
    valid = np.logical_and.reduce([faces[:, i] != faces[:, j] for i, j in pairs])
    return faces[valid]


def count_by_part(occluded_by: NDArray[np.integer], part_names: Sequence[str]) -> dict[str, int]:
    """Return the number of rays that end on each part, the largest number first."""
    counts = np.bincount(occluded_by[occluded_by >= 0])
    order = np.argsort(-counts, kind="stable").tolist()
    return {part_names[k]: int(counts[k]) for k in order if counts[k]}


@dataclass(frozen=True, slots=True)
class FieldPicture:
    """What a sensor detects of a target by range and azimuth.

    `values` (R, A): m of the target, farthest range first, leftmost azimuth first; 0 where it is
        not detected.
    `hidden` (R, A): Whether it would be detected if the vehicle did not hide it.
    `ranges, azimuths` (R,): Of the target's centre, over the ground [m] and from the sensor's
        heading [rad], descending.
    `height_m`: Height of the target's centre above the ground.
    `target`: What the target is.
    """

    values: Floats
    hidden: Flags
    ranges: Floats
    azimuths: Floats
    height_m: float
    target: str
