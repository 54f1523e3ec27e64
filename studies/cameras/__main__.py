"""``python -m studies.cameras FILE``: published camera rigs, scored and held against their AP."""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pe_core import InputError
from pe_core.base import dump_json, read_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import main, page_parser
from ..pages import check_page, render, write_study
from ..ranks import spearman
from ..results_file import RESULTS, Json, Task, Values, compute, made_by, plain, read_json
from .camera_curve import camera_curves
from .published_rigs import CARS, DETECTORS, RIGS, PublishedRigs, read_rigs
from .scores import CARS_OUTCOME, PLATE, SCORES, SEDAN, CameraEffort, scored_rig, values_of_score
from .statements import all_figures, seen_becomes_figure, verdicts

FOLDER = "docs/validity/cameras"
QUICK_FOLDER = "validity-cameras-quick"
WORK = "camera-rigs"
TITLE = "# Published camera rigs: do the scores rank them?"
PLAN = Path(__file__).parents[2] / FOLDER / "plan.md"
QUICK = CameraEffort(interval=0.5, scenes=8, permutations=99, resamples=50)


def held_against_rigs(args: argparse.Namespace, folder: Path) -> Answer:
    """Write the page and results.json."""
    check_page(folder, TITLE, "cameras")
    folder = prepare_folder(folder)
    if args.page_only:
        found = read_json(folder / RESULTS)
    elif args.rigs is None:
        raise InputError("studies.cameras", "FILE", "the file of rigs, or --page-only", "neither")
    else:
        found = measured(args)
    write_study(folder, found, page_of(found))
    return dump_json(found) if args.json else _summary(found), DONE


def measured(args: argparse.Namespace) -> Json:
    """Return all figures as JSON data; rigs that the working folder has are not scored again."""
    effort = QUICK if args.quick else CameraEffort()
    rigs = read_rigs(Path(args.rigs), args.detectors)
    tasks = tasks_of(rigs, effort)
    work = prepare_folder(Path(args.work) / rigs.digest[:16])

    def missing(done: Values) -> list[Task]:
        return [task for task in tasks if task.name not in done]

    values = compute(work, effort, missing, args.workers).values
    return conclusions(rigs, values, effort)


def tasks_of(rigs: PublishedRigs, effort: CameraEffort) -> list[Task]:
    """Return the tasks: each rig on its plate, and those of cars on the sedan."""
    chosen = [(PLATE, rig) for rig in rigs.rigs]
    chosen += [(SEDAN, rig) for rig in rigs.rigs if rig.vehicle in CARS]
    return [
        Task(task_name(body, rig.name), scored_rig, {"rig": rig, "body": body, "effort": effort})
        for body, rig in chosen
    ]


def task_name(body: str, rig: str) -> str:
    """Return the name of a rig on a body."""
    return f"{body}/{rig}"


def conclusions(rigs: PublishedRigs, values: Values, effort: CameraEffort) -> Json:
    """Return what follows from the scored rigs, by their tasks' names, as JSON data."""
    on_plate = {name: values[task_name(PLATE, name)] for name in RIGS}
    scores = {name: found["scores"] for name, found in on_plate.items()}
    pixels = {name: found["pixels"] for name, found in on_plate.items()}
    figures = all_figures(rigs, scores, effort)
    by_score = verdicts(figures)
    return plain(
        {
            "made": made_by(effort),
            "plan": hashlib.sha256(read_bytes(PLAN)).hexdigest(),
            "data": rigs.digest,
            "detectors": list(rigs.by_detector),
            **figures,
            "verdicts": by_score,
            "seen_becomes_figure": seen_becomes_figure(by_score),
            "sedan": _on_sedan(rigs, scores, values),
            "curves": camera_curves(rigs, pixels, effort),
            "scores": scores,
        }
    )


def _on_sedan(rigs: PublishedRigs, on_plate: Json, values: Values) -> Json | None:
    """Return rho of each score with cars over the rigs on cars, with the plate and the sedan.

    None while some of them are not scored on the sedan.
    """
    names = [rig.name for rig in rigs.rigs if rig.vehicle in CARS]
    if not all(task_name(SEDAN, name) in values for name in names):
        return None
    ap = rigs.ap(CARS_OUTCOME)[[RIGS.index(name) for name in names]]
    bodies = {
        PLATE: {name: on_plate[name] for name in names},
        SEDAN: {name: values[task_name(SEDAN, name)]["scores"] for name in names},
    }
    found: Json = {"rigs": len(names), "rho": {}}
    for score in SCORES:
        rows = {body: values_of_score(own, CARS_OUTCOME, score) for body, own in bodies.items()}
        found["rho"][score] = {body: _rho(own, ap) for body, own in rows.items()}
    return found


def _rho(values: Any, ap: np.ndarray) -> float | None:
    return None if values is None else spearman(values, ap)


def page_of(found: Json) -> str:
    """Return the page as Markdown."""
    return render(Path(__file__).with_name("page.md.j2"), {"found": found}, interval=interval_text)


def interval_text(limits: Sequence[float | None]) -> str:
    """Return the limits of an interval as text; empty where there is none."""
    low, high = limits
    return "" if low is None or high is None else f" ({low:+.2f} to {high:+.2f})"


def _summary(found: Json) -> str:
    """Return the verdicts on each score and each curve, for people."""
    lines = []
    for score, row in found["verdicts"].items():
        beyond = ", ".join(f"{rival}: {verdict}" for rival, verdict in row["5"].items())
        told = "; ".join(f"{k} {row[k]}" for k in ("1", "2", "3", "4", "6"))
        lines.append(f"{score}: {told}; 5 {beyond or '-'}; shown: {row['shown']}")
    for name, row in found["curves"].items():
        told = "; ".join(f"{k} {verdict}" for k, verdict in row["verdicts"].items())
        lines.append(f"curve of {name}: a {row['a']:.4f}, b {row['b']:.4f}; {told}")
    return "\n".join(lines)


if __name__ == "__main__":
    parser, _ = page_parser(
        "cameras", str(__doc__), (FOLDER, QUICK_FOLDER), "few voxels and scenes, in a minute"
    )
    parser.add_argument("rigs", metavar="FILE", nargs="?", help="the published rigs and their AP")
    about = f"detectors of the file that are judged (default {' '.join(DETECTORS)})"
    parser.add_argument("--detectors", nargs="+", metavar="NAME", default=DETECTORS, help=about)
    about = f"folder that keeps each scored rig, to go on from (default {WORK})"
    parser.add_argument("--work", metavar="DIR", default=WORK, help=about)
    main(parser, held_against_rigs)
