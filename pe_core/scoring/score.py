"""What a score tells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..kinds import Stopped
from ..scene.frozen import frozen
from .object_score import ObjectScore

if TYPE_CHECKING:
    from .scatter import Scatter

DECIMALS = 9
"""Entropies and shares are rounded to this: below it, builds of NumPy differ in the last bit."""


Watch = Callable[[float], bool]
"""Is told how much of a score is done, 0 to 1, now and then; says whether to go on."""


class ScoreStopped(Exception):
    """A score was stopped by the one who watched it: there is none."""


@dataclass(frozen=True, slots=True)
class PartScore:
    """A class or a zone: perception entropy [nats], coverage, and its share of the prior."""

    entropy: float
    coverage: float
    share: float


@dataclass(frozen=True, slots=True)
class SensorScore:
    """One sensor: alone, missing, and how much of what it sees the vehicle stops.

    `entropy` and `coverage` are those of a rig of this sensor alone; `lost` is what the whole rig's
    entropy rises by when the sensor fails. `beams` are a LiDAR's, or places spread evenly over a
    camera's picture; `stopped` of them the vehicle stops, `stopped_by` part of it. 0 where a kind
    does not tell.
    """

    entropy: float
    coverage: float
    lost: float
    beams: int
    stopped: int
    stopped_by: dict[str, int]


@dataclass(frozen=True, slots=True)
class GroundMap:
    """Entropy and coverage of every column, averaged over height by the prior; (nx, ny) each.

    `mass` is the prior in each column. Columns without any, as those inside the vehicle, hold NaN.
    """

    entropy: NDArray[np.float64]
    coverage: NDArray[np.float64]
    mass: NDArray[np.float64]

    def coarser(self, columns: int) -> GroundMap:
        """Return the map in squares of `columns` by `columns` columns (fewer at the far edges)."""
        rows, ys = (np.arange(0, n, columns) for n in self.mass.shape)

        def summed(values: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.add.reduceat(np.add.reduceat(values, rows, axis=0), ys, axis=1)

        mass = summed(self.mass)
        safe = np.where(mass > 0.0, mass, np.nan)
        weighted = (np.nan_to_num(v) * self.mass for v in (self.entropy, self.coverage))
        entropy, coverage = (summed(v) / safe for v in weighted)
        return GroundMap(entropy, coverage, mass)


def ground_map(columns: NDArray[np.float64]) -> GroundMap:
    """Return the map of columns (3, nx, ny): entropy and coverage weighed by the prior, and it."""
    entropy, coverage, mass = columns
    safe = np.where(mass > 0.0, mass, np.nan)
    return GroundMap(*map(frozen, (entropy / safe, coverage / safe, mass.copy())))


@dataclass(frozen=True, slots=True)
class Glance:
    """What a sampled score tells of the whole rig: nothing of its sensors one by one.

    Fields are those of `Score`, and the same numbers to the bit.
    """

    entropy: float
    coverage: float
    stderr: float
    per_class: dict[str, PartScore]
    per_zone: dict[str, PartScore]
    voxels: int
    draft: bool = False


@dataclass(frozen=True, slots=True)
class Score:
    """Score of a rig.

    Attributes
    ----------
    entropy : float
        Perception entropy, eq. 9 [nats]; lower is better.
    coverage : float
        Prior mass with m > 0 for some sensor, 0 to 1.
    stderr : float
        Standard error of `entropy`; 0 for a score of the whole grid, and for no other.
    per_class : dict of PartScore
    per_zone : dict of PartScore
        Zones overlap: see `zones.ZONES`. A zone without prior mass is left out.
    per_sensor : dict of SensorScore
    voxels : int
        Voxels looked at.
    ground_map : GroundMap or None
        None for a sampled score.
    draft : bool
        Some LiDAR's beams were stopped by a map of the vehicle's top, not by the vehicle itself.
    objects : ObjectScore or None
        Of a score on objects: entropy, coverage and the rest are then means over objects, by their
        weights, and no voxel was looked at.
    scatter : Scatter or None
        How the figures scatter over the sample, for the error of a difference; None on the grid.
    """

    entropy: float
    coverage: float
    stderr: float
    per_class: dict[str, PartScore]
    per_zone: dict[str, PartScore]
    per_sensor: dict[str, SensorScore]
    voxels: int
    ground_map: GroundMap | None = None
    draft: bool = False
    objects: ObjectScore | None = None
    scatter: Scatter | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the score as plain JSON data, without ground map and scatter."""
        mark = {"draft": True} if self.draft else {}
        return {
            **mark,
            "entropy": self.entropy,
            "coverage": self.coverage,
            "stderr": self.stderr,
            "voxels": self.voxels,
            "per_class": {name: asdict(part) for name, part in self.per_class.items()},
            "per_zone": {name: asdict(part) for name, part in self.per_zone.items()},
            "per_sensor": {name: asdict(own) for name, own in self.per_sensor.items()},
            **({} if self.objects is None else {"objects": self.objects.to_dict()}),
        }


def sensor_score(entropy: float, coverage: float, lost: float, stopped: Stopped) -> SensorScore:
    """Put together what is known of one sensor."""
    return SensorScore(entropy, coverage, lost, stopped.beams, stopped.stopped, stopped.by_part)


def rounded(value: float) -> float:
    """Round to DECIMALS, without a negative zero."""
    return round(float(value), DECIMALS) + 0.0
