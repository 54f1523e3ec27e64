"""Result folders of 0.1.0, which have no list of our files: which of theirs are clearly ours."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..formats.meshes import read_mesh
from ..text.files import decode_text, read_bytes
from .names import BOXES, HISTORY, MESH, OPTIMIZED, RESULT, REVIEW, SCHEMA, STUDY

HISTORY_HEAD = b"evaluation,round,entropy,"


def files_of_0_1(folder: Path, digest_of: Callable[[Path], str]) -> dict[str, list[str]]:
    """Names and SHA-256 of the files that a result.json of schema 1 in this folder tells of."""
    result = folder / RESULT
    if not digest_of(result):
        return {}
    try:
        data = json.loads(read_bytes(result))
        if data["schema"] != SCHEMA or data["kind"] not in ("score", "optimize"):
            return {}
        ours = [name for name, is_ours in _CHECKS.items() if _holds(is_ours, folder, data)]
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError):
        return {}
    return {name: [digest] for name in (RESULT, *ours) if (digest := digest_of(folder / name))}


def _holds(is_ours: Callable[[Path, Any], bool], folder: Path, data: Any) -> bool:
    try:
        return is_ours(folder, data)
    except (InputError, OSError, AttributeError, KeyError, RecursionError, TypeError, ValueError):
        return False


def _is_its_study(folder: Path, data: Any) -> bool:
    """Whether the study has just the placements that were found."""
    study = tomllib.loads(decode_text(read_bytes(folder / STUDY)))
    placed = {s["name"]: [s["position"], s["rotation"]] for s in study["sensor"]}
    found = data["placements"]["after"]
    return placed == {name: [p["position"], p["rotation"]] for name, p in found.items()}


def _is_its_mesh(folder: Path, data: Any) -> bool:
    triangles = read_mesh(folder / MESH).triangles
    digest = hashlib.sha256(triangles.tobytes()).hexdigest()
    return bool(digest == data["inputs"]["vehicle_sha256"])


def _are_its_boxes(folder: Path, data: Any) -> bool:
    study = tomllib.loads(decode_text(read_bytes(folder / STUDY)))
    return _is_its_study(folder, data) and study["prior"]["boxes"] == BOXES


def _is_its_history(folder: Path, data: Any) -> bool:
    lines = read_bytes(folder / HISTORY)
    return lines.startswith(HISTORY_HEAD) and lines.count(b"\n") == len(data["history"]) + 1


def _came_from_blender(_folder: Path, data: Any) -> bool:
    return "blender" in data["run"]["versions"]


_CHECKS: dict[str, Callable[[Path, Any], bool]] = {
    STUDY: _is_its_study,
    MESH: _is_its_mesh,
    BOXES: _are_its_boxes,
    HISTORY: _is_its_history,
    **dict.fromkeys((OPTIMIZED, REVIEW), _came_from_blender),
}
