"""``python -m studies.tracks FOLDER``: when tracks are predicted to be seen, and when they were."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer, Parser

from ..command import main
from ..pages import PAGE, check_page, render
from ..results_file import RESULTS, Json, made_by, print_progress, read_json
from ..road.__main__ import FOLDER as ROAD
from ..road.__main__ import predicted
from ..road.logs import CLASSES, read_lidars, read_logs
from ..road.models import SOLID, Fitted
from .moments import (
    NEAR_S,
    POINTS,
    RESAMPLES,
    SEED,
    by_class_and_ring,
    pairs_of,
    persistence,
    verdict,
)
from .order import TABLE, expected, statements

FOLDER = "docs/validity/tracks"
TITLE = "# When is an object noticed: predicted and real tracks"
JUDGED = "5"
"""Points of the goals."""
GOALS = {
    "1. First sight of cars and pedestrians": ("car and pedestrian", "first_s", -NEAR_S, NEAR_S),
    "2. Confirmed tracks of cars and pedestrians": (
        "car and pedestrian",
        "confirmed_s",
        -NEAR_S,
        NEAR_S,
    ),
    "3. Nothing is seen that is not there": ("all", "invented", 0.0, 0.1),
}


@dataclass(frozen=True)
class Effort:
    """What `made_by` notes besides the versions."""

    resamples: int
    seed: int


def held_against_tracks(args: argparse.Namespace, folder: Path) -> Answer:
    """Write the page and results.json."""
    check_page(folder, TITLE, "tracks")
    folder = prepare_folder(folder)
    found = measured(args) if args.logs else read_json(folder / RESULTS)
    write_bytes(folder / RESULTS, dump_json(found).encode())
    write_bytes(folder / PAGE, page_of(found).encode())
    return dump_json(found) if args.json else "\n".join(" | ".join(r) for r in goals(found)), DONE


def page_of(found: Json) -> str:
    """Return the page of all figures, with the published ones."""
    own = {"found": found, "rows": rows(found), "goals": goals(found)}
    published = {"order": statements(), "expected": expected(), "published": read_json(TABLE)}
    return render(Path(__file__).parent, own | published)


def measured(args: argparse.Namespace) -> Json:
    """Return all figures as JSON data; the model `road` has what was fitted to the other logs."""
    logs, rig = read_logs(Path(args.logs)), read_lidars(Path(args.logs))
    road = read_json(Path(ROAD) / RESULTS)
    found: Json = {"logs": {}, "persistence": {}, "counts": {}}
    for log in logs:
        print_progress(log.name)
        values = road["values"].get(log.name, road["values"]["all logs"])
        fill = np.array([values[name]["fill"] for name in CLASSES])
        half = np.array([values[name]["half_m"] or np.inf for name in CLASSES])
        solid = Fitted(SOLID, np.ones(len(CLASSES)), np.full(len(CLASSES), np.inf))
        both = predicted(log, rig, [solid, Fitted(road["kept"], fill, half)])
        found["logs"][log.name] = {
            model: {str(n): by_class_and_ring(pairs_of(log, m, n)) for n in POINTS}
            for model, m in zip(("default", "road"), both, strict=True)
        }
        found["persistence"][log.name] = {str(n): persistence(log, both[1], n) for n in POINTS}
        found["counts"][log.name] = len(np.unique(log.tracks))
    found["made"] = made_by(Effort(RESAMPLES, SEED))
    return found


def goals(found: Json) -> list[list[str]]:
    """Return a row for each goal and model: verdict and value in each log."""
    table = []
    for goal, (cell, figure, low, high) in GOALS.items():
        for model in ("default", "road"):
            values = [log[model][JUDGED][cell].get(figure) for log in found["logs"].values()]
            texts = [f"{_text(v)}: {verdict(v, low, high)}" for v in values]
            table.append([goal, model, *texts])
    texts = []
    for log in found["logs"].values():
        errors = [log[model][JUDGED]["all"].get("error_s") for model in ("default", "road")]
        known = [e for e in errors if e is not None]
        better = (
            "not decided"
            if len(known) < 2
            else "lower"
            if known[1][0] < known[0][0]
            else "not lower"
        )
        texts.append(f"{_text(errors[0])}, {_text(errors[1])}: {better}")
    return [*table, ["4. Error of *confirmed*, default and road", "both", *texts]]


def rows(found: Json) -> list[list[str]]:
    """Return rows of cars and pedestrians: each log, number of points and model with figures."""
    return [
        [
            log[:8],
            n,
            model,
            f"{cell['both']} of {cell['tracks']}",
            *(_text(cell[key]) for key in ("first_s", "confirmed_s", "near", "missed", "invented")),
            "-" if cell["lost_rho"] is None else f"{cell['lost_rho']:.2f}",
        ]
        for log, by_model in found["logs"].items()
        for n in map(str, POINTS)
        for model in by_model
        if "near" in (cell := by_model[model][n].get("car and pedestrian", {}))
    ]


def _text(values: list[float] | None) -> str:
    if values is None:
        return "too few"
    value, low, high = values
    return f"{value:+.2f} ({low:+.2f} to {high:+.2f})"


if __name__ == "__main__":
    parser = Parser(prog="python -m studies.tracks", description=__doc__)
    about = "a folder of logs, each in a folder; without it the page is written from results.json"
    parser.add_argument("logs", metavar="FOLDER", nargs="?", help=about)
    about = f"folder for page and results.json (default {FOLDER})"
    parser.add_argument("-o", "--output", metavar="DIR", help=about)
    parser.add_argument("--json", action="store_true", help="print results.json on stdout")
    parser.set_defaults(default_folders=(FOLDER,), quick=False)
    main(parser, held_against_tracks)
