"""The scores that are compared, and what had to be chosen for them, alike for both papers.

All of it was fixed before the first score was correlated with a result. The first value of each
choice is the one that the correlations are computed with. The other values, one at a time, only
show how far the correlations depend on the choice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_core.metric import POINTPILLARS
from pe_core.sensors import derived_object_curves

from ..paper.paper import STUDIES
from ..results_file import Values
from .published import Paper

NumberVector = Sequence[float] | np.ndarray

BODY_M = (4.902, 2.128, 1.511)
"""Length, width, height of the simulated Lincoln MKZ 2017, as in the papers' repositories."""

BODIES = ("box", "none", "sedan")
"""The body that occludes: a box of `BODY_M`; nothing; the sedan that comes with the project."""
DENSITIES = (1.0, 0.5, 2.0)
"""Factor on the number of objects that are around the vehicle at once."""
CURVES = ("fitted", "carried over")
"""AP curves of objects: those of the project; or, for LiDARs too, the paper's curve of a voxel
carried over to the size of a class."""
PARTS = ("own class", "all classes")
"""The part of a score that is compared with the AP of a class: that of the class, or the whole."""
ALONE, TRAFFIC = "alone", "traffic"
"""Whether voxels and objects are occluded by the vehicle only, or by other road users too."""

BOX_FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5)),  # rear, front
        *((0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)),  # right, left
        *((0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),  # below, above
    ]
)
"""Corners of a box's triangles, (12, 3); the number of a corner has one bit each for x, y and z."""


@dataclass(frozen=True)
class ScoreChoice:
    """A value for each choice that the scores need."""

    body: str = BODIES[0]
    density: float = DENSITIES[0]
    curves: str = CURVES[0]
    part: str = PARTS[0]

    @property
    def name(self) -> str:
        """The differences from `BASE`, in words; empty for `BASE` itself."""
        differences = []
        if self.body != BASE.body:
            differences.append(f"body: {self.body}")
        if self.density != BASE.density:
            differences.append(f"{self.density:g} times the traffic")
        if self.curves != BASE.curves:
            differences.append("the paper's curves for objects")
        if self.part != BASE.part:
            differences.append(self.part)
        return ", ".join(differences)


BASE = ScoreChoice()
"""The first value of each choice."""


def variants(all_variants: bool) -> Iterator[ScoreChoice]:
    """Yield `BASE`, and with `all_variants` all choices that differ from it in one value."""
    yield BASE
    if all_variants:
        yield from (replace(BASE, body=body) for body in BODIES[1:])
        yield from (replace(BASE, density=factor) for factor in DENSITIES[1:])
        yield from (replace(BASE, curves=curves) for curves in CURVES[1:])
        yield from (replace(BASE, part=part) for part in PARTS[1:])


def body_of(name: str) -> pe.Vehicle | None:
    """Return one of `BODIES`; None for "none"."""
    if name == "none":
        return None
    if name == "sedan":
        mesh = pt.read_mesh(STUDIES.parent / "sedan.npz")
        return pe.Vehicle(mesh.triangles, mesh.parts, mesh.part_names)
    half = BODY_M[2] / 2.0
    return pe.Vehicle(box_triangles((0.0, 0.0, half), BODY_M, 0.0))


def prior_of(density: float) -> pe.Prior:
    """Return the road prior with the documented number of objects at once, times a factor."""
    road = pe.Prior.road()
    at_once = road.objects_at_once(pe.PerceptionSpace())
    return replace(road, density=tuple((name, count * density) for name, count in at_once.items()))


def curves_of(name: str) -> dict[str, dict[str, pe.ApCurve]]:
    """Return the AP curves of objects that differ from the project's own, by kind and class."""
    if name == CURVES[0]:
        return {}
    return {"lidar": derived_object_curves(POINTPILLARS)}


