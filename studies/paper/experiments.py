"""The experiments: tasks for worker processes, and how much of them is computed.

A row with several starts is searched from each of them by a short pilot. The long searches of the
row start where the best pilot did, so they can run when all its pilots have values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_core.base import record
from pe_core.metric import H_BLIND
from pe_core.scoring import VoxelSample, draw
from pe_tools.formats import fit_ap_curve, read_ap_table
from pe_tools.jobs import placements

from ..results_file import Json, Task, Values
from .analytic import expected_entropy, max_distance_for, max_unseen_share, min_entropy
from .paper import (
    EXPECTED_COUNTS,
    PITCH_HEIGHT_M,
    PRIORS,
    ROW,
    ROWS,
    SETTINGS,
    study_of,
    with_pitch_difference,
    with_positions,
    with_prior,
    without_cameras,
)

DATA = Path(__file__).parent / "data"
FITS = ("kitti_car", "kitti_pedestrian", "kitti_cyclist", "paper_lidar")
CAMERAS_DEG = (30, 60, 120)
CAMERA_ROWS = ("2_60deg", "2_120deg")
LIDAR_ROWS = ("1_pandar64", "1_hdl64e")
QUICK_SETTINGS = ("as shipped", "voxels of 0.4 m (space 4.8 m high)")
MAX_PITCH_DEG = 2.0
"""The pitch figure goes from minus this difference to plus this difference."""
SAMPLED_VOXELS = 1 << 16
"""Voxels sampled from the prior where a bound or an expectation is averaged."""
CURVE_M = (1.0, 80.0, 80)
"""First distance, last distance [m] and number of points of the curve of a bound."""
MAP_COLUMNS = 20
"""Columns of 0.1 m in a square of the priors' plots."""
WITH_ROAD_PRIOR = tuple(
    (row, "road")
    for row in ("3_default", "3_front", "1_pandar64", "1_hdl64e", "2_60deg", "2_120deg")
)
WITH_HIGHWAY_PRIOR = tuple((row, "highway") for row in CAMERA_ROWS)
"""The one ordering that depends on the prior is searched under two."""


@dataclass(frozen=True)
class Effort:
    """How much is computed."""

    samples: int
    """Voxels that a score evaluates; 0: all."""
    candidates: int
    search_samples: int
    pilot_candidates: int
    """Placements in a round of a search, voxels that each is evaluated on, the former of pilots."""
    seeds: tuple[int, ...]
    """Of the searches from the best start."""
    rows: tuple[tuple[str, str], ...]
    """The rows that are searched, each with its prior."""
    starts: tuple[str, ...]
    """The starts that are searched, of those that a row has."""
    pitch_step_deg: float
    all_settings: bool
    """Whether experiment 1 is computed for all settings, or for `QUICK_SETTINGS` only."""

    @classmethod
    def from_dict(cls, data: Json) -> Effort:
        """Return the effort that results.json names."""
        values: Json = {k: tuple(v) if isinstance(v, list) else v for k, v in data.items()}
        return cls(**{**values, "rows": tuple((row, prior) for row, prior in data["rows"])})


FULL = Effort(
    samples=0,
    candidates=1000,
    search_samples=32_768,
    pilot_candidates=200,
    seeds=(0, 1, 2, 3, 4),
    rows=(("4_cameras", "road"), *WITH_ROAD_PRIOR, *WITH_HIGHWAY_PRIOR),
    starts=("roof", "diagonal", "front", "rear", "left"),
    pitch_step_deg=0.05,
    all_settings=True,
)
"""The paper's schedule, scored on the whole grid."""
QUICK = Effort(
    samples=16_384,
    candidates=6,
    search_samples=4_096,
    pilot_candidates=4,
    seeds=(0,),
    rows=WITH_ROAD_PRIOR,
    starts=("roof", "diagonal", "front"),
    pitch_step_deg=0.5,
    all_settings=False,
)
"""Every ordering at a lower cost: sampled scores and short searches."""


def plan(effort: Effort, values: Values) -> list[Task]:
    """Return the tasks that can run now and have no value yet, the long ones first."""
    can_run = [*_searches(effort, values), *scores_and_figures(effort)]
    return [task for task in can_run if task.name not in values]


def _searches(effort: Effort, values: Values) -> Iterator[Task]:
    samples = {"search_samples": effort.search_samples, "samples": effort.samples}
    for row, prior in effort.rows:
        starts = starts_of(row, effort)
        best = best_start(row, prior, values, effort)
        common = {"row": row, "prior": prior, **samples}
        for start in starts if len(starts) > 1 else ():
            pilot = {"candidates": effort.pilot_candidates, "seed": effort.seeds[0]}
            yield Task(pilot_name(row, prior, start), search, {**common, "start": start, **pilot})
        for seed in effort.seeds if best else ():
            own = {"start": best, "candidates": effort.candidates, "seed": seed}
            yield Task(search_name(row, prior, str(best), seed), search, {**common, **own})


