"""The class densities of a prior on a space: cached, and their mass outside the vehicle.

The vehicle's own volume carries no weight in eq. 9.
"""

from __future__ import annotations

from weakref import WeakValueDictionary

import numpy as np

from ..base.arrays import Floats, read_only
from ..base.errors import InputError
from ..geometry.grids import PerceptionSpace
from ..prior.prior import ClassDensity, Prior


class CachedDensities(list[ClassDensity]):
    """A read-only list of densities that allows weak references (a plain list does not)."""


_CACHE: WeakValueDictionary[tuple[Prior, PerceptionSpace], CachedDensities] = WeakValueDictionary()


def cached_densities(prior: Prior, space: PerceptionSpace) -> CachedDensities:
    """Return `Prior.densities`, with its errors; cached while they are referenced elsewhere."""
    try:
        densities = _CACHE.get((prior, space))
    except TypeError:  # foreign classes without a hash
        return CachedDensities(prior.densities(space))
    if densities is None:
        densities = CachedDensities(prior.densities(space))
        for density in densities:
            read_only(density.ground)
        _CACHE[prior, space] = densities
    return densities


def outside_profile(density: ClassDensity, space: PerceptionSpace, tops: Floats) -> Floats:
    """Sum the class's height profile over voxels outside the vehicle, by column."""
    above = np.append(np.cumsum(density.profile[::-1])[::-1], 0.0)
    below = np.searchsorted(space.centers(2), tops.reshape(-1), side="left")
    return above[below].reshape(tops.shape)


def outside_masses(
    densities: list[ClassDensity], space: PerceptionSpace, tops: Floats | None
) -> list[float]:
    """Return each class's mass of the prior outside the vehicle (`tops` None: no vehicle).

    `InputError` when no weight is left outside.
    """
    if tops is None:
        return [float(d.ground.sum()) for d in densities]
    masses = [float((d.ground * outside_profile(d, space, tops)).sum()) for d in densities]
    if not sum(masses) > 0.0:
        raise InputError("prior", "weights", "some weight outside the vehicle", "none")
    return masses
