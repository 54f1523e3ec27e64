"""A study: everything a run needs, and the one thing every front end hands on.

Panel, headless Blender and the command line all build a `Study` and give it to the same jobs, which
is why they agree to the bit.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from ..kinds import PerceptionModel
from ..prior.prior import Prior
from ..scene.sensors import Rig
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from ..scoring.evaluator import Evaluator
from ..search.optimize import Schedule, SearchSpace

DEFAULT_SEARCH_SAMPLES = 65_536


@dataclass(frozen=True, slots=True)
class Search:
    """How to optimize.

    Parameters
    ----------
    free : mapping of sensor name to axes
        Which of x, y, z, roll, pitch, yaw each sensor may change.
    limits : mapping of sensor name to mapping of axis to (low, high)
        Bounds that replace the default ones; metres and degrees.
    seed : int
    samples : int
        Voxels a candidate is judged on; 0 for the whole grid.
    schedule : Schedule
    """

    free: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    limits: Mapping[str, Mapping[str, tuple[float, float]]] = field(default_factory=dict)
    seed: int = 0
    samples: int = DEFAULT_SEARCH_SAMPLES
    schedule: Schedule = field(default_factory=Schedule)


@dataclass(frozen=True, eq=False)
class Study:
    """Space, prior, perception model, vehicle, rig, and how to search.

    `mesh` names the file the vehicle was read from (or is written to); `samples` is the number of
    voxels a score looks at, 0 for all of them.
    """

    rig: Rig
    vehicle: Vehicle | None = None
    space: PerceptionSpace = field(default_factory=PerceptionSpace)
    prior: Prior = field(default_factory=Prior.road)
    model: PerceptionModel = field(default_factory=PerceptionModel)
    search: Search = field(default_factory=Search)
    samples: int = 0
    mesh: str | None = None

    def evaluator(self, samples: int | None = None, workers: int | None = None) -> Evaluator:
        """Return the evaluator of this study; `samples` replaces the study's own."""
        return Evaluator(
            self.space,
            self.prior,
            self.vehicle,
            samples=self.samples if samples is None else samples,
            model=self.model,
            workers=workers,
        )

    def search_space(self) -> SearchSpace:
        """Return free axes and bounds, in radians."""
        limits = {
            name: {a: _to_radians(a, bounds) for a, bounds in axes.items()}
            for name, axes in self.search.limits.items()
        }
        return SearchSpace.on_vehicle(self.rig, self.vehicle, self.search.free, limits)

    def with_rig(self, rig: Rig) -> Study:
        """Return the study with other placements."""
        return replace(self, rig=rig)

    def with_mesh(self, mesh: str) -> Study:
        """Return the study with the vehicle's mesh file named."""
        return replace(self, mesh=mesh)


def vehicle_digest(vehicle: Vehicle | None) -> str | None:
    """SHA-256 of the vehicle's triangles: tells whether two runs saw the same body."""
    return None if vehicle is None else hashlib.sha256(vehicle.triangles.tobytes()).hexdigest()


def _to_radians(axis: str, bounds: tuple[float, float]) -> tuple[float, float]:
    if axis in "xyz":
        return bounds
    return math.radians(bounds[0]), math.radians(bounds[1])