def scores_and_figures(effort: Effort) -> list[Task]:
    """Return the tasks that need no search."""
    tasks = list[Task]()
    samples = {"samples": effort.samples}

    def add(name: str, function: Callable[..., Json], **arguments: Any) -> None:
        tasks.append(Task(name, function, arguments))

    for prior in PRIORS:
        of_prior: Json = {"prior": prior, **samples}
        for row in ROWS:
            add(f"printed/{row.name}/{prior}", score, row=row.name, **of_prior)
        for own, other in (("3_default", "3_front"), ("3_front", "3_default")):
            add(f"swapped/{own}/{prior}", score, row=own, rig_of=other, **of_prior)
        add(f"lidars/4_cameras/{prior}", score, row="4_cameras", lidars_only=True, **of_prior)
    for difference in pitch_differences(effort):
        add(f"pitch/{difference:g}", pitch, difference_deg=difference, **samples)
    for setting in (*SETTINGS, EXPECTED_COUNTS):
        for lidar in LIDAR_ROWS if effort.all_settings or setting in QUICK_SETTINGS else ():
            add(f"vary/{setting}/{lidar}", vary, row=lidar, setting=setting, **samples)
    for prior in PRIORS:
        for camera in CAMERA_ROWS:
            add(f"bound/{camera}/{prior}", bound, row=camera, prior=prior)
    for deg in CAMERAS_DEG:
        add(f"bound_curve/{deg}", bound_curve, hfov_deg=deg)
    for prior in PRIORS:
        add(f"prior/{prior}", prior_map, prior=prior)
    for table in FITS:
        add(f"fit/{table}", fit, table=table)
    return tasks


def pitch_differences(effort: Effort) -> list[float]:
    """Return the pitch differences of the pitch figure [deg]."""
    count = round(MAX_PITCH_DEG / effort.pitch_step_deg)
    return [round(k * effort.pitch_step_deg, 4) + 0.0 for k in range(-count, count + 1)]


def starts_of(row: str, effort: Effort) -> list[str]:
    """Return the starts that a row is searched from."""
    return [start for start in ROW[row].starts if start in effort.starts]


def pilot_name(row: str, prior: str, start: str) -> str:
    """Return the name of a pilot's task."""
    return f"pilot/{row}/{prior}/{start}"


def search_name(row: str, prior: str, start: str, seed: int) -> str:
    """Return the name of a search's task."""
    return f"search/{row}/{prior}/{start}/{seed}"


def best_start(row: str, prior: str, values: Values, effort: Effort) -> str | None:
    """Return the start whose pilot ended lowest; None until all pilots of the row have values."""
    starts = starts_of(row, effort)
    if len(starts) == 1:  # needs no pilot
        return starts[0]
    pilots = {start: pilot_name(row, prior, start) for start in starts}
    if not all(name in values for name in pilots.values()):
        return None
    return min(pilots, key=lambda start: values[pilots[start]]["entropy"])


def best_search(values: Values, effort: Effort, row: str, prior: str) -> str:
    """Return the name of the search that ended lowest, of all seeds; empty where there is none."""
    start = str(best_start(row, prior, values, effort))
    names = [search_name(row, prior, start, seed) for seed in effort.seeds]
    done = [name for name in names if name in values]
    return min(done, key=lambda name: values[name]["entropy"], default="")


# The functions of the tasks.


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
    job = pt.OptimizeJob(replace(study, search=settings, samples=samples), workers=1)
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
        "placements": record(placements(outcome.study.rig)),
    }


def pitch(difference_deg: float, samples: int) -> Json:
    """Score two equal LiDARs at one height: both fused, and each alone."""
    pair = study_of("3_default").with_rig(study_of("3_front").rig)
    study = with_pitch_difference(pair, PITCH_HEIGHT_M, difference_deg)
    score = replace(study, samples=samples).evaluator(workers=1).score(study.rig)
    alone = {name: part.entropy for name, part in score.per_sensor.items()}
    return {"entropy": score.entropy, "alone": alone}


def vary(row: str, setting: str, samples: int) -> Json:
    """Score a row of experiment 1 with one setting changed."""
    study = study_of(row)
    if setting != EXPECTED_COUNTS:
        return _score_data(replace(SETTINGS[setting](study), samples=samples))
    (sensor,) = study.rig
    lidar = cast(pe.Lidar, sensor.model)
    position = sensor.pose.position
    centers = _sample(replace(study, vehicle=None)).centers
    entropy = expected_entropy(
        lidar, position, centers, study.space.interval, curve=study.model.lidar
    )
    return {"entropy": entropy, "coverage": None}


def bound(row: str, prior: str) -> Json:
    """Return lower bounds of a camera row's entropy, for its own field of view and for all round.

    Also what the printed figure would need: how near voxels must be, and how many must be seen.
    """
    study = with_prior(study_of(row), prior)
    (sensor,) = study.rig
    camera = cast(pe.Camera, sensor.model)
    curve = study.model.camera
    side = study.space.interval
    centers = _sample(study).centers
    distance = np.sqrt(((centers - np.asarray(sensor.pose.position)) ** 2).sum(axis=1))
    least = min_entropy(camera, distance, side, curve)
    in_view = pe.measure(sensor, centers, side) > 0.0
    farthest = max_distance_for(camera, ROW[row].entropy, side, curve)
    return {
        "in_view": float(np.mean(in_view)),
        "least": float(np.mean(np.where(in_view, least, H_BLIND))),
        "least_all_round": float(np.mean(least)),
        "farthest_m": farthest,
        "nearer_than_that": float(np.mean(distance <= farthest)),
        "most_unseen": max_unseen_share(ROW[row].entropy, camera, curve),
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
    found = fit_ap_curve(read_ap_table(DATA / f"{table}.csv"))
    return {
        "a": found.curve.a,
        "b": found.curve.b,
        "a_error": found.a_error,
        "b_error": found.b_error,
        "rms": found.rms,
        "m": found.table.m.tolist(),
        "ap": found.table.ap.tolist(),
        "n": found.table.n.tolist(),
        "left_out": list(found.why),
    }


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
