"""Algorithm 1 of the paper: random search in a shrinking neighbourhood, as a generator of steps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..scene.sensors import Rig
from ..scoring.evaluator import Evaluator
from .schedule import Schedule
from .search_space import AXES, POSITION_AXES, SearchSpace, pose_from_values, pose_values


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
                reach = schedule.reach_m if axis in POSITION_AXES else schedule.reach_rad
                low, high = axes[axis]
                moved = values[axis] + scale * reach * rng.uniform(-1.0, 1.0)
                values[axis] = min(max(moved, low), high)
        poses.append(pose_from_values(values) if axes else sensor.pose)
    return center.with_poses(poses)
