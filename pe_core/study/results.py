"""What a run leaves in its output folder: result.json, history.csv, study.toml."""

from __future__ import annotations

import csv
import io
import platform
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..formats.boxes import write_boxes
from ..formats.meshes import Mesh, write_mesh
from ..scene.sensors import Rig
from ..search.optimize import AXES
from ..text.files import write_bytes
from ..text.json_text import dump_json, finite
from ..version import __version__
from .jobs import HistoryRow, Outcome
from .prior_file import BOXES
from .study import Study, vehicle_digest
from .study_file import save_study, study_to_dict

SCHEMA = 1
RESULT, HISTORY, STUDY, MESH = "result.json", "history.csv", "study.toml", "vehicle.npz"


def prepare_folder(folder: str | Path) -> Path:
    """Make the output folder, or raise `InputError` now rather than after the work is done."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(folder, "output", "a folder that can be written", reason) from None
    return folder


def result_dict(outcome: Outcome, host: dict[str, str] | None = None) -> dict[str, Any]:
    """Return a run as plain JSON data.

    Everything outside `run` follows from the study alone: two runs of the same study agree in it
    to the last bit.
    """
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
        "evaluations": outcome.evaluations,
        "stopped": outcome.stopped,
        "history": [_history_dict(row) for row in outcome.history],
        "inputs": {
            "study": finite(study_to_dict(outcome.start)),
            "vehicle_triangles": _triangle_count(outcome.study),
            "vehicle_sha256": vehicle_digest(outcome.study.vehicle),
        },
        "run": {
            "seconds": round(outcome.seconds, 3),
            "versions": {
                "perception-entropy": __version__,
                "numpy": np.__version__,
                "python": platform.python_version(),
                **(host or {}),
            },
        },
    }


def placements(rig: Rig) -> dict[str, dict[str, list[float]]]:
    """Position [m] and roll, pitch, yaw [deg] of every sensor."""
    return {
        s.name: {"position": list(s.pose.position), "rotation": list(s.pose.rotation_deg)}
        for s in rig
    }


def write_outcome(
    outcome: Outcome, folder: str | Path, host: dict[str, str] | None = None
) -> dict[str, Any]:
    """Write result.json, history.csv (of a search) and the study; return result.json's data."""
    folder = prepare_folder(folder)
    data = result_dict(outcome, host)
    if outcome.kind == "optimize":
        write_bytes(folder / HISTORY, history_csv(outcome.history).encode())
    export_study(outcome.study, folder / STUDY)
    write_bytes(folder / RESULT, dump_json(data).encode())
    return data


def export_study(study: Study, path: str | Path) -> None:
    """Write a study, its vehicle's mesh and its prior's boxes side by side, to run anywhere."""
    path = Path(path)
    if study.vehicle is not None:
        vehicle = study.vehicle
        mesh = path.with_name(MESH) if path.name == STUDY else path.with_suffix(".npz")
        parts = np.asarray(vehicle.parts)
        write_mesh(mesh, Mesh(vehicle.triangles, parts, tuple(vehicle.part_names)))
        study = study.with_mesh(mesh.name)
    if study.prior.boxes is not None:
        table = path.with_name(BOXES) if path.name == STUDY else path.with_suffix(f".{BOXES}")
        write_boxes(table, study.prior.boxes)
        boxes = replace(study.prior.boxes, file=table.name, origin=None)
        study = replace(study, prior=replace(study.prior, boxes=boxes))
    save_study(study, path)


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


def _history_dict(row: HistoryRow) -> dict[str, Any]:
    return {
        "evaluation": row.evaluation,
        "round": row.round,
        "entropy": row.entropy,
        "placements": placements(row.rig),
    }


def _triangle_count(study: Study) -> int:
    return 0 if study.vehicle is None else len(study.vehicle.triangles)
