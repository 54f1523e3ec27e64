"""The ground map: what is seen of every place, by how many sensors, and how well."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..metric.fusion import Fusion
from ..scene.frozen import frozen
from ..scene.sensors import Rig
from ..scoring.subsets import fused_early
from .places import VoxelsByCell

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class GroundSight:
    """What a rig sees of every place on the ground.

    Attributes
    ----------
    x : (NX,) float
    y : (NY,) float
        Middles of the places [m].
    step : float
        Side of a place [m].
    height : float or None
        Where it was looked [m]; None: averaged over height by the prior, as a score does.
    entropy : (NX, NY) float
        Mean H of a place, eq. 8 [nats]; NaN where the vehicle is.
    coverage : (NX, NY) float
        Share of a place that some sensor sees, 0 to 1; NaN where the vehicle is.
    sensors : (NX, NY) int
        How many sensors see some of a place; -1 where the vehicle is.
    kinds : (NX, NY) int
        How many kinds of sensors do; -1 where the vehicle is.
    draft : bool
        Some LiDAR's beams were stopped by a map of the vehicle's top, not by the vehicle itself.
    """

    x: Floats
    y: Floats
    step: float
    height: float | None
    entropy: Floats
    coverage: Floats
    sensors: Ints
    kinds: Ints
    draft: bool = False


def ground_sight(
    places: VoxelsByCell,
    rig: Rig,
    m: Mapping[str, NDArray],
    fusion: Fusion,
    height: float | None,
    draft: bool,
) -> GroundSight:
    """Put together what is measured on the voxels of places, by sensor name."""
    entropies, seen = fusion.entropies(fused_early(rig, m, [s.name for s in rig]))
    by_sensor = {s.name: places.any(m[s.name] > 0) for s in rig}
    by_kind: dict[str, NDArray[np.bool_]] = {}
    for s in rig:
        by_kind[s.kind] = by_kind.get(s.kind, False) | by_sensor[s.name]
    return GroundSight(
        frozen(places.cells.x),
        frozen(places.cells.y),
        places.cells.step,
        height,
        frozen(places.mean(entropies)),
        frozen(places.mean(seen)),
        frozen(_number(by_sensor, places)),
        frozen(_number(by_kind, places)),
        draft,
    )


def _number(flags: Mapping[str, NDArray[np.bool_]], places: VoxelsByCell) -> Ints:
    """How many flags are set in each cell; -1 where the vehicle is."""
    total = np.sum(list(flags.values()), axis=0, dtype=np.int64)
    return np.where(places.vehicle, -1, total)
