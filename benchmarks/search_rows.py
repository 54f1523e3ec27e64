"""What a search's candidates cost near the optimum, where no bound tells them apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_core.search import as_objective, evaluate_all, start_processes

from .timing import Timing, best_in_turn, best_of_processor, peak_mb, timed

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
TRAFFIC_REPEATS = 2
LONGEST_S = 90.0
SPREAD_M = 0.03
SPREAD_DEG = 0.5


def candidate() -> Timing:
    """Candidates of experiment 4 near its optimum, against casting their LiDARs' beams alone."""
    study = pe.load_study(EXPERIMENT)
    evaluator = study.evaluator(SAMPLES)
    rigs = list(_near_the_optimum(study))
    lidars = [sensor for rig in rigs for sensor in rig if sensor.kind == "lidar"]

    def every_beam() -> None:
        for sensor in lidars:
            assert len(pe.beam_field(sensor, study.vehicle).ends)

    ours, theirs = best_in_turn(lambda: evaluate_all(as_objective(evaluator), rigs), every_beam)
    work = f"{CANDIDATES} candidates near the optimum of experiment 4, {SAMPLES:,} samples"
    return Timing(work, ours, peak_mb(), "first hits of all their beams", yardstick_s=theirs)


def candidates_in_traffic() -> Timing:
    """Candidates scored by objects that occlude each other, against the voxels of a search."""
    study = pe.load_study(EXPERIMENT)
    targets = pe.TargetRule("objects", traffic=True)
    evaluates = [
        each.evaluator(study.search.samples) for each in (replace(study, targets=targets), study)
    ]
    rigs = list(_near_the_optimum(study))
    ours, theirs = (
        best_of_processor(
            lambda evaluator=evaluator: evaluate_all(as_objective(evaluator), rigs), TRAFFIC_REPEATS
        )
        for evaluator in evaluates
    )
    work = f"8 candidates by {targets.scenes} scenes of objects in traffic, processor time"
    yardstick = f"by {study.search.samples:,} samples"
    return Timing(work, ours, peak_mb(), yardstick, yardstick_s=theirs)


def search_in_traffic() -> Timing:
    """A whole search of experiment 4's rig by expected AP in traffic, against 90 s at most."""
    study = pe.load_study(EXPERIMENT)
    by_ap = replace(study, search=replace(study.search, objective="expected_ap"))
    seconds, _ = timed(lambda: list(pt.OptimizeJob(by_ap)))
    work = f"`pe optimize` of experiment 4 by expected AP, {study.targets.scenes} scenes in traffic"
    return Timing(work, seconds, peak_mb(), "what it may take", yardstick_s=LONGEST_S)


def candidates_in_processes() -> Timing:
    """The same by a process a processor, against this one alone."""
    study = pe.load_study(EXPERIMENT)
    evaluator = study.evaluator(SAMPLES)
    rigs = list(_near_the_optimum(study))
    pool = start_processes()
    if pool is None:
        raise SystemExit("no processes can be started")
    with pool:
        evaluate_all(as_objective(evaluator), rigs, executor=pool)  # each has the objective now
        ours, theirs = best_in_turn(
            lambda: evaluate_all(as_objective(evaluator), rigs, executor=pool),
            lambda: evaluate_all(as_objective(evaluator), rigs),
        )
    return Timing(
        "the same, a process a processor", ours, peak_mb(), "one process", yardstick_s=theirs
    )


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