def box_triangles(center: NumberVector, size: NumberVector, yaw: float) -> np.ndarray:
    """Return the (12, 3, 3) triangles of an upright box [m, rad], with normals outward."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    corners = signs * np.asarray(size) / 2.0
    rotation = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    corners[:, :2] = corners[:, :2] @ rotation.T
    return (corners + np.asarray(center))[BOX_FACES]


def voxel_name(paper: str, placement: str, reading: str, traffic: str, choice: ScoreChoice) -> str:
    """Return the task's name of a placement's voxel scores; only in traffic it has the density."""
    density = f"/{choice.density:g}" if traffic == TRAFFIC else ""
    return f"voxels/{traffic}/{paper}/{placement}/{reading}/{choice.body}{density}"


def object_name(paper: str, placement: str, reading: str, traffic: str, choice: ScoreChoice) -> str:
    """Return the task's name of a placement's object scores."""
    chosen = f"{choice.body}/{choice.density:g}/{choice.curves}"
    return f"objects/{traffic}/{paper}/{placement}/{reading}/{chosen}"


@dataclass(frozen=True)
class Rating:
    """What a score is asked to rate: a placement, its rolls in a reading, for the AP of a class."""

    paper: Paper
    placement: str
    reading: str
    cls: str
    choice: ScoreChoice = BASE

    @property
    def key(self) -> tuple[str, str, str]:
        """Paper, placement and reading, as the names of tasks have them."""
        return self.paper.id, self.placement, self.reading


ScoreFunction = Callable[[Rating, Values], float]
"""Returns the value of a score, higher for better, from the computed values."""


@dataclass(frozen=True)
class RankedScore:
    """A score that is compared with AP: what it is, and its value, higher for better."""

    name: str
    about: str
    value: ScoreFunction


def _voxel_score(prior: str, key: str, traffic: str, sign: float) -> ScoreFunction:
    def value(rating: Rating, values: Values) -> float:
        score = values[voxel_name(*rating.key, traffic, rating.choice)][prior]
        of_class = score["per_class"].get(rating.cls, score)  # the uniform prior has no classes
        part = of_class if rating.choice.part == PARTS[0] else score
        return sign * float(part[key])

    return value


def _object_score(key: str, traffic: str, sign: float) -> ScoreFunction:
    def value(rating: Rating, values: Values) -> float:
        score = values[object_name(*rating.key, traffic, rating.choice)]
        part = score["per_class"][rating.cls] if rating.choice.part == PARTS[0] else score
        return sign * float(part[key])

    return value


def _mean_height(rating: Rating, values: Values) -> float:
    return rating.paper.height(rating.placement)


def _alone_and_in_traffic(
    name: str, about: str, score: Callable[[str], ScoreFunction]
) -> list[RankedScore]:
    return [
        RankedScore(name, about, score(ALONE)),
        RankedScore(f"{name}, in traffic", "the same among other road users", score(TRAFFIC)),
    ]


CANDIDATES = (
    *_alone_and_in_traffic(
        "perception entropy, road prior",
        "the paper's score of voxels, over where cars, cyclists and pedestrians are met",
        lambda traffic: _voxel_score("road", "entropy", traffic, -1.0),
    ),
    *_alone_and_in_traffic(
        "perception entropy, uniform prior",
        "the paper's score with every voxel counted alike",
        lambda traffic: _voxel_score("uniform", "entropy", traffic, -1.0),
    ),
    *_alone_and_in_traffic(
        "coverage",
        "the share of the road prior that any sensor meets",
        lambda traffic: _voxel_score("road", "coverage", traffic, 1.0),
    ),
    *_alone_and_in_traffic(
        "object entropy",
        "entropy of whole objects, by the beams and pixels they get",
        lambda traffic: _object_score("entropy", traffic, -1.0),
    ),
    *_alone_and_in_traffic(
        "expected AP",
        "mean AP of objects, by the beams and pixels they get",
        lambda traffic: _object_score("ap", traffic, 1.0),
    ),
    RankedScore("mean height", "how high the LiDARs are mounted: no score at all", _mean_height),
)
"""The scores of this project, and the simplest alternative."""


def _authors_score(name: str) -> ScoreFunction:
    def value(rating: Rating, values: Values) -> float:
        return float(rating.paper.surrogates[name][rating.cls][rating.placement])

    return value


def candidates_of(paper: Paper) -> tuple[RankedScore, ...]:
    """Return the scores that a paper's results are compared with, the authors' own ones last."""
    authors_scores = (
        RankedScore(f"{name} ({paper.short})", "the authors' own", _authors_score(name))
        for name in paper.surrogates
    )
    return (*CANDIDATES, *authors_scores)
