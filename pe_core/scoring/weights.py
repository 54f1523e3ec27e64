"""Weights of the prior outside the vehicle (eq. 9: its own volume carries none)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..prior.prior import ClassDensity
from ..scene.space import PerceptionSpace

Floats = NDArray[np.float64]


def outside_profile(density: ClassDensity, space: PerceptionSpace, tops: Floats) -> Floats:
    """Sum of the class's height profile over voxels not below the vehicle's top, by column."""
    above = np.append(np.cumsum(density.profile[::-1])[::-1], 0.0)
    below = np.searchsorted(space.centers(2), tops.reshape(-1), side="left")
    return above[below].reshape(tops.shape)


def outside_masses(
    densities: list[ClassDensity], space: PerceptionSpace, tops: Floats | None
) -> list[float]:
    """Each class's mass of the prior outside the vehicle (`tops` None: no vehicle).

    Raises
    ------
    InputError
        When the vehicle fills everything that had any weight.
    """
    if tops is None:
        return [float(d.ground.sum()) for d in densities]
    masses = [float((d.ground * outside_profile(d, space, tops)).sum()) for d in densities]
    if not sum(masses) > 0.0:
        raise InputError("prior", "weights", "some weight outside the vehicle", "none")
    return masses
