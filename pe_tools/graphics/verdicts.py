"""Samples of a requirement's zone as they are painted: which pass, which fail, how large one is."""

from __future__ import annotations

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.scoring.requirements import Verdict

SPOT_M = 0.3
"""Size at which samples of paths and single spots are painted at least."""


def painted_samples(verdict: Verdict) -> tuple[Floats, Floats, float]:
    """Return the samples that pass (N, 2), those that fail (M, 2), and the size of one [m].

    Of blind ground these are the squares of the zone that are seen and those that are blind.
    """
    samples = verdict.samples
    if verdict.ground is not None:
        cells, blind, mask = verdict.ground.cells, verdict.ground.blind, samples.mask
        places = np.stack(np.meshgrid(cells.x, cells.y, indexing="ij"), axis=-1)
        inside = np.ones(blind.shape, bool) if mask is None else mask
        return places[inside & ~blind], places[inside & blind], cells.step
    points, inside, ok = samples.points, samples.inside, verdict.passed
    step = samples.zone.zone.step
    if samples.zone.kind in ("path", "spots"):
        size = max(step, SPOT_M)
    else:
        size = _spacing(points[inside], step)
        if samples.zone.zone.x is None:  # corners of its outline lie between the samples
            size = max(step, size)
    return points[inside & ok], points[inside & ~ok], size


def _spacing(points: Floats, step: float) -> float:
    """Return the distance of samples along x: a preview has larger ones than the zone's step."""
    gaps = np.diff(np.unique(points[:, 0])) if len(points) else np.zeros(0)
    gaps = gaps[gaps > step / 2.0]
    return float(gaps.min()) if len(gaps) else step
