"""``python -m studies.road FOLDER``: predicted beams against points measured on the road."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core.base import dump_json, write_bytes
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer, Parser

from ..command import main
from ..pages import PAGE, check_page, render
from ..results_file import RESULTS, Json, made_by, print_progress, read_json
from .cameras import hidden_and_seen, read_cameras
from .logs import CLASSES, Log, read_lidars, read_logs
from .models import SOLID, STEPS, Fitted, cells_of, crossings, fit, loss
from .statistics import REFUTED, RESAMPLES, SEED, compared, statements

FOLDER = "docs/validity/road"
TITLE = "# Points on the road: predicted and counted"
FIT_EVERY, GAIN = 5, 0.01
"""Frames of a fit: those 0.1 s apart are nearly the same. A step is kept for this share of loss."""
CHUNK = 12
"""Frames measured together: a bound of the memory."""


@dataclass(frozen=True)
class Effort:
    """What `made_by` notes besides the versions."""

    resamples: int
    seed: int
    fit_every: int


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
    write_bytes(folder / RESULTS, dump_json(found).encode())
    write_bytes(folder / PAGE, page(found).encode())
    return dump_json(found) if args.json else _summary(found), DONE


def measured(args: argparse.Namespace) -> Json:
    """Return all figures as JSON data."""
    logs, rig = read_logs(Path(args.logs)), read_lidars(Path(args.logs))
    further = read_logs(Path(args.further)) if args.further else []
    beams = [crossings(log.every(FIT_EVERY), rig) for log in logs]
    found: Json = {"logs": {}, "steps": {}, "values": {}}
    fits, predictions = [], []
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
    found["made"] = made_by(Effort(RESAMPLES, SEED, FIT_EVERY))
    return found


def page(found: Json) -> str:
    """Return the page as Markdown."""
    return render(Path(__file__).parent, {"found": found, "t": Tables(found)})


class Tables:
    """The tables of the page."""

    def __init__(self, found: Json) -> None:
        self.found = found
        self.judged = {SOLID: "default", found["kept"]: "kept model"}

    def steps(self) -> list[list[str]]:
        """Return the loss of each step on each log, and the mean."""
        logs = list(self.found["steps"].values())
        rows = [[own[step] for own in logs] for step in STEPS]
        return [
            [step, *(f"{loss:.2f}" for loss in (*row, float(np.mean(row))))]
            for step, row in zip(STEPS, rows, strict=True)
        ]

    def values(self) -> list[list[str]]:
        """Return fill and half distance of each class, by what they were fitted without."""
        return [
            [name, *(_value(own[name]) for own in self.found["values"].values())]
            for name in CLASSES[:-1]
        ]

    def statements(self) -> list[list[str]]:
        """Return the verdict on each goal, by model."""
        return [
            [
                WORDS[row["figure"]],
                short,
                f"{row['inside']} of {sum(row['cells'].values())}",
                *(str(count) for count in row["cells"].values()),
                row["verdict"],
            ]
            for step, short in self.judged.items()
            for row in sorted(self.found["statements"][step], key=lambda r: WORDS[r["figure"]])
        ]

    def cells(self) -> list[list[str]]:
        """Return the cells in which a figure is refuted: boxes, tracks, before and after."""
        rows = []
        for log, by_step in self.found["logs"].items():
            before, after = (by_step[step] for step in self.judged)
            for name, rings in after.items():
                for ring, cell in rings.items():
                    old = before[name][ring]
                    texts = [_change(old.get(f), cell.get(f)) for f in ("ratio", "none", "rho")]
                    share = cell.get("without_points")
                    bare = "-" if share is None else f"{share:.2f}"
                    head = [log, name, ring, str(cell["boxes"]), str(cell["tracks"]), bare]
                    later = cell.get("poisson")
                    if any(REFUTED in text for text in texts):
                        rows.append([*head, *texts, "-" if later is None else f"{later:+.2f}"])
        return rows


WORDS = {
    "ratio": "1. As many points as predicted, cars and pedestrians",
    "none": "3. What has no point is predicted, all classes",
    "rho": "2. The order within a class, cars and pedestrians",
}


def _value(value: Json) -> str:
    return f"{value['fill']:.2f}, {'-' if value['half_m'] is None else round(value['half_m'])} m"


def _change(before: Json | float | None, after: Json | float | None) -> str:
    if after is None or before is None:
        return "-"
    if not (isinstance(before, dict) and isinstance(after, dict)):
        return f"{before:.2f} → {after:.2f}"
    if after["value"] is None or before["value"] is None:
        return "-"
    text = f"{before['value']:.2f} → {after['value']:.2f}"
    if "interval" not in after:
        return text
    low, high = after["interval"]
    return f"{text} ({low:.2f} to {high:.2f}) {MARKS[after['verdict']]}"


MARKS = {"holds": "holds", REFUTED: "**refuted**", "not decided": "open"}


def _summary(found: Json) -> str:
    return "\n".join(" | ".join(row) for row in Tables(found).statements())


if __name__ == "__main__":
    parser = Parser(prog="python -m studies.road", description=__doc__)
    about = "a folder of logs, each in a folder; without it the page is written from results.json"
    parser.add_argument("logs", metavar="FOLDER", nargs="?", help=about)
    about = "a folder of more logs: judged with what was fitted to all of FOLDER"
    parser.add_argument("--further", metavar="FOLDER", help=about)
    about = f"folder for page and results.json (default {FOLDER})"
    parser.add_argument("-o", "--output", metavar="DIR", help=about)
    parser.add_argument("--json", action="store_true", help="print results.json on stdout")
    parser.set_defaults(default_folders=(FOLDER,), quick=False)
    main(parser, held_against_the_road)
