#!/usr/bin/env python3
"""Write docs/schemas: JSON Schemas of study.toml and result.json.

Settings, with their ranges, are those that the engine declares; scores are the fields of its
dataclasses. Names of other keys stand here. A test holds the schema of a study to the keys that
the reader asks for, and both schemas to real files.
"""

from __future__ import annotations

import json
import math
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
from pe_core.search.limits import LimitRule  # noqa: E402
from pe_core.sensors import BLIND_RULES  # noqa: E402
from pe_core.study import (  # noqa: E402
    METHODS,
    REQUIRED,
    SCHEMA,
    Angle,
    Name,
    Number,
    OneOf,
    Pair,
    Setting,
    Several,
    Texts,
    Toggle,
    Triple,
    Whole,
    setting_keys,
    value_in_file,
)

FOLDER = ROOT / "docs" / "schemas"
STUDY_SCHEMA = 1
"""Version of the schema of a study: a number of its own, as that of a result."""
DRAFT = "https://json-schema.org/draft/2020-12/schema"
TEXT, NUMBER, SWITCH, ANYTHING = {"type": "string"}, {"type": "number"}, {"type": "boolean"}, {}
TEXTS = {"type": "array", "items": TEXT}
AXES = ("x", "y", "z", "roll", "pitch", "yaw")
KINDS = ("lidar", "camera", "radar", "ultrasonic")
FREE = {"type": "array", "items": {"enum": list(AXES)}, "uniqueItems": True}


def numbers(count: int, item: Mapping[str, Any] = NUMBER) -> dict[str, Any]:
    """Return the schema of a list of so many numbers."""
    return {"type": "array", "items": item, "minItems": count, "maxItems": count}


def table(keys: Mapping[str, Any], *required: str) -> dict[str, Any]:
    """Return the schema of a table that has these keys and no other."""
    own = {"type": "object", "properties": dict(keys), "additionalProperties": False}
    return own | ({"required": list(required)} if required else {})


def tables(keys: Mapping[str, Any], *required: str) -> dict[str, Any]:
    """Return the schema of an array of such tables."""
    return {"type": "array", "items": table(keys, *required)}


def of_rule(rule: object) -> dict[str, Any]:
    """Return the schema of a setting's values, as a file has them."""
    match rule:
        case Toggle():
            return SWITCH
        case OneOf():
            return {"enum": list(rule.among)}
        case Several():
            return {"type": "array", "items": {"enum": list(rule.among)}, "uniqueItems": True}
        case Texts():
            return TEXTS
        case Name():
            return TEXT
        case Pair():
            return numbers(2, of_rule(rule.rule))
        case Triple():
            return numbers(3, of_rule(rule.rule))
        case Number() | Whole():
            return {"type": "integer" if isinstance(rule, Whole) else "number", **_range(rule)}
        case LimitRule():
            return of_limit(rule)
    return ANYTHING  # places of a zone: numbers, or texts such as "rear + 1"


def of_limit(rule: LimitRule) -> dict[str, Any]:
    """Return the schema of a limit: a number, true, or a table of both."""
    if rule.rule is None:
        return {"const": True}
    number = of_rule(rule.rule)
    alone = [] if rule.needs_number else [{"const": True}]
    return {"anyOf": [number, *alone, table({"value": number, "kept": SWITCH}, "value")]}


def _range(rule: Number | Whole) -> dict[str, Any]:
    found = {}
    for key, end, open_key, is_open in (
        ("minimum", rule.minimum, "exclusiveMinimum", getattr(rule, "above", False)),
        ("maximum", rule.maximum, "exclusiveMaximum", getattr(rule, "below", False)),
    ):
        if end is not None and math.isfinite(end):
            found[open_key if is_open else key] = end
    return found


