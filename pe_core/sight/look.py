"""Sets of voxels that are looked at again and again, with the sensors measured on them."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..kinds import MeasuredByName, Voxels
from ..metric.fusion import Fusion
from ..scene.sensors import Rig
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle

VOXELS_KEPT = 4_000_000
"""Of all sets together, at most: some 100 bytes each."""


class HasSize(Protocol):
    """What is kept."""

    @property
    def size(self) -> int:
        """How much it is, in voxels."""


class HasVoxels(Protocol):
    """What is looked at: voxels of the space by number."""

    @property
    def index(self) -> NDArray[np.int64]:
        """(V, 3)."""


P = TypeVar("P", bound=HasVoxels)
K = TypeVar("K", bound=HasSize)


class Sighting(Generic[P]):
    """What is looked at, and the sensors measured on its voxels."""

    def __init__(self, places: P, sensors: MeasuredByName) -> None:
        self.places, self._sensors = places, sensors

    @property
    def size(self) -> int:
        """Number of voxels."""
        return len(self.places.index)

    def measured(self, rig: Rig, draft: bool) -> tuple[dict[str, NDArray], bool]:
        """m of the rig's sensors by name, (V,) each; and whether any is a draft."""
        self._sensors.measure(rig, draft)
        return self._sensors.m, any(known.draft for known in self._sensors.last.values())


class KnownSightings:
    """Looks by what is asked for; of those asked for last, as many as there is room for."""

    def __init__(self, space: PerceptionSpace, vehicle: Vehicle | None, fusion: Fusion) -> None:
        self._space, self._vehicle, self._fusion = space, vehicle, fusion
        self._known: dict[str, Any] = {}  # by kind: beams are turned and cast once for all looks
        self._looks: dict[Hashable, Any] = {}  # the one asked for last comes last

    @property
    def known(self) -> dict[str, Any]:
        """What kernels know of sensors and of the vehicle, by kind, whatever is looked at."""
        return self._known

    def at(self, key: Hashable, places: Callable[[], P]) -> Sighting[P]:
        """Return the voxels kept by that key, or choose them."""
        return self.kept(key, lambda: self._made(places()))

    def kept(self, key: Hashable, made: Callable[[], K]) -> K:
        """Return what is kept by that key, or make it."""
        look: K = self._looks.pop(key, None) or made()
        self._looks[key] = look
        room = VOXELS_KEPT
        for other in reversed(tuple(self._looks)):
            room -= self._looks[other].size
            if room < 0 and other != key:
                del self._looks[other]
        return look

    def _made(self, places: P) -> Sighting[P]:
        voxels = Voxels(self._space, places.index, self._space.center_of(places.index))
        enough = self._fusion.enough
        return Sighting(places, MeasuredByName(voxels, self._vehicle, enough, self._known))
