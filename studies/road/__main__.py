"""``python -m studies.road FOLDER``: predicted beams against points measured on the road."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core.base import dump_json
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import logs_parser, main
from ..pages import check_page, render, write_study
from ..results_file import RESULTS, Json, made_by, print_progress, read_json
from .logs import CLASSES, Log, read_lidars, read_logs
from .models import SOLID, STEPS, Fitted, cells_of, crossings, fit, loss
from .statistics import BOOTSTRAP, compared, hidden_and_seen, read_cameras, statements

FOLDER = "docs/validity/road"
TITLE = "# Points on the road: predicted and counted"
FIT_EVERY = 5
GAIN = 0.01
"""Frames of a fit: those 0.1 s apart are nearly the same. A step is kept for this share of loss."""
CHUNK = 12
"""Frames measured together: a bound of the memory."""


def predicted(log: Log, rig: pe.Rig, steps: list[Fitted]) -> list[np.ndarray]:
    """Return the expected points (N,) of a log's boxes by each step."""
    found = [np.zeros(len(log.points)) for _ in steps]
    scenes = log.objects.scenes
    for first in range(0, int(scenes.max()) + 1, CHUNK):
        kept = np.flatnonzero((scenes >= first) & (scenes < first + CHUNK))
        if len(kept):
            beams = crossings(log.some(kept), rig)
            for m, step in zip(found, steps, strict=True):
                m[kept] = step.predicted(beams)
    return found


def kept_step(losses: list[dict[str, float]]) -> str:
    """Return the last step whose mean loss is below that of the step before by at least 1 %."""
    means = [float(np.mean([own[step] for own in losses])) for step in STEPS]
    kept = 0
    for k in range(1, len(STEPS)):
        if means[k] <= (1.0 - GAIN) * means[kept]:
            kept = k
    return STEPS[kept]


def values_of(step: Fitted) -> Json:
    """Return the values of a step by class; a half distance of None: returns do not fade."""
    halves = [None if np.isinf(h) else float(h) for h in step.half]
    pairs = zip(CLASSES, step.fill.round(3).tolist(), halves, strict=True)
    return {name: {"fill": fill, "half_m": half} for name, fill, half in pairs}


def held_against_the_road(args: argparse.Namespace, folder: Path) -> Answer:
    """Write the page and results.json."""
    check_page(folder, TITLE, "road")
    folder = prepare_folder(folder)
    found = measured(args) if args.logs else read_json(folder / RESULTS)
    write_study(folder, found, page(found))
    return dump_json(found) if args.json else _summary(found), DONE


def measured(args: argparse.Namespace) -> Json:
    """Return all figures as JSON data."""
    logs = read_logs(Path(args.logs))
    rig = read_lidars(Path(args.logs))
    further = read_logs(Path(args.further)) if args.further else []
    beams = [crossings(log.every(FIT_EVERY), rig) for log in logs]
    found: Json = {"logs": {}, "steps": {}, "values": {}}
    fits = []
    predictions = []
    for k, log in enumerate(logs):
        print_progress(f"{log.name}: fitting to the others")
        others = [b for j, b in enumerate(beams) if j != k]
        fits.append([fit(step, others) for step in STEPS])
        predictions.append(predicted(log, rig, fits[k]))
        losses = {s: round(loss(log, m), 4) for s, m in zip(STEPS, predictions[k], strict=True)}
        found["steps"][log.name] = losses
    kept = found["kept"] = kept_step(list(found["steps"].values()))
    last = STEPS.index(kept)
    final = fit(kept, beams)
    found["values"] = {log.name: values_of(own[last]) for log, own in zip(logs, fits, strict=True)}
    found["values"]["all logs"] = values_of(final)
    for log, m in zip(logs, predictions, strict=True):
        print_progress(f"{log.name}: judging")
        own = {SOLID: m[0], kept: m[last]}
        found["logs"][log.name] = {s: compared(log, w, cells_of(log)) for s, w in own.items()}
    for log in further:
        m = predicted(log, rig, [fit(SOLID, beams), final])
        own = dict(zip((SOLID, kept), m, strict=True))
        found["logs"][log.name] = {s: compared(log, w, cells_of(log)) for s, w in own.items()}
    judged = {s: {name: by[s] for name, by in found["logs"].items()} for s in (SOLID, kept)}
    found["statements"] = {step: statements(by_log) for step, by_log in judged.items()}
    found["further"] = [log.name for log in further]
    print_progress("cameras")
    name, cameras = read_cameras(Path(args.logs))
    (log,) = (each for each in logs if each.name == name)
    found["cameras"] = hidden_and_seen(log.every(FIT_EVERY), cameras)
    found["made"] = made_by(BOOTSTRAP)
    return found


def page(found: Json) -> str:
    """Return the page as Markdown."""
    return render(Path(__file__).with_name("page.md.j2"), {"found": found, "classes": CLASSES[:-1]})


def _summary(found: Json) -> str:
    """Return the verdict on each goal, by model, for people."""
    return "\n".join(
        f"{row['verdict']:12} {row['figure']} ({step}): {row['inside']} cells inside"
        for step, rows in found["statements"].items()
        for row in rows
    )


if __name__ == "__main__":
    parser = logs_parser("road", str(__doc__), FOLDER)
    about = "a folder of more logs: judged with what was fitted to all of FOLDER"
    parser.add_argument("--further", metavar="FOLDER", help=about)
    main(parser, held_against_the_road)
