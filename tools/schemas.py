#!/usr/bin/env python3
"""Write docs/schemas: JSON Schemas of study.toml and result.json.

The schema of a study is of the declarations that its reader follows; scores are the fields of the
engine's dataclasses. Names of other keys of a result stand here. A test holds both schemas to real
files.
"""

from __future__ import annotations

import json
import sys
import types
import typing
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import pe_core as pe  # noqa: E402
from pe_core.study import SCHEMA  # noqa: E402
from pe_core.study import study_schema as schema_of_study  # noqa: E402

FOLDER = ROOT / "docs" / "schemas"
STUDY_SCHEMA = 1
"""Version of the schema of a study: a number of its own, as that of a result."""
DRAFT = "https://json-schema.org/draft/2020-12/schema"
TEXT = {"type": "string"}
NUMBER = {"type": "number"}
SWITCH = {"type": "boolean"}


def numbers(count: int, item: Mapping[str, Any] = NUMBER) -> dict[str, Any]:
    """Return the schema of a list of so many numbers."""
    return {"type": "array", "items": item, "minItems": count, "maxItems": count}


def study_schema() -> dict[str, Any]:
    """Return the schema of study.toml."""
    head = {"$schema": DRAFT, "$id": f"urn:perception-entropy:study:{STUDY_SCHEMA}"}
    title = "A study of perception entropy: study.toml as plain data; lengths in m, angles in deg"
    return {**head, "title": title, **schema_of_study()}


def of_type(hint: Any) -> dict[str, Any]:
    """Return the schema of a dataclass's field as `to_dict` writes it."""
    origin = typing.get_origin(hint)
    inner = typing.get_args(hint)
    if is_dataclass(hint):
        hints = typing.get_type_hints(hint)
        keys = {each.name: of_type(hints[each.name]) for each in fields(hint)}
        return {"type": "object", "properties": keys, "required": list(keys)}
    if origin in (types.UnionType, typing.Union):
        return {"anyOf": [of_type(each) for each in inner]}
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": of_type(inner[1])}
    simple = {float: "number", int: "integer", bool: "boolean", str: "string", type(None): "null"}
    return {"type": simple[hint]}


def score_schema() -> dict[str, Any]:
    """Return the schema of a score: the fields that a file has."""
    hints = typing.get_type_hints(pe.Score)
    names = ("entropy", "coverage", "stderr", "voxels", "per_class", "per_zone", "per_sensor")
    keys = {name: of_type(hints[name]) for name in names}
    more = {"objects": of_type(pe.ObjectScore)}
    return {"type": "object", "properties": {**keys, **more}, "required": list(names)}


def result_schema() -> dict[str, Any]:
    """Return the schema of result.json."""
    score = {"$ref": "#/$defs/score"}
    pose = {"$ref": "#/$defs/placements"}
    both = {"type": "object", "required": ["before", "after"]}
    some = {"type": "object"}
    rows = {"type": "array", "items": some}
    of_row = {"evaluation": {"type": "integer"}, "round": {"type": "integer"}, "placements": pose}
    history = {"type": "array", "items": {"type": "object", "properties": of_row}}
    inputs = {"study": some, "study_sha256": TEXT, "vehicle_triangles": {"type": "integer"}}
    always = {
        "schema": {"const": SCHEMA},
        "kind": {"enum": ["score", "optimize"]},
        "seed": {"type": "integer"},
        "entropy": {"description": "Of the result [nats]; lower is better", **NUMBER},
        "coverage": {"description": "Of the result, 0 to 1", **NUMBER},
        "before": score,
        "after": score,
        "placements": {**both, "properties": {"before": pose, "after": pose}},
        "mounts": some,
        "method": {"type": ["string", "null"]},
        "level_samples": {"type": "array", "items": {"type": "integer"}},
        "ap_model": TEXT,
        "returns": TEXT,
        "evaluations": {"type": "integer", "minimum": 0},
        "stopped": SWITCH,
        "warnings": rows,
        "history": history,
        "inputs": {"type": "object", "properties": inputs, "required": list(inputs)},
        "run": {"type": "object", "properties": {"seconds": NUMBER}, "required": ["seconds"]},
    }
    at_times = {
        "robustness": some,
        "requirements": rows,
        "conditions": some,
        "starts": rows,
        "objective": TEXT,
        "expected_ap": some,
        "figures": both,
        "cost": TEXT,
        "flatness": {"type": ["object", "null"]},
        "stop_reason": {"type": ["string", "null"]},
        "seed_scatter": {"type": ["number", "null"]},
    }
    place = {"position": numbers(3), "rotation": numbers(3)}
    placed = {"type": "object", "properties": place, "required": list(place)}
    placements = {
        "description": "Position [m] and roll, pitch, yaw [deg] by sensor, ground frame",
        "type": "object",
        "additionalProperties": placed,
    }
    return {
        "$schema": DRAFT,
        "$id": f"urn:perception-entropy:result:{SCHEMA}",
        "title": "A result of perception entropy: result.json",
        "type": "object",
        "properties": {**always, **at_times},
        "required": list(always),
        "$defs": {"score": score_schema(), "placements": placements},
    }


def pages() -> dict[str, str]:
    """Return the text of each schema, by the name of its file."""
    made = {
        f"study-{STUDY_SCHEMA}.schema.json": study_schema(),
        f"result-{SCHEMA}.schema.json": result_schema(),
    }
    return {
        name: json.dumps(data, indent=1, ensure_ascii=False) + "\n" for name, data in made.items()
    }


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, text in pages().items():
        (FOLDER / name).write_text(text, "utf-8")
