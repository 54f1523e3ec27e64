"""Reading results.json of ``pe validate``: checked whole before anything is drawn."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.text import dump_json

from ..form import Amount, Each, Form, Keyed, Text, check_keys
from ..read import ENTROPY, MADE, SCHEMA, SHARE, checked_entries, read_json
from .choices import BASE, variants
from .correlated import correlations, over_papers
from .effort import FULL, QUICK, ValidityEffort
from .plan import names

VOXEL_PART = {"entropy": ENTROPY, "coverage": SHARE}
OBJECT_PART = {"entropy": ENTROPY, "stderr": Amount(0.0), "ap": SHARE}
SHAPES: dict[str, Form] = {
    "voxels": Each(Keyed({**VOXEL_PART, "per_class": Each(Keyed(VOXEL_PART))})),
    "objects": Keyed({**OBJECT_PART, "per_class": Each(Keyed(OBJECT_PART))}),
}
"""What a result looks like, by the first part of its name."""
KEYS = ("schema", "made", "correlations", "over_papers", "results")


def read_results(path: Path) -> dict[str, Any]:
    """Read a complete results.json.

    Raises
    ------
    InputError
        When it is not one, of another version, damaged, or its correlations are not those of its
        scores.
    """
    data = read_json(path)
    if data.get("schema") != SCHEMA or "over_papers" not in data:
        raise InputError(path, "schema", f"complete results of schema {SCHEMA}", "others")
    check_keys(data, KEYS, path, "file")
    effort = _checked_made(path, data["made"])
    results = checked_results(path, data["results"])
    missing = set(names(effort)) ^ set(results)
    if missing:
        raise InputError(path, "results", "those of a complete run", f"not so: {min(missing)}")
    values = {name: entry["value"] for name, entry in results.items()}
    for key, found in judged(values, effort).items():
        if data[key] != json.loads(dump_json(found)):
            raise InputError(path, key, "what the scores give", "others")
    return data


def judged(values: Mapping[str, Any], effort: ValidityEffort) -> dict[str, Any]:
    """Return all that is said of the scores, as results.json has it."""
    tried = [way for way in variants(effort.all_variants) if way != BASE]
    return {"correlations": correlations(values, tried), "over_papers": over_papers(values)}


def checked_results(path: Path, results: Any) -> dict[str, dict[str, Any]]:
    """Return results by task name, each with its value and seconds, or raise `InputError`."""
    return checked_entries(path, results, _check_value)


def _check_value(path: Path, name: str, value: Any, field: str) -> None:
    kind = name.partition("/")[0]
    if kind not in SHAPES:
        raise InputError(path, "results", "what pe validate computes", ascii(name[:60]))
    SHAPES[kind].check(value, path, field)


def _checked_made(path: Path, made: Any) -> ValidityEffort:
    check_keys(made, (*MADE, "effort"), path, "made")
    for key in MADE:
        Text().check(made[key], path, f"made.{key}")
    for effort in (FULL, QUICK):
        if made["effort"] == json.loads(dump_json(vars(effort))):
            return effort
    raise InputError(path, "made.effort", "that of pe validate, or with --quick", "another")
