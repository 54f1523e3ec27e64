"""Files of a Pareto front of designs: front.json, front.csv, and one study for each design."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core.base.csv_text import csv_text
from pe_core.base.file_stem import file_stem
from pe_core.base.serialization import dump_json, finite
from pe_core.scene.rig import SensorModel
from pe_core.study.file_names import STUDY
from pe_core.study.study import vehicle_digest
from pe_core.study.study_file import study_to_dict

from .folder import FileSet, Write, our_files, prepare_folder
from .results import placements, run_dict
from .study_export import study_writers
from .trade_off import Design, TradeOff

FRONT_JSON, FRONT_CSV, FRONT_PLOT, DESIGNS = "front.json", "front.csv", "front.png", "designs"
FRONT_PAGE = "front.html"
FRONT_NAMES = (FRONT_JSON, FRONT_CSV, FRONT_PLOT, FRONT_PAGE)
"""Files of a front. Other rooms write the page, and the plot where matplotlib is installed."""
FRONT_SCHEMA = 1
MAX_STEM_LENGTH = 80
"""Maximum number of characters of a design's file name, without the suffix."""


def front_dict(chosen: TradeOff, host: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return a trade-off as plain JSON data.

    All of it but `run` depends on the study alone. `host` has versions of the host program by name.
    """
    files = design_files(chosen)
    selection = chosen.study.selection
    data = {
        "schema": FRONT_SCHEMA,
        "kind": "front",
        "seed": chosen.study.search.seed,
        "currency": selection.currency,
        **({"objectives": list(chosen.objectives)} if chosen.objectives else {}),
        "looked_at": len(chosen.designs) + len(chosen.refused),
        "searched": chosen.searched,
        "all_designs_looked_at": chosen.is_complete,
        "stopped": chosen.stopped,
        "front": [design.name for design in chosen.front],
        "designs": [_design_dict(d, d in chosen.front, files) for d in chosen.designs],
        "refused": chosen.refused,
        "notes": chosen.notes,
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

    The studies are in the folder `designs`, each with its best placement; they share one mesh.
    Studies of an earlier run are removed from there if nobody has changed them.

    Parameters
    ----------
    chosen : TradeOff
    folder : path
    host : mapping of str to str, optional
        Versions of the host program by name.

    Raises
    ------
    InputError
        The folder cannot be written, or one of these files in it was not written by this program.
    """
    folder, data = prepare_folder(folder, FRONT_NAMES), front_dict(chosen, host)
    designs_folder = prepare_folder(folder / DESIGNS)
    # All is written before the first file gets its name: on a full disk the old set stays whole.
    with FileSet(folder) as files, FileSet(designs_folder) as designs:
        designs.take_away(list(our_files(designs_folder)))
        for name, write in _writers(chosen).items():
            designs.add(name, write)
        files.take_away([FRONT_PLOT, FRONT_PAGE])  # they show the front of an earlier run
        files.add(FRONT_CSV, front_csv(chosen).encode(errors="backslashreplace"))
        files.add(FRONT_JSON, dump_json(data).encode(errors="backslashreplace"))
    return data


def front_csv(chosen: TradeOff) -> str:
    """Return all designs as CSV, cheapest first: price, entropy, and the model of each sensor."""
    sensors = [sensor.name for sensor in chosen.study.rig]
    head = ["design", "on_front", "price", "entropy", "coverage", "searched"]
    asked = bool(chosen.study.requirements)
    more = ["requirements_met"] if asked else []
    more += [f"objective.{name}" for name in chosen.objectives]
    rows: list[list[object]] = [[*head, *more, *(f"{name}.model" for name in sensors)]]
    for design in chosen.designs:
        models_by_sensor = {sensor.name: sensor.model.name for sensor in design.study.rig}
        figures = (design.price, _entropy(design), _coverage(design), int(design.score is not None))
        met: list[object] = [_met(design)] if asked else []
        met += [design.figures.get(name) for name in chosen.objectives]
        on_front = int(design in chosen.front)
        models = (models_by_sensor.get(name, "") for name in sensors)
        rows.append([design.name, on_front, *figures, *met, *models])
    return csv_text(rows)


def design_files(chosen: TradeOff) -> dict[str, str]:
    """Return the name of the study file of each design on the front, by design name."""
    files: dict[str, str] = {}
    for design in chosen.front:
        stem = file_stem(design.name.lower(), "design", joint="-", max_length=MAX_STEM_LENGTH)
        number = 1
        while (file := f"{stem}{f'-{number}' if number > 1 else ''}.toml") in files.values():
            number += 1
        files[design.name] = file
    return files


def _writers(chosen: TradeOff) -> dict[str, Write | bytes]:
    """Return the writers of the studies of the front by file name; mesh and boxes are shared."""
    files, writers = design_files(chosen), dict[str, Write | bytes]()
    for design in chosen.front:
        design_writers = study_writers(design.study, STUDY)
        design_writers[files[design.name]] = design_writers.pop(STUDY)
        writers |= design_writers
    return writers


def _design_dict(design: Design, on_front: bool, files: Mapping[str, str]) -> dict[str, Any]:
    file = f"{DESIGNS}/{files[design.name]}" if on_front else None
    return {
        "name": design.name,
        "on_front": on_front,
        "price": design.price,
        "entropy": _entropy(design),
        "coverage": _coverage(design),
        "stderr": None if design.score is None else design.score.stderr,
        "searched": design.score is not None,
        "models": {name: _model_name(model) for name, model in design.models.items()},
        "placements": placements(design.study.rig),
        "warnings": [warning.to_dict() for warning in design.warnings],
        "study": file,
        **({"figures": dict(design.figures)} if design.figures else {}),
        **_requirements(design),
    }


def _requirements(design: Design) -> dict[str, Any]:
    """Return how many requirements a design meets, and which not; empty without any."""
    if not design.verdicts:
        return {}
    return {"requirements_met": _met(design), "requirements_not_met": list(design.broken)}


def _met(design: Design) -> int | None:
    """Return how many requirements are met; None for a design that was only screened."""
    return len(design.verdicts) - len(design.broken) if design.verdicts else None


def _entropy(design: Design) -> float | None:
    """Return the entropy; None where a screening found no placement that keeps requirements, or
    went by expected AP."""
    return None if design.is_led_in or math.isnan(design.entropy) else design.entropy


def _model_name(model: SensorModel | None) -> str | None:
    return None if model is None else model.name


def _coverage(design: Design) -> float | None:
    return None if design.score is None else design.score.coverage
