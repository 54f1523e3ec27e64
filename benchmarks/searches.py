"""``python -m benchmarks.searches``: methods of search on a dozen problems, and other libraries.

All methods have the same evaluator and the same number of evaluations. Every run leaves a JSON file
of its own; what is there, or in the summary that is kept with the project, is not run again. Then
come the summary, its table (benchmarks/searches.md) and the plot of docs/optimize.md.

Nevergrad and pycma come with the extra "bench". `--problems`, `--methods` and `--seeds` select, and
`--again METHOD` forgets the runs of a method that has changed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pe_core as pe

from .run_files import restore, run_once
from .search_problems import PROBLEMS
from .yardstick_searches import YARDSTICKS, Landscape

RUNS = Path(__file__).resolve().parent.parent / "build" / "search_problems"
SUMMARY = Path(__file__).with_name("searches.json")
OURS = pe.METHODS
METHODS = (*OURS, *YARDSTICKS)
MARKS = 16
"""Points of a curve, at most."""
Json = dict[str, Any]
EvaluatedRow = tuple[float, pe.Rig]
"""Processor time [s], and the best placement so far."""


def main(arguments: Sequence[str]) -> int:
    """Run what is missing, then put all together."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.searches", description=__doc__)
    parser.add_argument("--problems", nargs="+", choices=PROBLEMS, default=list(PROBLEMS))
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(5)))
    parser.add_argument("--again", nargs="+", choices=METHODS, default=[])
    parser.add_argument("--runs", type=Path, default=RUNS, help="folder of the runs' files")
    args = parser.parse_args(arguments)
    restore(args.runs, SUMMARY, partial(_path, args.runs), args.again)
    for seed in args.seeds:
        for name in args.problems:
            for method in args.methods:
                path = _path(args.runs, {"problem": name, "method": method, "seed": seed})
                run_once(path, partial(run, name, method, seed), " of processor")
    from .searches_told import write_summary

    write_summary(args.runs, SUMMARY)
    return 0


def _path(folder: Path, run: Json) -> Path:
    return folder / f"{run['problem']}, {run['method']}, {run['seed']}.json"


def run(name: str, method: str, seed: int) -> Json:
    """Search; return the entropy that was found on the grid, and the curve of the best."""
    problem = PROBLEMS[name]
    study = problem.make()
    evaluator = study.evaluator(study.search.samples)
    search = _ours if method in OURS else _theirs
    begun = time.process_time()
    rows, count, how = search(study, evaluator, method, seed, problem.evaluations)
    seconds = time.process_time() - begun
    kept = list(_marked(rows))
    return {
        "problem": name,
        "method": method,
        "seed": seed,
        "entropy": study.evaluator(0).entropy(rows[-1][1]),
        "own_sample": evaluator.entropy(rows[-1][1]),
        "seconds": round(seconds, 3),
        "evaluations": count,
        "chosen": how,
        "curve": [[round(at - begun, 3), evaluator.entropy(rig)] for at, rig in kept],
    }


def _ours(
    study: pe.Study, last: pe.RigEvaluator, method: str, seed: int, evaluations: int
) -> tuple[list[EvaluatedRow], int, str]:
    """Search by a method of the engine, on its own levels."""
    searched = replace(study.search, method=method, evaluations=evaluations)
    levels = replace(study, search=searched).level_samples
    objectives = [last if n == study.search.samples else study.evaluator(n) for n in levels]
    schedule = None
    if method == "random":
        rounds = len(pe.Schedule().scales)
        schedule = pe.Schedule(candidates=max(1, evaluations // rounds))
    rows = list[EvaluatedRow]()
    count = 0
    for step in pe.optimize(
        objectives,
        study.rig,
        study.search_space(),
        seed,
        schedule=schedule,
        method=method,
        evaluations=evaluations,
    ):
        count = step.evaluations
        if step.improved or not rows:
            rows.append((time.process_time(), step.best))
    return rows, count, method


def _theirs(
    study: pe.Study, evaluator: pe.RigEvaluator, method: str, seed: int, evaluations: int
) -> tuple[list[EvaluatedRow], int, str]:
    """Search by a method of another library."""
    rows = list[EvaluatedRow]()
    lowest = float("inf")
    count = 0

    def told(rig: pe.Rig, entropy: float) -> None:
        nonlocal lowest, count
        count += 1
        if entropy < lowest:
            lowest = entropy
            rows.append((time.process_time(), rig))

    landscape = Landscape(study, evaluator, evaluations, told)
    chosen = YARDSTICKS[method](landscape, seed, evaluations)
    return rows, count, chosen


def _marked(rows: list[EvaluatedRow]) -> Iterator[EvaluatedRow]:
    """Yield the last row in each of `MARKS` spans of time, each 1.5 times the one before."""
    first = rows[0][0]
    last = rows[-1][0]
    ends = [first + (last - first) / 1.5**k for k in reversed(range(MARKS))]
    number = -1
    for end in ends:
        at = sum(time_s <= end for time_s, _ in rows) - 1
        if at > number:
            number = at
            yield rows[at]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
