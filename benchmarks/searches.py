"""``python -m benchmarks.searches``: methods of search on fifteen problems, and other libraries.

All methods have the same evaluator and the same number of evaluations: the problem's own, which is
small, or with ``--budgets default`` that of a study that names none. Every run leaves a JSON file
of its own; what is there, or in the summary that is kept with the project, is not run again. Then
come the summary and its page (benchmarks/searches.md).

The other libraries come with the extra "bench". `--problems`, `--methods` and `--seeds` select, and
`--again METHOD` forgets the runs of a method that has changed. `--only run` leaves the summary
alone, `--only tell` runs nothing.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import pe_core as pe
from pe_core.scoring import sampling
from pe_core.search import Parametrization, default_budget

from .run_files import restore, run_once
from .search_problems import BUDGETS, PROBLEMS, SearchProblem
from .yardstick_searches import YARDSTICKS, Landscape, search_by

RUNS = Path(__file__).resolve().parent.parent / "build" / "search_problems"
SUMMARY = Path(__file__).with_name("searches.json")
OURS = pe.METHODS
METHODS = (*OURS, *YARDSTICKS)
Json = dict[str, Any]


def main(arguments: Sequence[str]) -> int:
    """Run what is missing, then put all together."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.searches", description=__doc__)
    parser.add_argument("--problems", nargs="+", choices=PROBLEMS, default=list(PROBLEMS))
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    parser.add_argument("--budgets", nargs="+", choices=BUDGETS, default=["small"])
    parser.add_argument("--samples", type=int, help="voxels that all methods evaluate (problem's)")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(5)))
    parser.add_argument("--again", nargs="+", choices=METHODS, default=[])
    parser.add_argument("--runs", type=Path, default=RUNS, help="folder of the runs' files")
    parser.add_argument("--only", choices=("run", "tell"))
    args = parser.parse_args(arguments)
    restore(args.runs, SUMMARY, partial(_path, args.runs), args.again)
    if args.only != "tell":
        _run_missing(args)
    if args.only != "run":
        from .searches_told import write_summary

        write_summary(args.runs, SUMMARY)
    return 0


def _run_missing(args: argparse.Namespace) -> None:
    """Run all problems by all methods with one seed before the next seed: what is there when it is
    broken off is balanced."""
    for length in args.budgets:
        for seed in args.seeds:
            for name in args.problems:
                for method in args.methods:
                    chosen = {"problem": name, "method": method, "budget": length, "seed": seed}
                    path = _path(args.runs, chosen)
                    search = partial(run, **chosen, samples=args.samples)
                    run_once(path, search, " of processor")


def _path(folder: Path, run: Json) -> Path:
    names = (run["problem"], run["method"], run["budget"], run["seed"])
    return folder / f"{', '.join(map(str, names))}.json"


def evaluations_of(problem: SearchProblem, budget_name: str) -> int:
    """Return how many placements a run evaluates."""
    if budget_name == "small":
        return problem.evaluations
    study = problem.make()
    return default_budget(len(Parametrization(study.rig, study.search_space()).blocks))


def run(problem: str, method: str, budget: str, seed: int, samples: int | None = None) -> Json:
    """Search; return the entropy that was found on the grid, and what the search did. Candidates
    are evaluated on so many samples, the problem's own by default."""
    study = PROBLEMS[problem].make()
    if samples is not None:
        study = replace(study, search=replace(study.search, samples=samples))
    evaluations = evaluations_of(PROBLEMS[problem], budget)
    evaluator = study.evaluator(study.search.samples, shift=sampling.SEARCHED)
    search = _ours if method in OURS else _theirs
    begun = time.process_time()
    found = search(study, evaluator, method, seed, evaluations=evaluations)
    seconds = time.process_time() - begun
    best = found.bests[-1]
    return {
        "problem": problem,
        "method": method,
        "budget": budget,
        "seed": seed,
        "samples": study.search.samples,
        "load": round(os.getloadavg()[0], 1),
        "entropy": study.evaluator(0).entropy(best),
        "own_sample": evaluator.entropy(best),
        "seconds": round(seconds, 3),
        "evaluations": found.evaluations,
        "asked": evaluations,
        "broken": found.broken,
        "chosen": found.chosen,
        "path": _digest_of(found.bests),
    }


def _digest_of(bests: Sequence[pe.Rig]) -> str:
    """Return a digest of the placements that were the best one after the other: that two seeds
    searched alike is seen by it."""
    poses = [[(each.pose.position, each.pose.rpy) for each in rig] for rig in bests]
    return hashlib.sha256(repr(poses).encode()).hexdigest()[:12]


@dataclass(frozen=True, slots=True)
class RivalRun:
    """What a search did: each placement that was the best so far, placements evaluated, those that
    broke a rule instead (None: not counted), and the method that a method chose."""

    bests: list[pe.Rig]
    evaluations: int
    broken: int | None
    chosen: str


def _ours(
    study: pe.Study, last: pe.RigEvaluator, method: str, seed: int, evaluations: int
) -> RivalRun:
    """Search by a method of the engine, on its own levels."""
    searched = replace(study.search, method=method, evaluations=evaluations)
    levels = replace(study, search=searched).level_samples
    objectives = [
        last if n == study.search.samples else study.evaluator(n, shift=sampling.SEARCHED)
        for n in levels
    ]
    schedule = None
    if method == "random":
        rounds = len(pe.Schedule().scales)
        schedule = pe.Schedule(candidates=max(1, evaluations // rounds))
    bests = list[pe.Rig]()
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
        if step.improved or not bests:
            bests.append(step.best)
    return RivalRun(bests, count, None, method)


def _theirs(
    study: pe.Study, evaluator: pe.RigEvaluator, method: str, seed: int, evaluations: int
) -> RivalRun:
    """Search by a method of another library."""
    bests = list[pe.Rig]()
    lowest = float("inf")
    count = 0

    def told(rig: pe.Rig, entropy: float) -> None:
        nonlocal lowest, count
        count += 1
        if entropy < lowest:
            lowest = entropy
            bests.append(rig)

    landscape = Landscape(study, evaluator, evaluations, told)
    chosen = search_by(method, landscape, seed, evaluations)
    return RivalRun(bests, count, landscape.broken, chosen)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
