"""How much ``pe validate`` computes: all of it, or enough to try the way through in a minute."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ValidityEffort:
    """How much is computed.

    Attributes
    ----------
    samples : int
        Voxels a score looks at; 0: all.
    traffic_samples, traffic_scenes : int
        Voxels and scenes of the voxel scores in traffic.
    objects, scenes : int
        Objects standing alone, and scenes of traffic, that the object scores look at.
    all_variants : bool
        Whether what had to be chosen is varied.
    """

    samples: int
    traffic_samples: int
    traffic_scenes: int
    objects: int
    scenes: int
    all_variants: bool


FULL = ValidityEffort(0, 32_768, 32, 20_000, 400, True)
QUICK = ValidityEffort(8_192, 4_096, 1, 512, 8, False)
