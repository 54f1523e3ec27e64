"""Algorithm 1 of the paper: random search in a shrinking neighbourhood, as a generator of steps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..errors import InputError
from ..scene.geometry import Pose
from ..scene.sensors import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..scoring.evaluator import Evaluator

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
PAPER_FREE = ("x", "y", "z", "pitch")
"""What the paper searches; roll and yaw are fixed "for symmetry of the placement"."""
POSITION_DECIMALS = 5
ANGLE_DECIMALS_DEG = 4
"""Placements are rounded to 0.01 mm and 0.0001 deg: a file, or Blender's single precision, then
holds exactly the placement that was scored."""
HEADROOM_M = 0.75
"""How far above the vehicle's top a sensor may be put unless a study says otherwise."""
LOWEST_M = 0.2
"""No sensor is put lower than this unless a study says otherwise."""

Bounds = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Schedule:
    """Neighbourhoods and candidates of Algorithm 1; the paper's by default.

    Parameters
    ----------
    candidates : int
        Placements tried in each round.
    reach_m, reach_rad : float
        Half width of the first neighbourhood.
    floor_m, floor_rad : float
        The search ends when a neighbourhood is at or below this.
    decay : float
        k: each neighbourhood is this times the one before.
    """

    candidates: int = 1000
    reach_m: float = 1.0
    reach_rad: float = math.radians(30.0)
    floor_m: float = 0.01
    floor_rad: float = math.radians(0.3)
    decay: float = 0.5

    def __post_init__(self) -> None:
        if self.candidates < 1:
            raise InputError("optimize", "candidates", "at least 1", self.candidates)
        if not 0.0 < self.decay < 1.0:
            raise InputError("optimize", "decay", "a number between 0 and 1", self.decay)

    @property
    def scales(self) -> list[float]:
        """Factor on the first neighbourhood in each round: 1, k, k^2, ... (seven in the paper)."""
        scales, scale = [], 1.0
        while scale * self.reach_m > self.floor_m or scale * self.reach_rad > self.floor_rad:
            scales.append(scale)
            scale *= self.decay
        return scales


@dataclass(frozen=True, slots=True)
class SearchSpace:
    """Which coordinates of which sensor are free, and how far they may go.

    Parameters
    ----------
    bounds : mapping of sensor name to mapping of axis to (low, high)
        Axes are "x", "y", "z" [m] and "roll", "pitch", "yaw" [rad]; what is not named is fixed.
    """

    bounds: Mapping[str, Mapping[str, Bounds]] = field(default_factory=dict)

    @classmethod
    def on_vehicle(
        cls,
        rig: Rig,
        vehicle: Vehicle | None,
        free: Mapping[str, tuple[str, ...]] | tuple[str, ...] = PAPER_FREE,
        limits: Mapping[str, Mapping[str, Bounds]] | None = None,
    ) -> SearchSpace:
        """Free axes of each sensor within the vehicle's outline and HEADROOM_M above it.

        Parameters
        ----------
        rig : Rig
        vehicle : Vehicle or None
            Without one, sensors may go `Schedule.reach_m` from where they start.
        free : tuple of str, or mapping of sensor name to it
        limits : mapping, optional
            Bounds that replace the default ones, by sensor and axis.
        """
        limits = limits or {}
        bounds = {}
        for sensor in rig:
            axes = free if isinstance(free, tuple) else free.get(sensor.name, PAPER_FREE)
            own = limits.get(sensor.name, {})
            default = default_bounds(sensor, vehicle)
            bounds[sensor.name] = {a: own.get(a, default[a]) for a in axes}
        return cls(bounds).checked(rig)

    def checked(self, rig: Rig) -> SearchSpace:
        """Return itself, or raise `InputError` when a name, an axis or a start is not possible."""
        for name, axes in self.bounds.items():
            if name not in [s.name for s in rig]:
                raise InputError("search space", "sensor", "a sensor of the rig", repr(name))
            start = pose_values(rig[name].pose)
            for axis, (low, high) in axes.items():
                if axis not in AXES:
                    raise InputError(name, "free", f"some of {', '.join(AXES)}", repr(axis))
                if not low <= start[axis] <= high:
                    expected = f"bounds around the start, {_shown(axis, start[axis])}"
                    found = f"{_shown(axis, low)} to {_shown(axis, high)}"
                    raise InputError(name, f"bounds of {axis}", expected, found)
        return self


