"""What is visible: the map of the ground, and shares of the prior by sensor and zone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints, read_only
from ...metric.fusion import Fusion
from ...scene.rig import Rig
from ..sampling import VoxelSample
from ..scenarios import fused_early
from ..score import zone_masks
from .voxel_sets import VoxelsByCell


@dataclass(frozen=True, slots=True, eq=False)
class GroundSight:
    """What is visible to a rig in every cell of the ground.

    Attributes
    ----------
    x : (NX,) float
    y : (NY,) float
        Middles of the cells [m].
    step : float
        Side of a cell [m].
    height : float or None
        Height of the evaluated voxels [m]; None: averaged over height by the prior, as in a score.
    entropy : (NX, NY) float
        Mean H of a cell, eq. 8 [nats]; NaN where the vehicle is.
    coverage : (NX, NY) float
        Share of a cell that is visible to a sensor, 0 to 1; NaN where the vehicle is.
    sensors : (NX, NY) int
        Number of sensors that see a part of a cell; -1 where the vehicle is.
    kinds : (NX, NY) int
        Number of kinds of sensors that see a part of a cell; -1 where the vehicle is.
    preview : bool
        Approximate preview: occlusion of a LiDAR was read from a map of the vehicle's top surface.
    """

    x: Floats
    y: Floats
    step: float
    height: float | None
    entropy: Floats
    coverage: Floats
    sensors: Ints
    kinds: Ints
    preview: bool = False


def ground_sight(
    voxels: VoxelsByCell,
    rig: Rig,
    m: Mapping[str, NDArray],
    fusion: Fusion,
    height: float | None,
    preview: bool,
) -> GroundSight:
    """Combine the measurements `m` (by sensor name) on the voxels of cells."""
    entropies, visible = fusion.entropies(fused_early(rig, m, [s.name for s in rig]))
    by_sensor = {s.name: voxels.any(m[s.name] > 0) for s in rig}
    by_kind: dict[str, NDArray[np.bool_]] = {}
    for s in rig:
        by_kind[s.kind] = by_kind.get(s.kind, False) | by_sensor[s.name]
    return GroundSight(
        read_only(voxels.cells.x),
        read_only(voxels.cells.y),
        voxels.cells.step,
        height,
        read_only(voxels.mean(entropies)),
        read_only(voxels.mean(visible)),
        read_only(_number(by_sensor, voxels)),
        read_only(_number(by_kind, voxels)),
        preview,
    )


def _number(flags: Mapping[str, NDArray[np.bool_]], voxels: VoxelsByCell) -> Ints:
    """Number of flags set in each cell; -1 where the vehicle is."""
    total = np.sum(list(flags.values()), axis=0, dtype=np.int64)
    return np.where(voxels.vehicle, -1, total)


@dataclass(frozen=True, slots=True)
class VisibleShares:
    """Visible shares of the prior, 0 to 1.

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


def visible_shares(
    sample: VoxelSample, m: Mapping[str, NDArray], rises: Mapping[str, NDArray]
) -> VisibleShares:
    """Aggregate measurements over a sample of the prior.

    Parameters
    ----------
    sample : VoxelSample
    m : mapping of (V,) array
        Measurement of each sensor, by name.
    rises : mapping of (V,) float
        Rise of the entropy of each voxel without the sensor [nats], by name.
    """
    sees = {name: of_one > 0 for name, of_one in m.items()}
    number = np.sum(list(sees.values()), axis=0, dtype=np.int64)
    masks = zone_masks(sample.centers[:, 0], sample.centers[:, 1])

    def by_zone(values: Mapping[str, NDArray]) -> dict[str, dict[str, float]]:
        return {
            name: {zone: float(np.mean(shares[mask])) for zone, mask in masks.items() if mask.any()}
            for name, shares in values.items()
        }

    by_number = tuple(float(np.mean(number >= n)) for n in range(len(m) + 1))
    return VisibleShares(by_number, by_zone(sees), by_zone(rises))
