"""Published placements and AP of detectors, and the scores compared with them.

All that had to be chosen was fixed before the first score was correlated with a result. The first
value of each choice is the one that the correlations are computed with. The other values, one at a
time, only show how far the correlations depend on the choice.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_core.metric import POINTPILLARS
from pe_core.sensors import derived_object_curves

from ..paper.paper import STUDIES
from ..results_file import Values, read_json

TABLE = Path(__file__).parent / "data" / "published_placements.json"
DEGREES = "degrees"
RADIANS = "radians"
READINGS = (DEGREES, RADIANS)
"""The units that a printed roll may have."""
CLEAN = "clean"
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
ALONE = "alone"
TRAFFIC = "traffic"
"""Whether voxels and objects are occluded by the vehicle only, or by other road users too."""
BOX_FACES = np.array(
    [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),  # rear, front
        (0, 4, 5),
        (0, 5, 1),
        (2, 3, 7),
        (2, 7, 6),  # right, left
        (0, 2, 6),
        (0, 6, 4),
        (1, 5, 7),
        (1, 7, 3),  # below, above
    ]
)
"""Corners of a box's triangles, (12, 3); the number of a corner has one bit each for x, y and z."""
OBJECTS = "objects"
HEIGHT = "height"


@dataclass(frozen=True)
class Paper:
    """A paper's placements and results, as the table of data has them.

    `read` names the tables that figures were read from, `notes` what is uncertain about them;
    `classes` has the paper's names of the classes. All LiDARs are equal. AP is by condition,
    detector, class and placement; `surrogates` are the authors' own scores, higher for better.
    """

    id: str
    short: str
    citation: str
    repository: str
    read: str
    notes: tuple[str, ...]
    classes: Mapping[str, str]
    lidar: Mapping[str, float]
    placements: Mapping[str, list[dict[str, Any]]]
    ap: Mapping[str, Mapping[str, Mapping[str, Mapping[str, float]]]]
    surrogates: Mapping[str, Mapping[str, Mapping[str, float]]]

    def rolled(self, placement: str) -> bool:
        """Return whether a placement has a LiDAR with a printed roll."""
        return any("roll_printed" in sensor for sensor in self.placements[placement])

    def readings(self, placement: str) -> tuple[str, ...]:
        """Return the readings that differ for a placement: one if it has no rolls."""
        return READINGS if self.rolled(placement) else READINGS[:1]

    def rig(self, placement: str, reading: str) -> pe.Rig:
        """Return a placement's sensors, with its printed rolls in the unit of a reading."""
        sensors = (self._sensor(row, reading) for row in self.placements[placement])
        return pe.Rig(list(sensors))

    def height(self, placement: str) -> float:
        """Return the mean height of the LiDARs [m]."""
        rows = self.placements[placement]
        return float(np.mean([row["position"][2] for row in rows if row["kind"] == "lidar"]))

    def _sensor(self, row: Mapping[str, Any], reading: str) -> pe.Sensor:
        if row["kind"] == "camera":
            rotation = (0.0, 0.0, row["yaw_deg"])
            return pe.Sensor(
                row["name"], _camera(row), pe.Pose.from_degrees(row["position"], rotation)
            )
        printed = row.get("roll_printed", 0.0)
        roll = printed if reading == DEGREES else math.degrees(printed)
        pose = pe.Pose.from_degrees(row["position"], (roll, 0.0, 0.0))
        return pe.Sensor(row["name"], self._lidar, pose)

    @property
    def _lidar(self) -> pe.Lidar:
        data = self.lidar
        channels = int(data["channels"])
        elevations = np.radians(np.linspace(data["low_deg"], data["high_deg"], channels))
        name = f"{self.short} LiDAR"
        return pe.Lidar(name, elevations, int(data["azimuth_count"]), data["max_range_m"])


def _camera(row: Mapping[str, Any]) -> pe.Camera:
    width, height = row["image"]
    hfov_deg = row["hfov_deg"]
    return pe.Camera(f"camera of {hfov_deg} deg", width, height, math.radians(hfov_deg))


@cache
def papers() -> tuple[Paper, ...]:
    """Return the papers of the project's table of published placements."""
    return tuple(
        Paper(**{**row, "notes": tuple(row["notes"])}) for row in read_json(TABLE)["papers"]
    )


def paper_of(name: str) -> Paper:
    """Return a paper by its id."""
    return next(paper for paper in papers() if paper.id == name)


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
        differences = {
            "body": f"body: {self.body}",
            "density": f"{self.density:g} times the traffic",
            "curves": "the paper's curves for objects",
            "part": self.part,
        }
        return ", ".join(w for k, w in differences.items() if getattr(self, k) != getattr(BASE, k))


BASE = ScoreChoice()
"""The first value of each choice."""


def variants(all_variants: bool) -> Iterator[ScoreChoice]:
    """Yield `BASE`, and with `all_variants` all choices that differ from it in one value."""
    yield BASE
    others: dict[str, tuple[Any, ...]] = {
        "body": BODIES,
        "density": DENSITIES,
        "curves": CURVES,
        "part": PARTS,
    }
    for key, values in others.items() if all_variants else ():
        yield from (replace(BASE, **{key: value}) for value in values[1:])


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


@dataclass(frozen=True)
class RankedScore:
    """A score that is compared with AP: where its values are.

    `source` is a prior (of voxels), `OBJECTS`, `HEIGHT` or the name of an authors' own score.
    """

    name: str
    source: str
    key: str = ""
    sign: float = 1.0
    traffic: str = ALONE

    def value(self, rating: Rating, values: Values) -> float:
        """Return the score of a placement, higher for better, from the computed values."""
        paper = rating.paper
        choice = rating.choice
        if self.source == HEIGHT:
            return paper.height(rating.placement)
        if self.source in paper.surrogates:
            return float(paper.surrogates[self.source][rating.cls][rating.placement])
        if self.source == OBJECTS:
            whole = values[object_name(*rating.key, self.traffic, choice)]
        else:
            whole = values[voxel_name(*rating.key, self.traffic, choice)][self.source]
        of_class = whole["per_class"].get(rating.cls, whole)  # the uniform prior has no classes
        return self.sign * float((of_class if choice.part == PARTS[0] else whole)[self.key])


OWN = (
    RankedScore("perception entropy, road prior", "road", "entropy", -1.0),
    RankedScore("perception entropy, uniform prior", "uniform", "entropy", -1.0),
    RankedScore("coverage", "road", "coverage"),
    RankedScore("object entropy", OBJECTS, "entropy", -1.0),
    RankedScore("expected AP", OBJECTS, "ap"),
)
CANDIDATES = (
    *(
        score
        for alone in OWN
        for score in (alone, replace(alone, name=f"{alone.name}, in traffic", traffic=TRAFFIC))
    ),
    RankedScore("mean height", HEIGHT),
)
"""The scores of this project, alone and among other road users, and the simplest alternative."""


def candidates_of(paper: Paper) -> tuple[RankedScore, ...]:
    """Return the scores that a paper's results are compared with, the authors' own ones last."""
    own = (RankedScore(f"{name} ({paper.short})", name) for name in paper.surrogates)
    return (*CANDIDATES, *own)
