"""Field of view: minimum and maximum range, the directions a sensor sees, and its ego mask."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Ints
from ..base.errors import InputError
from ..base.values import Number

NEAREST = 0.0
"""Default minimum range [m]."""
SHORTEST_RANGE_M = 0.001
"""Least maximum range: what reaches less far is a typing error, and its square is 0."""
MIN_RANGE = Number(0.0, cap=1e5, unit="m", noun="length")


def checked_ranges(
    name: str, min_range: float, max_range: float, max_rule: Number
) -> tuple[float, float]:
    """Return the checked minimum and maximum range [m].

    Raises
    ------
    InputError
        When a range breaks its rule, or the minimum is not below the maximum.
    """
    far = max_rule.checked(name, "max_range", max_range)
    near = MIN_RANGE.checked(name, "min_range", min_range) + 0.0
    if not near < far:
        raise InputError(name, "min_range", f"a length below max_range, {far:g} m", f"{near:g}")
    return near, far


@dataclass(frozen=True, slots=True, eq=False)
class ViewPatch:
    """A sensor's field of view as a mesh on the unit sphere.

    Attributes
    ----------
    directions : (N, 3) float
        Unit, sensor frame.
    faces : (F, 3) int
        Indices into them, counter-clockwise as seen from outside.
    """

    directions: Floats
    faces: Ints


def grid_faces(index: Ints, *, closed: bool) -> Ints:
    """Return triangles (F, 3) of a grid of points (R, C); `closed` rows are rings.

    Rows go up and columns to the right as seen from outside. Triangles with the same point twice,
    as at a pole, are left out.
    """
    if closed:
        index = np.hstack([index, index[:, :1]])
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=2)
    faces = faces.reshape(-1, 3)
    pairs = ((0, 1), (1, 2), (2, 0))
    valid = np.logical_and.reduce([faces[:, i] != faces[:, j] for i, j in pairs])
    return faces[valid]


MAX_RAYS = 50_000_000
"""Maximum rays of a mask: a picture of 50 megapixels takes about a minute and 2 GB."""
FREE, OUTSIDE = -1, -2
"""Values in place of a part: a free ray, and a pixel beyond the edge of a lens's field."""


def require_mask_size(name: str, rays: int) -> None:
    """Raise `InputError` for a mask of more rays than `MAX_RAYS`, before rays are cast."""
    if rays > MAX_RAYS:
        raise InputError(name, "mask", f"at most {MAX_RAYS:,} pixels or beams", f"{rays:,}")


def count_by_part(occluded_by: NDArray[np.integer], part_names: Sequence[str]) -> dict[str, int]:
    """Return the number of rays that end on each part, the largest number first."""
    counts = np.bincount(occluded_by[occluded_by >= 0])
    order = np.argsort(-counts, kind="stable").tolist()
    return {part_names[k]: int(counts[k]) for k in order if counts[k]}


@dataclass(frozen=True, slots=True, eq=False)
class EgoMask:
    """Which rays of a sensor end on its own vehicle, and on which part of it.

    Attributes
    ----------
    parts : (H, W) int
        Part of the vehicle that a ray ends on, `FREE` or `OUTSIDE`. By pixel, top row first; or by
        channel, top first, and azimuth, left first.
    elevations, azimuths : (H,) and (W,) float, or None
        Of the rows and columns of a LiDAR, before the offsets of its channels [rad].
    """

    parts: NDArray[np.int32]
    elevations: NDArray[np.float64] | None = None
    azimuths: NDArray[np.float64] | None = None

    @property
    def sees_out(self) -> NDArray[np.bool_]:
        """(H, W) which rays are free: white in the mask."""
        return self.parts == FREE

    @property
    def outside(self) -> NDArray[np.bool_]:
        """(H, W) which pixels show nothing."""
        return self.parts == OUTSIDE

    def counts(self, part_names: Sequence[str]) -> dict[str, int]:
        """Number of rays that end on each part of the vehicle, in descending order."""
        return count_by_part(self.parts, part_names)
