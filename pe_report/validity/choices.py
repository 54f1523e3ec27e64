"""What had to be chosen for the scores, alike for both papers, and what else it might have been.

The first value of each is the one that the scores are correlated with; with the others, one at a
time, they are only shown. All of it stood here before the first score was correlated with a result.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

import pe_core as pe
from pe_core.kinds import all_carried_over
from pe_core.metric import POINTPILLARS

from ..problems import STUDIES

Floats3 = Sequence[float] | np.ndarray

BODY_M = (4.902, 2.128, 1.511)
"""Length, width, height of the simulated Lincoln MKZ 2017, as the repositories have them."""

BODIES = ("box", "none", "sedan")
"""What hides: a box of `BODY_M`; nothing; the sedan that comes with the project."""
DENSITIES = (1.0, 0.5, 2.0)
"""Factor on how many objects stand round the vehicle at once."""
CURVES = ("fitted", "carried over")
"""AP curves of objects: those of the project; or, for LiDARs too, the paper's curve of a voxel
carried over to the size of a class."""
PARTS = ("own class", "all classes")
"""Which part of a score is held against a class's AP: its own, or that of the whole rig."""


@dataclass(frozen=True)
class ScoreChoice:
    """One way to choose what had to be chosen."""

    body: str = BODIES[0]
    density: float = DENSITIES[0]
    curves: str = CURVES[0]
    part: str = PARTS[0]

    @property
    def name(self) -> str:
        """What differs from the first choice; empty for that itself."""
        first = BASE
        said = []
        if self.body != first.body:
            said.append(f"body: {self.body}")
        if self.density != first.density:
            said.append(f"{self.density:g} times the traffic")
        if self.curves != first.curves:
            said.append("the paper's curves for objects")
        if self.part != first.part:
            said.append(self.part)
        return ", ".join(said)


BASE = ScoreChoice()


def variants(every: bool) -> Iterator[ScoreChoice]:
    """Yield the first choice, then, if asked, all that differ from it in one thing."""
    yield BASE
    if every:
        yield from (replace(BASE, body=body) for body in BODIES[1:])
        yield from (replace(BASE, density=factor) for factor in DENSITIES[1:])
        yield from (replace(BASE, curves=curves) for curves in CURVES[1:])
        yield from (replace(BASE, part=part) for part in PARTS[1:])


def body_of(name: str) -> pe.Vehicle | None:
    """Return the body by its name."""
    if name == "none":
        return None
    if name == "sedan":
        mesh = pe.read_mesh(STUDIES.parent / "sedan.npz")
        return pe.Vehicle(mesh.triangles, mesh.parts, mesh.part_names)
    half = BODY_M[2] / 2.0
    return pe.Vehicle(box_triangles((0.0, 0.0, half), BODY_M, 0.0))


def prior_of(density: float) -> pe.Prior:
    """Return the road prior, with so many times the documented number of objects at once."""
    road = pe.Prior.road()
    at_once = road.objects_at_once(pe.PerceptionSpace())
    return replace(road, density=tuple((name, count * density) for name, count in at_once.items()))


def curves_of(name: str) -> dict[str, dict[str, pe.ApCurve]]:
    """Return the AP curves of objects that differ from the project's own."""
    if name == CURVES[0]:
        return {}
    return {"lidar": all_carried_over(POINTPILLARS)}


def box_triangles(center: Floats3, size: Floats3, yaw: float) -> np.ndarray:
    """Return the (12, 3, 3) triangles of an upright box [m, rad], outward."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    corners = signs * np.asarray(size) / 2.0
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    corners[:, :2] = corners[:, :2] @ turn.T
    return (corners + np.asarray(center))[FACES]


FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5)),  # rear, front
        *((0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)),  # right, left
        *((0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),  # below, above
    ]
)
"""Corners of a box's triangles; a corner's number has a bit for x, y and z."""
