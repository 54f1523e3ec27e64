"""What a run leaves in its output folder: result.json, history.csv, study.toml.

The files of a run are one set: `FileSet` puts them there together, result.json last, and that names
the SHA-256 of the others.
"""

from __future__ import annotations

import csv
import io
import json
import platform
from collections.abc import Collection, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from ..scene.sensors import Rig
from ..search import AXES
from ..text.files import read_bytes
from ..text.json_text import dump_json, finite
from ..version import __version__
from .exporting import study_writers
from .folder import FileSet, Write, our_files, prepare_folder, sha256_of
from .inputs import inputs_of
from .mounted import mounts_told
from .mounting_file import areas_of
from .names import AREAS, BESIDE_RESULT, BOXES, HISTORY, MESH, RESULT, SCHEMA, SEARCH, STUDY
from .outcome import HistoryRow, Outcome
from .search_state import SearchState
from .study import Study

EARLIER = ".earlier"


def result_names(study: Study, kind: str) -> list[str]:
    """Names of the files that a run of this kind (score or optimize) writes to its folder."""
    vehicle, boxes = study.vehicle is not None, study.prior.boxes is not None
    areas = bool(areas_of(study.search.mounting))
    with_study = [STUDY, *[MESH] * vehicle, *[AREAS] * areas, *[BOXES] * boxes]
    return [*with_study, *[HISTORY, SEARCH] * (kind == "optimize"), RESULT]


def result_dict(outcome: Outcome, host: dict[str, str] | None = None) -> dict[str, Any]:
    """Return a run as plain JSON data.

    Everything outside `run` follows from the study alone: two runs of the same study agree in it
    to the last bit. JSON has no word for what is not a number: that is null.
    """
    return finite(_result(outcome, host or {}))


def _result(outcome: Outcome, host: dict[str, str]) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "kind": outcome.kind,
        "seed": outcome.study.search.seed,
        "entropy": outcome.after.entropy,
        "coverage": outcome.after.coverage,
        "before": outcome.before.to_dict(),
        "after": outcome.after.to_dict(),
        "placements": {
            "before": placements(outcome.start.rig),
            "after": placements(outcome.study.rig),
        },
        "mounts": mounts_told(outcome.study.rig, outcome.study.search.mounting),
        **_robustness(outcome),
        **_searched(outcome),
        "evaluations": outcome.evaluations,
        "stopped": outcome.stopped,
        "warnings": [each.to_dict() for each in outcome.warnings],
        "history": [_history_dict(row) for row in outcome.history],
        "inputs": outcome.inputs or inputs_of(outcome.start),
        "run": run_dict(outcome.seconds, host),
    }


def _searched(outcome: Outcome) -> dict[str, Any]:
    """Return how a search was made; of a score, that there was none."""
    search = outcome.start.search
    found = outcome.kind == "optimize"
    return {
        "method": search.method if found else None,
        "level_samples": list(search.level_samples) if found else [],
    }


def run_dict(seconds: float, host: Mapping[str, str]) -> dict[str, Any]:
    """Return what a result says of the run: the time it took, and the programs."""
    return {
        "seconds": round(seconds, 3),
        "versions": {
            "perception-entropy": __version__,
            "numpy": np.__version__,
            "python": platform.python_version(),
            **host,
        },
    }


def placements(rig: Rig) -> dict[str, dict[str, list[float]]]:
    """Position [m] and roll, pitch, yaw [deg] of every sensor."""
    return {
        s.name: {"position": list(s.pose.position), "rotation": list(s.pose.rotation_deg)}
        for s in rig
    }


def write_outcome(
    outcome: Outcome,
    folder: str | Path,
    host: dict[str, str] | None = None,
    later: Collection[str] = (),
) -> dict[str, Any]:
    """Write result.json and the study, and of a search history.csv and its state; return the data.

    Files that an earlier run left in the folder, and that this one does not write, are taken away
    if they are ours and nobody has changed them: they would tell of another result. Those that are
    yet to come, `later`, stay until they are replaced.

    Raises
    ------
    InputError
        The folder cannot be written, or a file of one of these names in it is not ours: then all
        of it stays as it was.
    """
    folder, data = prepare_folder(folder), result_dict(outcome, host)
    writers = study_writers(outcome.study, STUDY)
    if outcome.kind == "optimize":
        writers[HISTORY] = history_csv(outcome.history).encode(errors="backslashreplace")
        writers[SEARCH] = SearchState(outcome.start, outcome.inputs).to_bytes(outcome.judged)
    add_to_result(data, folder, writers, unwanted=set(BESIDE_RESULT) - set(later))
    return data


def add_to_result(
    data: dict[str, Any],
    folder: Path,
    writers: Mapping[str, Write | bytes],
    unwanted: Collection[str] = (),
) -> None:
    """Write files of a run together with its result.json, in which their SHA-256 is noted.

    Of the `unwanted` those are taken away that are ours and not among them.
    """
    with FileSet(folder) as files:
        files.take_away(unwanted)
        digests = {name: files.add(name, write) for name, write in writers.items()}
        run = {**data["run"], "files": {**data["run"].get("files", {}), **digests}}
        text = dump_json({**data, "run": run})
        files.add(RESULT, text.encode(errors="backslashreplace"))
    data["run"] = run


def files_of_other_runs(folder: Path) -> list[str]:
    """Return names of result files in a folder that are not of the run its result.json tells of.

    They are an earlier run's, a later one's that was cut off, or were changed by hand.
    """
    try:
        named = json.loads(read_bytes(folder / RESULT))["run"]["files"]
        ours = set(our_files(folder))
        there = [n for n in BESIDE_RESULT if n in ours or n in named]
        digests = {n: sha256_of(folder / n) for n in there}
        return [n for n, digest in digests.items() if digest and digest != named.get(n)]
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError):
        return []


def set_aside_files_of_other_runs(folder: Path) -> dict[str, str]:
    """Rename an earlier run's files that stand beside a new result: ``optimized.earlier.blend``.

    Where a later file of a run cannot be written, on a full disk for instance, that of an earlier
    run would be taken for one of the same set. Nothing is removed.

    Returns
    -------
    dict of str
        New names by name; what cannot be renamed, or has been set aside before, stays.
    """
    renamed = {}
    for name in files_of_other_runs(folder):
        path = folder / name
        aside = path.with_name(f"{path.stem}{EARLIER}{path.suffix}")
        with suppress(OSError):
            if not aside.exists():
                path.rename(aside)
                renamed[name] = aside.name
    return renamed


def history_csv(history: tuple[HistoryRow, ...]) -> str:
    """Return the history as CSV: one row each time a better placement was found."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [s.name for s in history[0].rig] if history else []
    units = {a: "m" if a in "xyz" else "deg" for a in AXES}
    columns = [f"{name}.{axis}_{units[axis]}" for name in names for axis in AXES]
    writer.writerow(["evaluation", "round", "entropy", *columns])
    for row in history:
        poses = [(*s.pose.position, *s.pose.rotation_deg) for s in row.rig]
        writer.writerow([row.evaluation, row.round, row.entropy, *(v for p in poses for v in p)])
    return text.getvalue()


def _robustness(outcome: Outcome) -> dict[str, Any]:
    """Return what a search tells besides: a score has nothing of it."""
    found = outcome.robustness
    return {} if found is None else {"robustness": found.to_dict()}


def _history_dict(row: HistoryRow) -> dict[str, Any]:
    return {
        "evaluation": row.evaluation,
        "round": row.round,
        "entropy": row.entropy,
        "placements": placements(row.rig),
    }
