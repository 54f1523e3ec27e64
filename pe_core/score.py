"""What a score tells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

DECIMALS = 9
"""Entropies and shares are rounded to this: below it, builds of NumPy differ in the last bit."""


@dataclass(frozen=True, slots=True)
class ClassScore:
    """One object class: perception entropy [nats], coverage, and its share of the prior."""

    entropy: float
    coverage: float
    share: float


@dataclass(frozen=True, slots=True)
class SensorScore:
    """One sensor as if it were alone, and how many of its beams the vehicle stops.

    `beams` and `stopped` are 0 for cameras; `stopped_by` counts stopped beams by vehicle part.
    """

    entropy: float
    coverage: float
    beams: int
    stopped: int
    stopped_by: dict[str, int]


@dataclass(frozen=True, slots=True)
class GroundMap:
    """Entropy and coverage of every column, averaged over height by the prior; (nx, ny) each.

    Columns wholly inside the vehicle hold NaN.
    """

    entropy: NDArray[np.float32]
    coverage: NDArray[np.float32]


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
        Standard error of `entropy`; 0 for a score of the whole grid.
    per_class : dict of ClassScore
    per_sensor : dict of SensorScore
    voxels : int
        Voxels looked at.
    ground_map : GroundMap or None
        None for a sampled score.
    """

    entropy: float
    coverage: float
    stderr: float
    per_class: dict[str, ClassScore]
    per_sensor: dict[str, SensorScore]
    voxels: int
    ground_map: GroundMap | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the score as plain JSON data, without the ground map."""
        return {
            "entropy": self.entropy,
            "coverage": self.coverage,
            "stderr": self.stderr,
            "voxels": self.voxels,
            "per_class": {
                name: {"entropy": c.entropy, "coverage": c.coverage, "share": c.share}
                for name, c in self.per_class.items()
            },
            "per_sensor": {
                name: {
                    "entropy": s.entropy,
                    "coverage": s.coverage,
                    "beams": s.beams,
                    "stopped": s.stopped,
                    "stopped_by": s.stopped_by,
                }
                for name, s in self.per_sensor.items()
            },
        }


def rounded(value: float) -> float:
    """Round to DECIMALS, without a negative zero."""
    return round(float(value), DECIMALS) + 0.0
