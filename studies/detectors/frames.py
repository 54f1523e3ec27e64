"""``python -m studies.detectors.frames``: a detector with one frame and with five, in motion.

The missing runs, and the page of what they say; no figure before all are done.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core.base import Floats, dump_json, write_bytes
from pe_core.metric.frames import Frames
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import main, page_parser
from ..pages import PAGE, check_page, render
from ..ranks import PlacementSamples, Resample, Statistic, holm, interval, rho_within
from ..results_file import RESULTS, Json, print_progress
from .analysis import HOLDS, UNDECIDED, Results, of_runs, rank_of
from .placements import frames_placements, vehicle
from .plan import FRAMES, Plan, full_frames_plan, quick_frames_plan
from .runs import RunFiles, add_run_options, do_runs, frames_runs
from .scenes import CLASSES
from .scores import SPACE, placement_scores

TITLE = "# One frame and five, in motion"
TEMPLATE = "frames.md.j2"
ONE = "one"
FIVE = "five"
ONE_FRAME = "one_frame"
"""The arms, and where a run has the results of the first."""
BETTER = "ranks better"
WORSE = "ranks worse"
ALIKE = "alike"
MORE = "five frames find more"
FEWER = "five frames find fewer"


def every_q(plan: Plan) -> tuple[float, ...]:
    """Return the process noises of the entropies: of one frame (inf), and those of the plan."""
    return (np.inf, plan.frames.judged.q, *plan.frames.judged.other_q)


def key_of(q: float) -> str:
    """Return the name of the entropy over frames with a process noise q; inf is one frame's."""
    return f"q {q:g}"


def frame_scorer(plan: Plan) -> Callable[[Plan, str, pe.Rig], Json]:
    """Return what scores a rig: entropy of one frame, and over frames with each q of the plan."""

    @cache
    def evaluator(vehicle_name: str, q: float) -> pe.Evaluator:
        rule = plan.frames.motion
        frames = None if np.isinf(q) else Frames(rule.count, q)
        model = pe.PerceptionModel(frames=frames)
        return pe.Evaluator(SPACE, pe.Prior.road(), vehicle(vehicle_name), model=model, workers=1)

    def scored(_: Plan, vehicle_name: str, rig: pe.Rig) -> Json:
        return {key_of(q): evaluator(vehicle_name, q).entropy(rig) for q in every_q(plan)}

    return scored


def frames_analysis(plan: Plan, results: Results, scores: Results) -> Json:
    """Return the runs done and planned; with all of them, and scores, figures and verdicts."""
    wanted = frames_runs(plan)
    five = of_runs(FRAMES, wanted, results)
    found: Json = {"runs": {"done": five.done, "planned": five.planned}, "ranks": None}
    if not (five.complete and scores):
        return found
    one = of_runs(FRAMES, wanted, results, lambda run: float(run[ONE_FRAME]["ap"]))
    arms = {ONE: one.samples, FIVE: five.samples}
    keys = list(map(key_of, every_q(plan)))
    value = {key: -np.array([scores[p.name][key] for p in five.chosen]) for key in keys}
    ranks = {k: {arm: rank_of(plan, s, v) for arm, s in arms.items()} for k, v in value.items()}
    judged = [ranks[key][FIVE] for key in keys[:2]]
    for row, p in zip(judged, holm([row["p"] for row in judged]), strict=True):
        row |= {"p_holm": p}
        positive = p < plan.statistics.alpha and row["rho"] > 0.0
        row["verdict"] = HOLDS if positive else UNDECIDED
    by_arm = [r[ONE_FRAME] for r in results.values()], list(results.values())
    gained = replace(five.samples, aps=arms[FIVE].aps - arms[ONE].aps)
    return {
        **found,
        "ranks": ranks,
        "minus_one": {k: _minus(plan, value[k], value[keys[0]], five.samples) for k in keys[1:]},
        "aps_alike": float(rho_within(one.samples.ap, five.samples.ap, five.samples.members)),
        "noise": {arm: round(s.noise, 4) for arm, s in arms.items()},
        "converged": [sum(run["training"]["converged"] for run in of_arm) for of_arm in by_arm],
        "gain": _gain(plan, gained),
        "ap": {arm: _rounded(s.ap.min(), s.ap.mean(), s.ap.max()) for arm, s in arms.items()},
        "by_class": {
            name: _rounded(*(np.mean([run["by_class"][name] for run in arm]) for arm in by_arm))
            for name in CLASSES
        },
    }


def difference_verdict(low: float, high: float, alike: float) -> str:
    """Return what the interval of a difference of rho says."""
    if low > 0.0 or high < 0.0:
        return BETTER if low > 0.0 else WORSE
    return ALIKE if -alike <= low and high <= alike else UNDECIDED


def _rounded(*values: float) -> list[float]:
    return [round(float(v), 4) for v in values]


def _interval(plan: Plan, samples: PlacementSamples, statistic: Statistic) -> tuple[float, float]:
    return interval(samples, plan.statistics, plan.seed, statistic)


def _minus(plan: Plan, value: Floats, other: Floats, samples: PlacementSamples) -> Json:
    """Return rho of a figure minus that of another, of the same placements and seeds."""

    def less(drawn: Resample) -> Floats:
        rho = [rho_within(v[drawn.index], drawn.ap, samples.members) for v in (value, other)]
        return np.asarray(rho[0] - rho[1])

    low, high = _interval(plan, samples, less)
    verdict = difference_verdict(low, high, plan.frames.judged.alike_rho)
    return {"rho": float(less(samples.whole)), "interval": [low, high], "verdict": verdict}


def _gain(plan: Plan, gained: PlacementSamples) -> Json:
    """Return AP of five frames minus that of one, mean over the placements."""
    low, high = _interval(plan, gained, lambda drawn: np.asarray(drawn.ap.mean(axis=1)))
    verdict = MORE if low > 0.0 else FEWER if high < 0.0 else UNDECIDED
    mean = round(float(gained.ap.mean()), 4)
    return {"mean": mean, "interval": _rounded(low, high), "verdict": verdict}


def page(plan: Plan, found: Json) -> str:
    """Return the page as Markdown."""
    values = {"plan": plan.frames, "found": found, "title": TITLE}
    return render(Path(__file__).with_name(TEMPLATE), values)


def rank_over_frames(args: argparse.Namespace, folder: Path) -> Answer:
    """Do the runs that are asked for; write results.json and the page."""
    plan = quick_frames_plan() if args.quick else full_frames_plan()
    check_page(folder, TITLE, "detectors.frames")
    files = RunFiles(prepare_folder(folder), plan, frames_runs(plan))
    do_runs(args, files)
    results = files.read()
    scores = dict[str, Json]()
    if len(results) == len(files.all):
        rigs = [(placement, placement.rig()) for placement in frames_placements(plan)]
        scores = placement_scores(plan, rigs, folder, print_progress, scored=frame_scorer(plan))
    found = frames_analysis(plan, results, scores)
    write_bytes(folder / RESULTS, dump_json(found).encode())
    write_bytes(folder / PAGE, page(plan, found).encode())
    return dump_json(found) if args.json else page(plan, found), DONE


if __name__ == "__main__":
    parser, _ = page_parser(
        "detectors.frames",
        "train detectors with one frame and with five, on moving scenes",
        (f"docs/validity/own/{FRAMES}", "validity-frames-quick"),
        "a few runs of few scenes, in minutes",
    )
    add_run_options(parser)
    main(parser, rank_over_frames)
