"""Files of a Pareto front of designs: front.json, front.csv, and one study for each design."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core.base.codec import record
from pe_core.base.files import csv_text, file_stem
from pe_core.base.table_reader import dump_json, finite
from pe_core.study.file_names import STUDY
from pe_core.study.study_file import study_to_dict

from .folder import FileSet, Write, our_files, prepare_folder
from .result_record import FrontRecord, placements
from .results import run_record
from .study_export import study_writers
from .trade_off import Design, TradeOff

FRONT_JSON = "front.json"
FRONT_CSV = "front.csv"
DESIGNS = "designs"
FRONT_PAGE = "front.html"
FRONT_NAMES = (FRONT_JSON, FRONT_CSV, FRONT_PAGE)  # Files of a front. Other rooms write the page.
FRONT_SCHEMA = 1
MAX_STEM_LENGTH = 80  # Maximum number of characters of a design's file name, without the suffix


def front_dict(chosen: TradeOff, host: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return a trade-off as plain JSON data. All of it but `run` depends on the study alone. `host`
    has versions of the host program by name."""
    files = {name: f"{DESIGNS}/{file}" for name, file in design_files(chosen).items()}
    selection = chosen.study.selection
    made = FrontRecord(
        schema=FRONT_SCHEMA,
        kind="front",
        seed=chosen.study.search.seed,
        currency=selection.currency,
        objectives=tuple(chosen.objectives),
        looked_at=len(chosen.designs) + len(chosen.refused),
        searched=chosen.searched,
        all_designs_looked_at=chosen.is_complete,
        stopped=chosen.stopped,
        front=tuple(design.name for design in chosen.front),
        designs=tuple(
            _design_dict(d, d in chosen.front, files.get(d.name)) for d in chosen.designs
        ),
        refused=chosen.refused,
        notes=chosen.notes,
        inputs={"study": study_to_dict(chosen.study)},
        run=run_record(chosen.seconds, host or {}),
    )
    return finite(record(made))  # type: ignore[no-any-return]


def write_front(
    chosen: TradeOff, folder: str | Path, host: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """Write front.json, front.csv and a study for each design of the front; return the JSON data.

    The studies are in the folder `designs`, each with its best placement; they share one mesh.
    Studies of an earlier run are removed from there if nobody has changed them. `host` has versions
    of the host program by name.

    Raises
    ------
    InputError
        The folder cannot be written, or one of these files in it was not written by this program.
    """
    folder = prepare_folder(folder, FRONT_NAMES)
    data = front_dict(chosen, host)
    writers = dict[str, Write | bytes]()
    names = design_files(chosen)
    for design in chosen.front:  # mesh and boxes are shared
        own = study_writers(design.study, STUDY)
        writers |= {names[design.name] if name == STUDY else name: own[name] for name in own}
    designs_folder = prepare_folder(folder / DESIGNS)
    # All is written before the first file gets its name: on a full disk the old set stays whole.
    with FileSet(folder) as files, FileSet(designs_folder) as designs:
        designs.take_away(list(our_files(designs_folder)))
        for name, write in writers.items():
            designs.add(name, write)
        files.take_away([FRONT_PAGE])  # it shows the front of an earlier run
        files.add(FRONT_CSV, front_csv(chosen).encode(errors="backslashreplace"))
        files.add(FRONT_JSON, dump_json(data).encode(errors="backslashreplace"))
    return data


def front_csv(chosen: TradeOff) -> str:
    """Return all designs as CSV, cheapest first: price, entropy, and the model of each sensor."""
    sensors = [sensor.name for sensor in chosen.study.rig]
    head = ["design", "on_front", "price", "entropy", "coverage", "searched"]
    asked = ["requirements_met"] if chosen.study.requirements else []
    more = [f"objective.{name}" for name in chosen.objectives]
    rows: list[list[object]] = [[*head, *asked, *more, *(f"{name}.model" for name in sensors)]]
    for design in chosen.designs:
        models = {sensor.name: sensor.model.name for sensor in design.study.rig}
        data = _design_dict(design, design in chosen.front, None)
        figures = (data[key] for key in head[2:5])
        met = (data.get(key) for key in asked)
        found = (design.figures.get(name) for name in chosen.objectives)
        flags = int(data["on_front"]), *figures, int(data["searched"])
        rows.append([design.name, *flags, *met, *found, *(models.get(n, "") for n in sensors)])
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


def _design_dict(design: Design, on_front: bool, file: str | None) -> dict[str, Any]:
    """Return a design as plain data; `file` has its study. A screening that found no placement that
    keeps requirements, or went by expected AP, has no entropy. A design that was only screened was
    not held to requirements."""
    score = design.score
    no_entropy = design.is_infeasible or math.isnan(design.entropy)
    met = len(design.verdicts) - len(design.broken)
    asked = {"requirements_met": met, "requirements_not_met": list(design.broken)}
    return {
        "name": design.name,
        "on_front": on_front,
        "price": design.price,
        "entropy": None if no_entropy else design.entropy,
        "coverage": None if score is None else score.coverage,
        "stderr": None if score is None else score.stderr,
        "searched": score is not None,
        "models": {n: None if model is None else model.name for n, model in design.models.items()},
        "placements": record(placements(design.study.rig, design.study)),
        "warnings": [warning.to_dict() for warning in design.warnings],
        "study": file,
        "figures": {} if design.is_infeasible else dict(design.figures),
        **(asked if design.verdicts else {}),
    }