@dataclass(frozen=True, slots=True)
class Step:
    """One candidate tried.

    Attributes
    ----------
    best : Rig
        The best placement so far.
    entropy : float
        Its perception entropy [nats].
    evaluations : int
        Rigs scored so far, the start included.
    fraction : float
        How much of the search is done, 0 to 1.
    round : int
        Round, from 0.
    improved : bool
        Whether this candidate became the best.
    """

    best: Rig
    entropy: float
    evaluations: int
    fraction: float
    round: int
    improved: bool


def optimize(
    evaluator: Evaluator,
    rig: Rig,
    search_space: SearchSpace,
    seed: int = 0,
    schedule: Schedule | None = None,
) -> Iterator[Step]:
    """Search for the placement of lowest perception entropy; yields a step a candidate.

    Round by round, candidates are drawn uniformly in the neighbourhood of the best placement found
    before the round, each coordinate clipped to its bounds; the neighbourhood then shrinks. Stop
    whenever you like: the last step holds the best so far.

    Parameters
    ----------
    evaluator : Evaluator
    rig : Rig
        Where the search starts.
    search_space : SearchSpace
    seed : int
        The same seed gives the same steps.
    schedule : Schedule, optional
        The paper's by default: seven rounds of 1000 candidates.
    """
    search_space.checked(rig)
    schedule = schedule or Schedule()
    rng = np.random.default_rng(seed)
    best, entropy, count = rig, evaluator.entropy(rig), 1
    yield Step(best, entropy, count, 0.0, 0, False)
    if not any(search_space.bounds.values()):
        return
    total = len(schedule.scales) * schedule.candidates
    for number, scale in enumerate(schedule.scales):
        center = best
        for _ in range(schedule.candidates):
            candidate = _neighbour(center, search_space, schedule, scale, rng)
            found = evaluator.judge(candidate, below=entropy)
            improved = found.entropy < entropy
            if improved:
                best, entropy = candidate, found.entropy
            count += 1
            yield Step(best, entropy, count, (count - 1) / total, number, improved)


def pose_values(pose: Pose) -> dict[str, float]:
    """Return a pose by axis: x, y, z [m], roll, pitch, yaw [rad]."""
    return dict(zip(AXES, (*pose.position, *pose.rpy), strict=True))


def pose_from_values(values: Mapping[str, float]) -> Pose:
    """Pose from its axes, rounded as placements are."""
    position = [round(values[a], POSITION_DECIMALS) + 0.0 for a in AXES[:3]]
    degrees = [round(math.degrees(values[a]), ANGLE_DECIMALS_DEG) + 0.0 for a in AXES[3:]]
    return Pose.from_degrees(position, degrees)


def default_bounds(sensor: Sensor, vehicle: Vehicle | None) -> dict[str, Bounds]:
    """How far a sensor may go when nobody says: always far enough to hold where it starts."""
    start = pose_values(sensor.pose)
    if vehicle is None:
        reach = Schedule().reach_m
        bounds = {a: (start[a] - reach, start[a] + reach) for a in "xyz"}
    else:
        low, high = vehicle.bounds
        bounds = {a: (float(low[k]), float(high[k])) for k, a in enumerate("xy")}
        bounds["z"] = (LOWEST_M, float(high[2]) + HEADROOM_M)
    bounds |= {"roll": (-math.pi, math.pi), "yaw": (-math.pi, math.pi)}
    bounds["pitch"] = (-math.pi / 2, math.pi / 2)
    return {a: (min(lo, start[a]), max(hi, start[a])) for a, (lo, hi) in bounds.items()}


def _neighbour(
    center: Rig,
    search_space: SearchSpace,
    schedule: Schedule,
    scale: float,
    rng: np.random.Generator,
) -> Rig:
    poses = []
    for sensor in center:
        values = pose_values(sensor.pose)
        axes = search_space.bounds.get(sensor.name, {})
        for axis in AXES:
            if axis in axes:
                reach = schedule.reach_m if axis in "xyz" else schedule.reach_rad
                low, high = axes[axis]
                moved = values[axis] + scale * reach * rng.uniform(-1.0, 1.0)
                values[axis] = min(max(moved, low), high)
        poses.append(pose_from_values(values) if axes else sensor.pose)
    return center.with_poses(poses)


def _shown(axis: str, value: float) -> str:
    return f"{value:g} m" if axis in "xyz" else f"{math.degrees(value):g} deg"
