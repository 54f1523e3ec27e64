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
    variant_samples : int
        The same where what had to be chosen is varied.
    traffic_samples, traffic_scenes : int
        Voxels and scenes of the voxel scores in traffic.
    scenes : int
        Scenes of objects, about 19 in each, that the object scores look at.
    all_variants : bool
        Whether what had to be chosen is varied.
    """

    samples: int
    variant_samples: int
    traffic_samples: int
    traffic_scenes: int
    scenes: int
    all_variants: bool


FULL = ValidityEffort(0, 262_144, 32_768, 16, 500, True)
QUICK = ValidityEffort(8_192, 8_192, 4_096, 1, 8, False)