def of_setting(setting: Setting) -> dict[str, Any]:
    """Return the schema of a setting: what it is, its values, its default."""
    unit = " [deg]" if isinstance(setting.rule, Angle) else ""
    own = {"description": f"{setting.text}{unit}", **of_rule(setting.rule)}
    if setting.default is REQUIRED or setting.default is None:
        return own
    value = value_in_file(setting, setting.default)
    whole = json.dumps(value)
    return own if "Infinity" in whole else own | {"default": json.loads(whole)}


def study_schema() -> dict[str, Any]:
    """Return the schema of study.toml."""
    declared: dict[str, dict[str, Any]] = {}
    for key, setting in setting_keys():
        where, _, name = key.rpartition(".")
        declared.setdefault(where, {})[name] = of_setting(setting)
    pose = {"position": numbers(3), "rotation": numbers(3)}
    model = {
        "description": "A name of the catalogue (`pe sensors`), or a table: an own model",
        "anyOf": [TEXT, {"type": "object"}],
    }
    bounds = table({axis: numbers(2) for axis in AXES})
    curve = table(declared["ap.KIND"])
    by_class = {"type": "object", "additionalProperties": curve}
    curves = {kind: table({**declared["ap.KIND"], "objects": by_class}) for kind in KINDS}
    own_class = dict.fromkeys(
        (
            *("height_spread", "decay_x", "laplace_y", "gauss_y", "laplace_share"),
            *("share", "length_spread", "width_spread", "any_heading"),
        ),
        NUMBER,
    )
    prior = {
        "model": {"enum": ["road", "highway", "uniform"], "default": "road"},
        "classes": TEXTS,
        "boxes": {"description": "File of labelled boxes, in place of a model", **TEXT},
        "grid": {"description": "File of weights (.npy), in place of a model", **TEXT},
        "space": {"description": "Space of the weights", **table(declared["space"])},
        "origin": numbers(3),
        "density": {"type": "object", "additionalProperties": {"type": "number", "minimum": 0}},
        "class": tables(
            {"name": TEXT, "size": numbers(3), "lanes": {"type": "array", "items": NUMBER}}
            | own_class,
            "name",
        ),
        "focus": tables(declared["prior.focus"], "factor"),
    }
    axis = {"enum": ["+x", "-x", "+y", "-y", "+z", "-z"]}
    vehicle = {
        **{"mesh": TEXT, "glass": TEXTS, "scale": NUMBER, "rotation": numbers(3)},
        **{"up": axis, "forward": axis},
        "covers": {"type": "object", "additionalProperties": {"type": "number", "minimum": 0}},
    }
    sensor = {
        **{"name": TEXT, "model": model, **pose, "fusion": TEXT, "ap": curve, "free": FREE},
        **{"bounds": bounds, "mount": TEXT},
        "color": {"type": "string", "pattern": "^#[0-9a-f]{6}$"},
        **declared["sensor"],
    }
    mount = {"name": TEXT, "parts": TEXTS, "area": TEXT, **declared["optimize.mount"]}
    mount["slot"] = tables({"name": TEXT, **pose}, "name", "position")
    tie = tables({"sensors": TEXTS}, "sensors")
    start = {"name": TEXT, "placements": {"type": "object"}}
    optimize = {
        **{"method": {"enum": list(METHODS)}, "free": FREE, **declared["optimize"]},
        "tolerance": table(declared["optimize.tolerance"]),
        "stop": table(declared["optimize.stop"]),
        "front": table(declared["optimize.front"]),
        "mount": tables(mount, "name"),
        "no_go": tables({"name": TEXT, **declared["optimize.no_go"]}, "name"),
        **{"pair": tie, "group": tie, "start": tables(start, "name", "placements")},
    }
    requirement = {
        **{"name": TEXT, "preset": TEXT, "source": TEXT, "check": TEXT},
        **{"body": ANYTHING, "headings": ANYTHING},
        **{key: table(declared[f"requirement.{key}"]) for key in ("zone", "criterion", "under")},
    }
    choice = {"sensor": TEXT, "sensors": TEXTS, "mount": TEXT, "optional": SWITCH}
    choice["option"] = tables({"model": model, **declared["choice.option"]}, "model")
    counts = table({kind: {"type": "integer", "minimum": 0} for kind in KINDS})
    state = {"name": TEXT, **declared["state"], "body": table(declared["state.body"])}
    state["move"] = tables(declared["state.move"])
    path = {"type": "array", "items": numbers(3) | {"maxItems": 4}}
    actor = {"name": TEXT, "body": TEXT, "size": numbers(3), "class": TEXT, "path": path}
    actor |= {"watched": SWITCH, "heading_deg": NUMBER}
    story = {"name": TEXT, "preset": TEXT, "title": TEXT, "source": TEXT, **declared["story"]}
    story["body"] = tables(actor, "body", "path")
    by_name = {"type": "object", "additionalProperties": NUMBER}
    keys = {
        **declared[""],
        "space": table(declared["space"]),
        "prior": table(prior),
        "metric": table(declared["metric"]),
        "measurement": table(declared["measurement"]),
        "ap": table({**declared["ap"], **curves}),
        "fusion": table({"blind": {"enum": list(BLIND_RULES)}}),
        "vehicle": table({**vehicle, **declared["vehicle"]}),
        "reference": table(declared["reference"], "rear_axle_x", "rear_axle_z"),
        "sensor": {**tables(sensor, "name", "model", "position"), "minItems": 1},
        "requirement": tables(requirement, "name"),
        "weather": tables({"name": TEXT, **declared["weather"]}, "name"),
        "state": tables(state, "name"),
        "time": table({**declared["time"], "noises": by_name, "rates": by_name}),
        "story": tables(story),
        "limits": table(declared["limits"]),
        "optimize": table(optimize),
        "choice": tables(choice, "option"),
        "selection": table({**declared["selection"], "max_of_kind": counts}),
    }
    head = {"$schema": DRAFT, "$id": f"urn:perception-entropy:study:{STUDY_SCHEMA}"}
    title = "A study of perception entropy: study.toml as plain data; lengths in m, angles in deg"
    return {**head, "title": title, **table(keys, "sensor")}


