"""The tasks' functions: from names and numbers to JSON data. They run in worker processes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np

import pe_core as pe
from pe_core.metric import H_BLIND
from pe_core.scoring import VoxelSample, draw
from pe_tools.formats import fit_ap_curve, read_ap_table
from pe_tools.jobs import placements
from pe_tools.plots.fitting import fit_data

from .analytic import expected_entropy, max_distance_for, max_unseen_share, min_entropy
from .paper import (
    EXPECTED_COUNTS,
    PITCH_HEIGHT_M,
    ROW,
    SETTINGS,
    study_of,
    with_pitch_difference,
    with_positions,
    with_prior,
    without_cameras,
)

Json = dict[str, Any]

DATA = Path(__file__).parent / "data"
SAMPLED_VOXELS = 1 << 16
"""Voxels sampled from the prior where a bound or an expectation is averaged."""
CURVE_M = (1.0, 80.0, 80)
"""First distance, last distance [m] and number of points of the curve of a bound."""
MAP_COLUMNS = 20
"""Columns of 0.1 m in a square of the priors' plots."""


def score(row: str, prior: str, samples: int, rig_of: str = "", lidars_only: bool = False) -> Json:
    """Score a row's rig at its printed placement, or another row's rig with this row's weights."""
    study = replace(with_prior(study_of(row), prior), samples=samples)
    if rig_of:
        study = study.with_rig(study_of(rig_of).rig)
    return _score_data(without_cameras(study) if lidars_only else study)


def search(
    row: str, prior: str, start: str, seed: int, candidates: int, search_samples: int, samples: int
) -> Json:
    """Run Algorithm 1 from a neutral start, and score the placement that it finds."""
    study = with_positions(with_prior(study_of(row), prior), ROW[row].starts[start])
    schedule = pe.Schedule(candidates=candidates)
    settings = replace(
        study.search, method="random", seed=seed, samples=search_samples, schedule=schedule
    )
    job = pe.OptimizeJob(replace(study, search=settings, samples=samples), workers=1)
    job.analyses = False
    for _ in job:
        pass
    outcome = job.outcome
    assert outcome is not None
    return {
        "entropy": outcome.after.entropy,
        "coverage": outcome.after.coverage,
        "start_entropy": outcome.before.entropy,
        "evaluations": outcome.evaluations,
        "placements": placements(outcome.study.rig),
    }


def pitch(difference_deg: float, samples: int) -> Json:
    """Score two equal LiDARs at one height: both fused, and each alone."""
    pair = study_of("3_default").with_rig(study_of("3_front").rig)
    study = with_pitch_difference(pair, PITCH_HEIGHT_M, difference_deg)
    study = replace(study, samples=samples)
    score = study.evaluator(workers=1).score(study.rig)
    alone = {name: part.entropy for name, part in score.per_sensor.items()}
    return {"entropy": score.entropy, "alone": alone}


def vary(row: str, setting: str, samples: int) -> Json:
    """Score a row of experiment 1 with one setting changed."""
    study = study_of(row)
    if setting != EXPECTED_COUNTS:
        return _score_data(replace(SETTINGS[setting](study), samples=samples))
    (sensor,) = study.rig
    lidar, position = cast(pe.Lidar, sensor.model), sensor.pose.position
    centers = _sample(replace(study, vehicle=None)).centers
    entropy = expected_entropy(lidar, position, centers, study.space.interval, study.model.lidar)
    return {"entropy": entropy, "coverage": None}


def bound(row: str, prior: str) -> Json:
    """Return lower bounds of a camera row's entropy, for its own field of view and for all round.

    Also what the printed figure would need: how near voxels must be, and how many must be seen.
    """
    study = with_prior(study_of(row), prior)
    (sensor,) = study.rig
    camera, curve, side = cast(pe.Camera, sensor.model), study.model.camera, study.space.interval
    sample = _sample(study)
    offsets = sample.centers - np.asarray(sensor.pose.position)
    distance = np.sqrt((offsets**2).sum(axis=1))
    least = min_entropy(camera, distance, side, curve)
    in_view = pe.measure(sensor, sample.centers, side) > 0.0
    printed = ROW[row].entropy
    farthest = max_distance_for(camera, printed, side, curve)
    return {
        "in_view": float(np.mean(in_view)),
        "least": float(np.mean(np.where(in_view, least, H_BLIND))),
        "least_all_round": float(np.mean(least)),
        "farthest_m": farthest,
        "nearer_than_that": float(np.mean(distance <= farthest)),
        "most_unseen": max_unseen_share(printed, camera, curve),
    }


def bound_curve(hfov_deg: int) -> Json:
    """Return the lowest possible entropy of a voxel by its distance, for a camera of the paper."""
    study = study_of("2_60deg")
    camera = cast(pe.Camera, pe.catalog.load(f"Camera {hfov_deg} deg"))
    distance = np.linspace(*CURVE_M[:2], CURVE_M[2])
    least = min_entropy(camera, distance, study.space.interval, study.model.camera)
    return {"distance_m": _rounded(distance), "entropy": _rounded(least)}


def prior_map(prior: str) -> Json:
    """Return a prior's density over the ground and over height, for a plot."""
    study = with_prior(study_of("1_pandar64"), prior)
    densities = study.prior.densities(study.space)
    ground = np.sum([d.ground for d in densities], axis=0)
    nx, ny = (n // MAP_COLUMNS for n in ground.shape)
    squares = ground.reshape(nx, MAP_COLUMNS, ny, MAP_COLUMNS).sum(axis=(1, 3))
    area = (MAP_COLUMNS * study.space.interval) ** 2
    height = np.sum([d.ground.sum() * d.profile for d in densities], axis=0)
    return {
        "classes": [d.name for d in densities],
        "ground": [_rounded(line) for line in squares / area],
        "height_m": _rounded(study.space.centers(2)),
        "height": _rounded(height / study.space.interval),
    }


def fit(table: str) -> Json:
    """Fit the AP curve to a table of the folder ``data``."""
    return fit_data(fit_ap_curve(read_ap_table(DATA / f"{table}.csv")))


def _score_data(study: pe.Study) -> Json:
    score = study.evaluator(workers=1).score(study.rig)
    return {
        "entropy": score.entropy,
        "coverage": score.coverage,
        "stderr": score.stderr,
        "per_class": {name: part.entropy for name, part in score.per_class.items()},
    }


def _sample(study: pe.Study) -> VoxelSample:
    tops = None if study.vehicle is None else study.vehicle.top(study.space)
    return draw(study.prior.densities(study.space), study.space, SAMPLED_VOXELS, tops)


def _rounded(values: np.ndarray) -> list[float]:
    """Return numbers with six digits, which are enough for a plot."""
    return [float(f"{v:.6g}") for v in values.tolist()]
