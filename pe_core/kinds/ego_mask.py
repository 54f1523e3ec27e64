"""Ego masks: which rays of a sensor's own picture end on its vehicle, and on which part of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

MAX_RAYS = 50_000_000
"""Of a mask: a picture of 50 megapixels takes about a minute and 2 GB."""
FREE, OUTSIDE = -1, -2
"""In place of a part: what sees out, and what shows nothing, beyond the edge of a lens's field."""


def require_few_rays(name: str, rays: int) -> None:
    """Raise `InputError` for a mask of more rays than `MAX_RAYS`, before any is cast."""
    if rays > MAX_RAYS:
        raise InputError(name, "mask", f"at most {MAX_RAYS:,} pixels or beams", f"{rays:,}")


@dataclass(frozen=True, slots=True, eq=False)
class EgoMask:
    """What of a sensor's own picture its vehicle takes.

    Attributes
    ----------
    parts : (H, W) int
        By pixel, the top row first; or by channel, top first, and azimuth, left first: the part of
        the vehicle that a ray ends on, `FREE` or `OUTSIDE`.
    elevations, azimuths : (H,) and (W,) float, or None
        Of a LiDAR's rows and columns, before the channels' own offsets [rad].
    """

    parts: NDArray[np.int32]
    elevations: NDArray[np.float64] | None = None
    azimuths: NDArray[np.float64] | None = None

    @property
    def sees_out(self) -> NDArray[np.bool_]:
        """(H, W) what is white."""
        return self.parts == FREE

    @property
    def outside(self) -> NDArray[np.bool_]:
        """(H, W) what shows nothing."""
        return self.parts == OUTSIDE

    def counts(self, part_names: tuple[str, ...]) -> dict[str, int]:
        """Rays that end on the vehicle, by part, most first."""
        hit = self.parts[self.parts >= 0]
        counts = np.bincount(hit, minlength=len(part_names))
        order = np.argsort(-counts, kind="stable")
        return {part_names[k]: int(counts[k]) for k in order.tolist() if counts[k]}
