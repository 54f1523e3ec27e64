"""What a search left in its folder, as the outcome that it was."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from .engine import pe, search, studies, text

RESULT_BYTES = 1 << 28
"""The greatest result.json that is read."""


def outcome_of_folder(folder: Path, score: Callable[[pe.Study], pe.Outcome]) -> pe.Outcome | None:
    """Return the outcome of the search that is in a folder; None where none is.

    Start and end are scored again, for what a score tells besides what is written; how the search
    went is read.

    Raises
    ------
    InputError
        When a file of the search is damaged, or not of this version.
    """
    if not (folder / studies.SEARCH).exists() or not (folder / studies.RESULT).exists():
        return None
    begun, path = studies.read_search(folder), folder / studies.RESULT
    start = begun.study
    found = start.with_rig(pe.load_study(folder / studies.STUDY).rig)
    try:
        told = json.loads(text.read_bytes(path, RESULT_BYTES))
        history = tuple(_row(start.rig, row) for row in told["history"])
        robustness = _robustness(told.get("robustness"))
        warnings = tuple(_advice(each) for each in told["warnings"])
        evaluations, stopped = int(told["evaluations"]), bool(told["stopped"])
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError) as error:
        if isinstance(error, pe.InputError):
            raise
        expected = "what a search of this version leaves"
        raise pe.InputError(path, "file", expected, "another file") from None
    before = score(start).after
    after = before if found.rig == start.rig else score(found).after
    parts = (start, found, before, after, history, evaluations, stopped, 0.0, warnings)
    return pe.Outcome("optimize", *parts, begun.inputs, begun.judged, robustness)


def command_of_folder(folder: Path) -> str:
    """Return the command line that a folder's results were made by; empty where it is not told."""
    told = json.loads(text.read_bytes(folder / studies.RESULT, RESULT_BYTES))
    return str(told.get("run", {}).get("command", ""))


def _row(rig: pe.Rig, row: Mapping[str, Any]) -> studies.HistoryRow:
    placed = row["placements"]
    poses = [
        pe.Pose.from_degrees(placed[s.name]["position"], placed[s.name]["rotation"]) for s in rig
    ]
    numbers = int(row["evaluation"]), int(row["round"]), float(row["entropy"])
    return studies.HistoryRow(*numbers, rig.with_poses(poses))


def _robustness(told: Mapping[str, Any] | None) -> search.Robustness | None:
    if told is None:
        return None
    errors = search.Tolerance(told["position"], math.radians(told["angle"]), draws=told["draws"])
    stands = (search.Stands(**told[which]) for which in ("before", "after"))
    return search.Robustness(errors, int(told["samples"]), *stands)


def _advice(told: Mapping[str, Any]) -> pe.Advice:
    return replace(pe.Advice(**told), amount=tuple(told["amount"]))
