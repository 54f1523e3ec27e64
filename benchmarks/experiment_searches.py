"""``python -m benchmarks.experiment_searches``: how low the methods of search come, and how soon.

Every run is a whole `OptimizeJob` from the paper's placement, on all processors, and leaves a JSON
file of its own; what is there already is not run again, so it may be broken off at any time. Then
come the table (in benchmarks/README.md, by `make bench`) and the plot of docs/optimize.md. Have
nothing else run beside it, as the axis is the clock: ten seeds take about half an hour. A run keeps
the load of the machine at its beginning, and table and plot say where it was high.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pe_core as pe
import pe_tools as pt

from .experiment_searches_told import EXPERIMENTS, METHODS, SUMMARY, write_summary
from .run_files import restore, run_once

ROOT = Path(__file__).resolve().parent.parent
STUDIES = ROOT / "blend_assets" / "experiments"
RUNS = ROOT / "build" / "searches"
SAMPLES = 65_536
EVALUATED = 262_144
SHIFT = (0.31, 0.62, 0.13)
"""Voxels a candidate is evaluated on; voxels, others, that tell what the best so far is worth."""
MARKS_S = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 80, 100, 150, 200, 300, 450)

Json = dict[str, Any]


def main(arguments: list[str]) -> int:
    """Run what is missing, then put all together."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.experiment_searches", description=__doc__
    )
    parser.add_argument("--seeds", type=int, default=10, help="runs of each (10)")
    parser.add_argument("--seconds", type=float, default=20.0, help="longest search by random (20)")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    parser.add_argument("--experiments", nargs="+", choices=EXPERIMENTS, default=EXPERIMENTS)
    parser.add_argument("--again", nargs="+", choices=METHODS, default=[])
    parser.add_argument("--runs", type=Path, default=RUNS, help="folder of the runs' files")
    args = parser.parse_args(arguments)
    restore(args.runs, SUMMARY, partial(_path, args.runs), args.again)
    for seed in range(args.seeds):
        for experiment in args.experiments:
            for method in args.methods:
                most = args.seconds if method == "random" else float("inf")
                path = _path(args.runs, {"experiment": experiment, "method": method, "seed": seed})
                run_once(path, partial(run, experiment, method, seed, most), "")
    write_summary(args.runs, SUMMARY)
    return 0


def _path(folder: Path, run: Json) -> Path:
    return folder / f"{run['experiment']} {run['method']} {run['seed']}.json"


def run(experiment: str, method: str, seed: int, most: float = float("inf")) -> Json:
    """Search from the paper's placement; return what was found, and the curve of the best."""
    study = pe.load_study(STUDIES / f"{experiment}.toml")
    search = replace(study.search, method=method, seed=seed, samples=SAMPLES)
    job = pt.OptimizeJob(replace(study, search=search))
    bests = []
    load = os.getloadavg()[0]
    searching = None
    ended = 0.0
    begun = _processor_s()
    for progress in job:
        if searching is None and progress.evaluations:
            searching = ended = time.monotonic()
        if progress.stage == "optimizing":
            ended = time.monotonic()
        if len(job.history) > len(bests):
            bests += [(time.monotonic() - searching, row) for row in job.history[len(bests) :]]
        if searching is not None and time.monotonic() - searching > most:
            job.stop()
    outcome = job.outcome
    return {
        "experiment": experiment,
        "method": method,
        "seed": seed,
        "entropy": outcome.after.entropy,
        "start": outcome.before.entropy,
        "own_sample": job.history[-1].value.objective,
        "seconds": outcome.seconds,
        "search_s": round(ended - (searching or ended), 3),
        "processor_s": round(_processor_s() - begun, 2),
        "load": round(load, 1),
        "evaluations": outcome.evaluations,
        "curve": _curve(study, bests, outcome.seconds),
    }


def _processor_s() -> float:
    """Return the processor time of this process and its workers that have ended [s]."""
    multiprocessing.active_children()  # joins those that have ended
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def _curve(study: pe.Study, bests: list[tuple[float, Any]], end: float) -> list[list[float]]:
    """Return time [s] and entropy of the best so far at some times, on voxels of its own."""
    options = {"samples": EVALUATED, "shift": SHIFT, "model": study.model}
    evaluator = pe.Evaluator(study.space, study.prior, study.vehicle, **options)
    known: dict[int, float] = {}
    points = []
    for mark in MARKS_S:
        number = sum(seconds <= mark for seconds, _ in bests) - 1
        if number >= 0:
            if number not in known:
                known[number] = evaluator.entropy(bests[number][1].rig)
            points.append([float(mark), known[number]])
        if mark >= end:
            break
    return points


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
