"""The prior on a space, shared by samples of several sizes while one of them is in use."""

from __future__ import annotations

from weakref import WeakValueDictionary

from ..prior.prior import ClassDensity, Prior
from ..scene.frozen import frozen
from ..scene.space import PerceptionSpace


class SharedDensities(list[ClassDensity]):
    """Densities that nobody changes. (A plain list cannot be referred to weakly.)"""


_IN_USE: WeakValueDictionary[tuple[Prior, PerceptionSpace], SharedDensities] = WeakValueDictionary()


def shared_densities(prior: Prior, space: PerceptionSpace) -> SharedDensities:
    """Return `Prior.densities`, made once as long as somebody holds them; with its errors."""
    try:
        known = _IN_USE.get((prior, space))
    except TypeError:  # classes of somebody's own that have no hash
        return SharedDensities(prior.densities(space))
    if known is None:
        known = SharedDensities(prior.densities(space))
        for density in known:
            frozen(density.ground)
        _IN_USE[prior, space] = known
    return known
