"""``python -m studies.detectors.second``: the missing runs of the second plan."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ...command import main, page_parser
from ...ranks import MIN_GROUP
from ...results_file import RESULTS, Json, print_progress
from ..after_search import on_roofs, searched_placements
from ..placements import good_placements
from ..plan import EQUAL_M, GOOD, LAYOUTS, SEARCHES, SECOND, full_second_plan, quick_second_plan
from ..runs import Run, RunFiles, add_run_options, do_runs, parts_of
from ..scenes import Layouts
from ..scores import placement_scores
from .analysis import good_runs, second_analysis


def validate_second(args: argparse.Namespace, folder: Path) -> Answer:
    """Do the runs that are asked for; return how many are done."""
    plan = quick_second_plan() if args.quick else full_second_plan()
    folder = prepare_folder(folder)
    report = print_progress if args.searches and not args.page_only else None
    parts = parts_of(plan, searched_placements(on_roofs(plan), folder, report))
    layouts = Layouts(Path(args.layouts)) if args.layouts else None
    kept = RunFiles(folder, plan, [run for runs in parts.values() for run in runs])
    wanted: Sequence[Run] = parts[LAYOUTS if layouts else SEARCHES]
    if layouts or args.searches:
        do_runs(args, RunFiles(folder, on_roofs(plan) if args.searches else plan, wanted), layouts)
    else:
        for _ in plan.second.good.seeds:  # the first chooses what is done of the others
            wanted = parts[EQUAL_M] + good_runs(plan, parts[GOOD], kept.read())
            do_runs(args, RunFiles(folder, plan, wanted))
            if args.runs is not None:
                break
            args.resume = True
    results = kept.read()
    scores = dict[str, Json]()
    ranked = [good_runs(plan, parts[GOOD], results), parts[LAYOUTS]]
    if plan.second.good.each >= MIN_GROUP and any(
        all(run.name in results for run in part) for part in ranked
    ):
        rigs = [(placement, placement.rig()) for placement in good_placements(plan)]
        scores = placement_scores(plan, rigs, folder, print_progress)
    found = second_analysis(plan, parts, results, scores)
    write_bytes(folder / RESULTS, dump_json(found).encode())
    return dump_json(found) if args.json else _summary(found), DONE


def _summary(found: Json) -> str:
    """Return what is done and what follows, for people."""
    lines = [
        f"{done} of {of} runs of {name} are done" for name, (done, of) in found["parts"].items()
    ]
    for rows, row in ((found[EQUAL_M] or {}).get("minus_first") or {}).items():
        lines.append(f"{row['tie']:12} equal m ties: {rows} rows {row['mean']:+.3f} AP")
    for part, where in ((GOOD, "among the good"), (LAYOUTS, "in real layouts")):
        for name, row in ((found[part] or {}).get("figures") or {}).items():
            lines.append(f"{row['verdict']:12} {name} ranks {where}: rho {row['rho']:+.2f}")
            lines.append(f"{row['useful']:12} {name} is a useful ranking {where}")
    for ring, row in ((found[SEARCHES] or {}).get("minus_entropy") or {}).items():
        lines.append(f"{row['verdict']} in {ring}: {row['mean']:+.3f} AP")
    return "\n".join(lines)


if __name__ == "__main__":
    parser, _ = page_parser(
        "detectors.second",
        "train detectors at the placements of the second plan",
        (f"docs/validity/own/{SECOND}", "validity-second-quick"),
        "a few runs of few scenes, in minutes",
    )
    which = parser.add_mutually_exclusive_group()
    about = "part 3 instead of parts 2 and 1: test in real layouts, of the logs in this folder"
    which.add_argument("--layouts", metavar="FOLDER", help=about)
    about = "part 4 instead: its searches, unless they are done, and its runs"
    which.add_argument("--searches", action="store_true", help=about)
    add_run_options(parser)
    main(parser, validate_second)