def of_type(hint: Any) -> dict[str, Any]:
    """Return the schema of a dataclass's field as `to_dict` writes it."""
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
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
    score, pose = {"$ref": "#/$defs/score"}, {"$ref": "#/$defs/placements"}
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
        **{"before": score, "after": score},
        "placements": {**both, "properties": {"before": pose, "after": pose}},
        "mounts": some,
        "method": {"type": ["string", "null"]},
        "level_samples": {"type": "array", "items": {"type": "integer"}},
        "ap_model": TEXT,
        "returns": TEXT,
        "evaluations": {"type": "integer", "minimum": 0},
        "stopped": SWITCH,
        **{"warnings": rows, "history": history},
        "inputs": {"type": "object", "properties": inputs, "required": list(inputs)},
        "run": {"type": "object", "properties": {"seconds": NUMBER}, "required": ["seconds"]},
    }
    at_times = {
        **{"robustness": some, "requirements": rows, "conditions": some, "starts": rows},
        **{"objective": TEXT, "expected_ap": some, "figures": both, "cost": TEXT},
        **{
            "flatness": {"type": ["object", "null"]},
            "stop_reason": {"type": ["string", "null"]},
            "seed_scatter": {"type": ["number", "null"]},
        },
    }
    place = {"position": numbers(3), "rotation": numbers(3)}
    placed = {"type": "object", "properties": place, "required": list(place)}
    placements = {
        "description": "Position [m] and roll, pitch, yaw [deg] by sensor, ground frame",
        **{"type": "object", "additionalProperties": placed},
    }
    return {
        "$schema": DRAFT,
        "$id": f"urn:perception-entropy:result:{SCHEMA}",
        "title": "A result of perception entropy: result.json",
        **{"type": "object", "properties": {**always, **at_times}, "required": list(always)},
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
