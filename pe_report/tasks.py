"""What is computed: plain functions from names and numbers to JSON data, run in processes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np

import pe_core as pe
from pe_core.formats import read_ap_table
from pe_core.metric import H_BLIND, fit_ap_curve
from pe_core.scoring import VoxelSample, draw
from pe_core.study import placements

from .bound import farthest_at, least_entropy, least_unseen
from .expected import expected_entropy
from .fitting import fit_data
from .paper import PITCH_HEIGHT_M, ROW
from .plan import Function
from .problems import pitched, placed, study_of, with_prior, without_cameras
from .settings import EXPECTED, SETTINGS

Json = dict[str, Any]

DATA = Path(__file__).parent / "data"
DRAWN = 1 << 16
"""Voxels drawn from the prior where a bound or an expectation is averaged."""
CURVE_M = (1.0, 80.0, 80)
MAP_COLUMNS = 20
"""Columns of 0.1 m in a square of the priors' plots."""


def score(row: str, prior: str, samples: int, rig_of: str = "", lidars_only: bool = False) -> Json:
    """Score a row's rig at its printed placement, or another row's rig under this one's weights."""
    study = replace(with_prior(study_of(row), prior), samples=samples)
    if rig_of:
        study = study.with_rig(study_of(rig_of).rig)
    return _scored(without_cameras(study) if lidars_only else study)


def search(
    row: str, prior: str, start: str, seed: int, candidates: int, search_samples: int, samples: int
) -> Json:
    """Run Algorithm 1 from a neutral start; score the result."""
    study = placed(with_prior(study_of(row), prior), ROW[row].starts[start])
    schedule = pe.Schedule(candidates=candidates)
    how = replace(
        study.search, method="random", seed=seed, samples=search_samples, schedule=schedule
    )
    job = pe.OptimizeJob(replace(study, search=how, samples=samples), workers=1)
    for _ in job:
        pass
    found = job.outcome
    assert found is not None
    return {
        "entropy": found.after.entropy,
        "coverage": found.after.coverage,
        "start_entropy": found.before.entropy,
        "evaluations": found.evaluations,
        "placements": placements(found.study.rig),
    }


def pitch(difference_deg: float, samples: int) -> Json:
    """Score two equal LiDARs at one height: fused, and the second alone."""
    pair = study_of("3_default").with_rig(study_of("3_front").rig)
    study = replace(pitched(pair, PITCH_HEIGHT_M, difference_deg), samples=samples)
    found = study.evaluator(workers=1).score(study.rig)
    alone = {name: own.entropy for name, own in found.per_sensor.items()}
    return {"entropy": found.entropy, "alone": alone}


def vary(row: str, setting: str, samples: int) -> Json:
    """Score a row of experiment 1 with one thing changed."""
    study = study_of(row)
    if setting != EXPECTED:
        return _scored(replace(SETTINGS[setting](study), samples=samples))
    (sensor,) = study.rig
    lidar, position = cast(pe.Lidar, sensor.model), sensor.pose.position
    centers = _drawn(replace(study, vehicle=None)).centers
    entropy = expected_entropy(lidar, position, centers, study.space.interval, study.model.lidar)
    return {"entropy": entropy, "coverage": None}


def bound(row: str, prior: str) -> Json:
    """Bound a camera row's entropy from below, under one prior and under any."""
    study = with_prior(study_of(row), prior)
    (sensor,) = study.rig
    camera, curve, side = cast(pe.Camera, sensor.model), study.model.camera, study.space.interval
    drawn = _drawn(study)
    offsets = drawn.centers - np.asarray(sensor.pose.position)
    distance = np.sqrt((offsets**2).sum(axis=1))
    least = least_entropy(camera, distance, side, curve)
    in_view = pe.measure(sensor, drawn.centers, side) > 0.0
    printed = ROW[row].entropy
    return {
        "in_view": float(np.mean(in_view)),
        "least": float(np.mean(np.where(in_view, least, H_BLIND))),
        "least_all_round": float(np.mean(least)),
        "farthest_m": farthest_at(camera, printed, side, curve),
        "nearer_than_that": float(np.mean(distance <= farthest_at(camera, printed, side, curve))),
        "most_unseen": least_unseen(printed, camera, curve),
    }


def bound_curve(hfov_deg: int) -> Json:
    """Least entropy of a voxel by its distance, for one of the paper's cameras."""
    study = study_of("2_60deg")
    camera = cast(pe.Camera, pe.catalog.load(f"Camera {hfov_deg} deg"))
    distance = np.linspace(*CURVE_M[:2], CURVE_M[2])
    least = least_entropy(camera, distance, study.space.interval, study.model.camera)
    return {"distance_m": _short(distance), "entropy": _short(least)}


def prior_map(prior: str) -> Json:
    """Density over the ground and over height, for a plot."""
    study = with_prior(study_of("1_pandar64"), prior)
    densities = study.prior.densities(study.space)
    ground = np.sum([d.ground for d in densities], axis=0)
    nx, ny = (n // MAP_COLUMNS for n in ground.shape)
    squares = ground.reshape(nx, MAP_COLUMNS, ny, MAP_COLUMNS).sum(axis=(1, 3))
    area = (MAP_COLUMNS * study.space.interval) ** 2
    height = np.sum([d.ground.sum() * d.profile for d in densities], axis=0)
    return {
        "classes": [d.name for d in densities],
        "ground": [_short(line) for line in squares / area],
        "height_m": _short(study.space.centers(2)),
        "height": _short(height / study.space.interval),
    }


def fit(table: str) -> Json:
    """Fit the AP curve to a table that comes with the project."""
    return fit_data(fit_ap_curve(read_ap_table(DATA / f"{table}.csv")))


FUNCTIONS: Mapping[str, Any] = {
    f.__name__: f for f in (score, search, pitch, vary, bound, bound_curve, prior_map, fit)
}


def function_of(given: Function | str) -> Function:
    """Return what a task runs: a function, or the one of that name."""
    found: Function = FUNCTIONS[given] if isinstance(given, str) else given
    return found


def _scored(study: pe.Study) -> Json:
    found = study.evaluator(workers=1).score(study.rig)
    return {
        "entropy": found.entropy,
        "coverage": found.coverage,
        "stderr": found.stderr,
        "per_class": {name: part.entropy for name, part in found.per_class.items()},
    }


def _drawn(study: pe.Study) -> VoxelSample:
    tops = None if study.vehicle is None else study.vehicle.top(study.space)
    return draw(study.prior.densities(study.space), study.space, DRAWN, tops)


def _short(values: np.ndarray) -> list[float]:
    """Return numbers with six digits: enough for a plot."""
    return [float(f"{v:.6g}") for v in values.tolist()]
