"""How much of where objects are is seen, by which sensors and where; where a loss costs most."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scoring.sampling import VoxelSample
from ..scoring.zones import zone_masks


@dataclass(frozen=True, slots=True)
class SeenShares:
    """Shares of the prior that are seen, 0 to 1.

    Attributes
    ----------
    by_number : tuple of float
        By at least 0, 1, 2, ... sensors, up to all of them.
    zones : dict of dict of float
        By sensor and zone (`scoring.zones.ZONES`): the share of the zone that the sensor sees. A
        zone without prior mass is left out.
    losses : dict of dict of float
        By sensor and zone: how much the zone's mean entropy rises when the sensor fails [nats].
    """

    by_number: tuple[float, ...]
    zones: Mapping[str, Mapping[str, float]]
    losses: Mapping[str, Mapping[str, float]]


def seen_shares(
    sample: VoxelSample, m: Mapping[str, NDArray], rises: Mapping[str, NDArray]
) -> SeenShares:
    """Aggregate measurements over a sample of the prior.

    Parameters
    ----------
    sample : VoxelSample
    m : mapping of (V,) array
        What each sensor measures, by name.
    rises : mapping of (V,) float
        How much the entropy of each voxel rises without the sensor [nats], by name.
    """
    sees = {name: of_one > 0 for name, of_one in m.items()}
    number = np.sum(list(sees.values()), axis=0, dtype=np.int64)
    masks = zone_masks(sample.centers[:, 0], sample.centers[:, 1])

    def by_zone(values: Mapping[str, NDArray]) -> dict[str, dict[str, float]]:
        return {
            name: {zone: float(np.mean(own[mask])) for zone, mask in masks.items() if mask.any()}
            for name, own in values.items()
        }

    by_number = tuple(float(np.mean(number >= n)) for n in range(len(m) + 1))
    return SeenShares(by_number, by_zone(sees), by_zone(rises))
