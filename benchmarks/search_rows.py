"""What a search's candidates cost near the optimum, where no bound tells them apart."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from unittest.mock import patch

import numpy as np

import pe_core as pe
from pe_core.kinds.lidar import known
from pe_core.kinds.lidar.ends import KnownEnds
from pe_core.search import judge_all, started

from .timing import Timing, best_in_turn, peak_mb

EXPERIMENT = Path(__file__).parents[1] / "blend_assets" / "experiments" / "4_cameras.toml"
FOUND = {
    "lidar_a": ((3.02423, 1.01, 1.16676), (0.0, -0.3135, 0.0)),
    "lidar_b": ((3.01498, -1.006, 1.20498), (0.0, -0.428, 0.0)),
    "camera_front": ((3.03, 0.19877, 1.11809), (0.0, -2.3349, 0.0)),
    "camera_rear": ((-3.01305, -0.06698, 1.48322), (0.0, 1.7885, 180.0)),
}
"""Where a search ended (docs/reproduction/results.json, search/4_cameras/road/front/0)."""
SAMPLES = 32_768
CANDIDATES = 8
SPREAD_M, SPREAD_DEG = 0.03, 0.5


def candidate() -> Timing:
    """Candidates of experiment 4 near its optimum, against the same with every beam cast."""
    study = pe.load_study(EXPERIMENT)
    evaluator, rigs = study.evaluator(SAMPLES), list(_near_the_optimum(study))
    with patch.object(known, "LazyEnds", _all_cast):
        expected = [evaluator.entropy(rig) for rig in rigs]
    if [evaluator.entropy(rig) for rig in rigs] != expected:
        raise SystemExit("every beam cast gives another entropy")

    def plain() -> None:
        with patch.object(known, "LazyEnds", _all_cast):
            judge_all(evaluator, rigs)

    ours, theirs = best_in_turn(lambda: judge_all(evaluator, rigs), plain)
    work = f"{CANDIDATES} candidates near the optimum of experiment 4, {SAMPLES:,} samples"
    return Timing(work, ours, peak_mb(), "every beam cast", theirs)


def candidates_in_processes() -> Timing:
    """The same by a process a processor, against this one alone."""
    study = pe.load_study(EXPERIMENT)
    evaluator, rigs = study.evaluator(SAMPLES), list(_near_the_optimum(study))
    pool = started()
    if pool is None:
        raise SystemExit("no processes can be started")
    with pool:
        judge_all(evaluator, rigs, executor=pool)  # each has the objective now
        ours, theirs = best_in_turn(
            lambda: judge_all(evaluator, rigs, executor=pool), lambda: judge_all(evaluator, rigs)
        )
    return Timing("the same, a process a processor", ours, peak_mb(), "one process", theirs)


def _all_cast(sensor: pe.Sensor, beams: object, vehicle: pe.Vehicle) -> KnownEnds:
    """Return the ends of a LiDAR's beams the plain way."""
    return KnownEnds(pe.beam_field(sensor, vehicle).ends)


def _near_the_optimum(study: pe.Study) -> Iterator[pe.Rig]:
    """Yield rigs scattered about the place where a search ended."""
    rng = np.random.default_rng(0)
    for _ in range(CANDIDATES):
        poses = []
        for sensor in study.rig:
            place, turn = FOUND[sensor.name]
            moved = np.add(place, SPREAD_M * rng.normal(size=3))
            turned = np.add(turn, [0.0, SPREAD_DEG * rng.normal(), 0.0])
            poses.append(pe.Pose.from_degrees(moved.tolist(), turned.tolist()))
        yield study.rig.with_poses(poses)
