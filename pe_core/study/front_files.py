"""What a choice leaves in its output folder: front.json, front.csv, and a study a design."""

from __future__ import annotations

import csv
import io
import re
import unicodedata
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..scene.sensors import SensorModel
from ..text.json_text import dump_json, finite
from .choice_job import Design, TradeOff
from .exporting import study_writers
from .folder import FileSet, Write, our_files, prepare_folder
from .names import STUDY
from .results import placements, run_dict
from .study import vehicle_digest
from .study_file import study_to_dict

FRONT_JSON, FRONT_CSV, FRONT_PLOT, DESIGNS = "front.json", "front.csv", "front.png", "designs"
FRONT_NAMES = (FRONT_JSON, FRONT_CSV, FRONT_PLOT)
"""Files of a front; the plot is drawn by others, where matplotlib is."""
FRONT_SCHEMA = 1
LONGEST_STEM = 80
"""Characters of a design's file name."""


def front_dict(chosen: TradeOff, host: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return a choice as plain JSON data; all but `run` follows from the study alone."""
    files = design_files(chosen)
    selection = chosen.study.selection
    data = {
        "schema": FRONT_SCHEMA,
        "kind": "front",
        "seed": chosen.study.search.seed,
        "currency": selection.currency,
        "looked_at": len(chosen.designs) + len(chosen.refused),
        "searched": chosen.searched,
        "all_designs_looked_at": chosen.is_complete,
        "stopped": chosen.stopped,
        "front": [design.name for design in chosen.front],
        "designs": [_design_dict(d, d in chosen.front, files) for d in chosen.designs],
        "refused": chosen.refused,
        "inputs": {
            "study": study_to_dict(chosen.study),
            "vehicle_sha256": vehicle_digest(chosen.study.vehicle),
        },
        "run": run_dict(chosen.seconds, host or {}),
    }
    return finite(data)


def write_front(
    chosen: TradeOff, folder: str | Path, host: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """Write front.json, front.csv and a study for each design of the front; return the JSON data.

    The studies are in the folder `designs`, each with its best placement, beside one mesh. Studies
    that an earlier run left there are taken away if nobody has changed them.

    Raises
    ------
    InputError
        The folder cannot be written, or a file of one of these names in it is not ours.
    """
    folder, data = prepare_folder(folder, FRONT_NAMES), front_dict(chosen, host)
    beside = prepare_folder(folder / DESIGNS)
    with FileSet(beside) as files:
        files.take_away(list(our_files(beside)))
        for name, write in _writers(chosen).items():
            files.add(name, write)
    with FileSet(folder) as files:
        files.take_away([FRONT_PLOT])  # it would tell of an earlier run
        files.add(FRONT_CSV, front_csv(chosen).encode(errors="backslashreplace"))
        files.add(FRONT_JSON, dump_json(data).encode(errors="backslashreplace"))
    return data


def front_csv(chosen: TradeOff) -> str:
    """Return all designs as CSV, cheapest first: price, entropy, and the model of each sensor."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    sensors = [sensor.name for sensor in chosen.study.rig]
    head = ["design", "on_front", "price", "entropy", "coverage", "searched"]
    writer.writerow([*head, *(f"{name}.model" for name in sensors)])
    for design in chosen.designs:
        taken = {sensor.name: sensor.model.name for sensor in design.study.rig}
        figures = (design.price, design.entropy, _coverage(design), int(design.score is not None))
        on_front = int(design in chosen.front)
        models = (taken.get(name, "") for name in sensors)
        writer.writerow([design.name, on_front, *figures, *models])
    return text.getvalue()


def design_files(chosen: TradeOff) -> dict[str, str]:
    """Return the study file of each design on the front, by its name."""
    found: dict[str, str] = {}
    for design in chosen.front:
        stem, number = _stem(design.name), 1
        while (file := f"{stem}{f'-{number}' if number > 1 else ''}.toml") in found.values():
            number += 1
        found[design.name] = file
    return found


def _stem(name: str) -> str:
    """Return a name as plain letters, digits and dashes, which every file system has."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:LONGEST_STEM].strip("-") or "design"


def _writers(chosen: TradeOff) -> dict[str, Write | bytes]:
    """Return what writes the studies of the front; mesh and boxes are those of all."""
    files, writers = design_files(chosen), dict[str, Write | bytes]()
    for design in chosen.front:
        own = study_writers(design.study, STUDY)
        own[files[design.name]] = own.pop(STUDY)
        writers |= own
    return writers


def _design_dict(design: Design, on_front: bool, files: Mapping[str, str]) -> dict[str, Any]:
    file = f"{DESIGNS}/{files[design.name]}" if on_front else None
    return {
        "name": design.name,
        "on_front": on_front,
        "price": design.price,
        "entropy": design.entropy,
        "coverage": _coverage(design),
        "stderr": None if design.score is None else design.score.stderr,
        "searched": design.score is not None,
        "models": {name: _model_name(model) for name, model in design.models.items()},
        "placements": placements(design.study.rig),
        "warnings": [each.to_dict() for each in design.warnings],
        "study": file,
    }


def _model_name(model: SensorModel | None) -> str | None:
    return None if model is None else model.name


def _coverage(design: Design) -> float | None:
    return None if design.score is None else design.score.coverage
