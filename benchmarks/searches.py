"""``python -m benchmarks.searches``: how low the methods of search come, and how soon.

Every run is a whole `OptimizeJob` from the paper's placement, on all processors, and leaves a JSON
file of its own; what is there already is not run again, so it may be broken off at any time. Then
come the table (in benchmarks/README.md, by `make bench`) and the plot of docs/optimize.md. Have
nothing else run beside it, as the axis is the clock: ten seeds take about half an hour.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pe_core as pe

ROOT = Path(__file__).resolve().parent.parent
STUDIES = ROOT / "blend_assets" / "experiments"
RUNS = ROOT / "build" / "searches"
SUMMARY = Path(__file__).with_name("searches.json")
EXPERIMENTS = {
    "1_pandar64": "1, Pandar64 on a car",
    "3_default": "3, two LiDARs on a bus",
    "3_front": "3, both in front",
    "4_cameras": "4, two LiDARs, two cameras",
}
COMPARED = ("block-descent", "random")
SAMPLES, JUDGES, SHIFT = 65_536, 262_144, (0.31, 0.62, 0.13)
"""Voxels a candidate is judged on; voxels, others, that tell what the best so far is worth."""
MARKS_S = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 80, 100, 150, 200, 300, 450)

Json = dict[str, Any]


def main(arguments: list[str]) -> int:
    """Run what is missing, then put all together."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.searches", description=__doc__)
    parser.add_argument("--seeds", type=int, default=10, help="runs of each (10)")
    parser.add_argument("--seconds", type=float, default=20.0, help="longest search by random (20)")
    parser.add_argument("--methods", nargs="+", choices=pe.METHODS, default=COMPARED)
    parser.add_argument("--experiments", nargs="+", choices=EXPERIMENTS, default=EXPERIMENTS)
    parser.add_argument("--runs", type=Path, default=RUNS, help="folder of the runs' files")
    args = parser.parse_args(arguments)
    args.runs.mkdir(parents=True, exist_ok=True)
    for seed in range(args.seeds):
        for experiment in args.experiments:
            for method in args.methods:
                most = args.seconds if method == "random" else float("inf")
                _run_once(args.runs, experiment, method, seed, most)
    from .searches_told import write_summary

    write_summary(args.runs, SUMMARY)
    return 0


def _run_once(folder: Path, experiment: str, method: str, seed: int, most: float) -> None:
    """Run a search unless its file is there; the file comes last, and whole."""
    path = folder / f"{experiment} {method} {seed}.json"
    if path.exists():
        return
    found = run(experiment, method, seed, most)
    scratch = path.with_suffix(".part")
    scratch.write_text(json.dumps(found), "utf-8")
    os.replace(scratch, path)
    told = f"{found['entropy']:.4f} on the grid after {found['seconds']:.1f} s"
    print(f"{experiment} {method} seed {seed}: {told}", flush=True)


def run(experiment: str, method: str, seed: int, most: float = float("inf")) -> Json:
    """Search from the paper's placement; return what was found, and the curve of the best."""
    study = pe.load_study(STUDIES / f"{experiment}.toml")
    search = replace(study.search, method=method, seed=seed, samples=SAMPLES)
    job, bests = pe.OptimizeJob(replace(study, search=search)), []
    searching = None
    for progress in job:
        if searching is None and progress.evaluations:
            searching = time.monotonic()
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
        "own_sample": job.history[-1].entropy,
        "seconds": outcome.seconds,
        "evaluations": outcome.evaluations,
        "curve": _curve(study, bests, outcome.seconds),
        "placements": pe.result_dict(outcome)["placements"]["after"],
    }


def _curve(study: pe.Study, bests: list[tuple[float, Any]], end: float) -> list[list[float]]:
    """Return time [s] and entropy of the best so far at some times, on voxels of its own."""
    options = {"samples": JUDGES, "shift": SHIFT, "model": study.model}
    judge = pe.Evaluator(study.space, study.prior, study.vehicle, **options)
    known: dict[int, float] = {}
    points = []
    for mark in MARKS_S:
        number = sum(seconds <= mark for seconds, _ in bests) - 1
        if number >= 0:
            if number not in known:
                known[number] = judge.entropy(bests[number][1].rig)
            points.append([float(mark), known[number]])
        if mark >= end:
            break
    return points


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
