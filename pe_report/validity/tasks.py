"""What is computed of a placement: plain functions from names to JSON data, run in processes."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import pe_core as pe

from .choices import Variant, body_of
from .published import paper_of

Json = dict[str, Any]

PRIORS = {"road": pe.Prior.road, "uniform": pe.Prior.uniform}


def voxel_name(paper: str, placement: str, reading: str, traffic: str, variant: Variant) -> str:
    """Name of a placement's voxel scores; the density of traffic tells only in traffic."""
    density = f"/{variant.density:g}" if traffic != "alone" else ""
    return f"voxels/{traffic}/{paper}/{placement}/{reading}/{variant.body}{density}"


def object_name(paper: str, placement: str, reading: str, traffic: str, variant: Variant) -> str:
    """Name of a placement's object scores."""
    return "objects" + voxel_name(paper, placement, reading, traffic, variant)[len("voxels") :]


def voxels(paper: str, placement: str, reading: str, body: str, samples: int) -> Json:
    """Score a placement's voxels, by prior, with nothing but the vehicle's body in the way."""
    rig = paper_of(paper).rig(placement, reading)
    return {prior: _parts(_evaluator(prior, body, samples).score(rig)) for prior in PRIORS}


@lru_cache(maxsize=2)
def _evaluator(prior: str, body: str, samples: int) -> pe.Evaluator:
    """A process makes it once for all placements."""
    return pe.Evaluator(
        pe.PerceptionSpace(), PRIORS[prior](), body_of(body), samples=samples, workers=1
    )


def _parts(score: pe.Score) -> Json:
    return {
        "entropy": score.entropy,
        "coverage": score.coverage,
        "per_class": {
            name: {"entropy": part.entropy, "coverage": part.coverage}
            for name, part in score.per_class.items()
        },
    }
