"""The scores that are compared, each turned so that higher is better.

This list is all that is compared; it stood before anything was correlated.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from .choices import PARTS, ScoreChoice
from .published import Paper
from .tasks import ALONE, TRAFFIC, object_name, voxel_name

Values = Mapping[str, Any]
Ranked = Callable[[Paper, str, str, str, ScoreChoice, Values], float]
"""From paper, placement, reading, class, variant and what was computed to a number."""


@dataclass(frozen=True)
class RankedScore:
    """A score that is compared with AP.

    Attributes
    ----------
    name : str
    about : str
        What it is, in a sentence.
    ranked : callable
        Its value of a placement; higher is better.
    """

    name: str
    about: str
    ranked: Ranked


def _voxels(prior: str, key: str, traffic: str, sign: float) -> Ranked:
    def ranked(
        paper: Paper, placement: str, reading: str, cls: str, variant: ScoreChoice, values: Values
    ) -> float:
        found = values[voxel_name(paper.id, placement, reading, traffic, variant)][prior]
        own = found["per_class"].get(cls, found)  # the uniform prior knows no classes
        part = own if variant.part == PARTS[0] else found
        return sign * float(part[key])

    return ranked


def _objects(key: str, traffic: str, sign: float) -> Ranked:
    def ranked(
        paper: Paper, placement: str, reading: str, cls: str, variant: ScoreChoice, values: Values
    ) -> float:
        found = values[object_name(paper.id, placement, reading, traffic, variant)]
        part = found["per_class"][cls] if variant.part == PARTS[0] else found
        return sign * float(part[key])

    return ranked


def _height(
    paper: Paper, placement: str, reading: str, cls: str, variant: ScoreChoice, values: Values
) -> float:
    return paper.height(placement)


def _with_traffic(name: str, about: str, made: Callable[[str], Ranked]) -> list[RankedScore]:
    return [
        RankedScore(name, about, made(ALONE)),
        RankedScore(f"{name}, in traffic", "the same among other road users", made(TRAFFIC)),
    ]


CANDIDATES = (
    *_with_traffic(
        "perception entropy, road prior",
        "the paper's score of voxels, over where cars, cyclists and pedestrians are met",
        lambda traffic: _voxels("road", "entropy", traffic, -1.0),
    ),
    *_with_traffic(
        "perception entropy, uniform prior",
        "the paper's score with every voxel counted alike",
        lambda traffic: _voxels("uniform", "entropy", traffic, -1.0),
    ),
    *_with_traffic(
        "coverage",
        "the share of the road prior that any sensor meets",
        lambda traffic: _voxels("road", "coverage", traffic, 1.0),
    ),
    *_with_traffic(
        "object entropy",
        "entropy of whole objects, by the beams and pixels they get",
        lambda traffic: _objects("entropy", traffic, -1.0),
    ),
    *_with_traffic(
        "expected AP",
        "mean AP of objects, by the beams and pixels they get",
        lambda traffic: _objects("ap", traffic, 1.0),
    ),
    RankedScore("mean height", "how high the LiDARs are mounted: no score at all", _height),
)
"""The scores of this project, and the simplest rival."""


def surrogate(name: str) -> Ranked:
    """Return the authors' own score of that name; it is of the class alone."""

    def ranked(
        paper: Paper, placement: str, reading: str, cls: str, variant: ScoreChoice, values: Values
    ) -> float:
        return float(paper.surrogates[name][cls][placement])

    return ranked


def candidates_of(paper: Paper) -> tuple[RankedScore, ...]:
    """Return the scores that a paper's results are held against, its own ones last."""
    own = (
        RankedScore(f"{name} ({paper.short})", "the authors' own", surrogate(name))
        for name in paper.surrogates
    )
    return (*CANDIDATES, *own)
