"""``python -m studies.tracks FOLDER``: when tracks are predicted to be seen, and when they were."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from pe_core.base import dump_json
from pe_core.motion import CORRELATION_TIME_S
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import logs_parser, main
from ..pages import check_page, render, write_study
from ..results_file import RESULTS, Json, made_by, print_progress, read_json
from ..road.__main__ import FOLDER as ROAD
from ..road.__main__ import predicted
from ..road.logs import CLASSES, Log, read_lidars, read_logs
from ..road.models import SOLID, Fitted
from .memory import HEAD, memory, memory_statements, table_rows
from .moments import BOOTSTRAP, NEAR_S, POINTS, by_class_and_ring, pairs_of, persistence, verdict
from .order import TABLE, expected, statements

FOLDER = "docs/validity/tracks"
TITLE = "# When is an object noticed: predicted and real tracks"
CARS_AND_PEDESTRIANS = "car and pedestrian"
GOALS = {
    "1. First sight of cars and pedestrians": (CARS_AND_PEDESTRIANS, "first_s", -NEAR_S, NEAR_S),
    "2. Confirmed tracks of cars and pedestrians": (
        CARS_AND_PEDESTRIANS,
        "confirmed_s",
        -NEAR_S,
        NEAR_S,
    ),
    "3. Nothing is seen that is not there": ("all", "invented", 0.0, 0.1),
}


def held_against_tracks(args: argparse.Namespace, folder: Path) -> Answer:
    """Write the page and results.json."""
    check_page(folder, TITLE, "tracks")
    folder = prepare_folder(folder)
    found = measured(args) if args.logs else read_json(folder / RESULTS)
    text = page_of(found)
    write_study(folder, found, text)
    goals = next(block for block in text.split("\n\n") if block.startswith("| goal"))
    return dump_json(found) if args.json else goals, DONE


def page_of(found: Json) -> str:
    """Return the page of all figures, with the published ones."""
    values = {"found": found, "goals": GOALS, "points": POINTS, "verdict": verdict}
    seen = found["memory"]["5"]
    values |= {"memory_head": HEAD, "memory_rows": table_rows(seen)}
    values |= {"remembered": memory_statements(seen)}
    values |= {"default_s": CORRELATION_TIME_S}
    values |= {"order": statements(), "expected": expected(), "published": read_json(TABLE)}
    return render(Path(__file__).with_name("page.md.j2"), values)


def measured(args: argparse.Namespace) -> Json:
    """Return all figures as JSON data; the model `road` has what was fitted to the other logs."""
    logs = read_logs(Path(args.logs))
    rig = read_lidars(Path(args.logs))
    road = read_json(Path(ROAD) / RESULTS)
    found: Json = {"logs": {}, "persistence": {}, "counts": {}, "memory": {}}
    by_road: list[tuple[Log, np.ndarray]] = []
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
        by_road.append((log, both[1]))
        found["counts"][log.name] = len(np.unique(log.tracks))
    for n in POINTS:
        print_progress(f"memory, {n} points")
        found["memory"][str(n)] = memory(by_road, n)
    found["made"] = made_by(BOOTSTRAP)
    return found


if __name__ == "__main__":
    main(logs_parser("tracks", str(__doc__), FOLDER), held_against_tracks)
