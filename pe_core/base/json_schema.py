"""The JSON schema of a tree of dataclasses, by the declarations that the codec reads: of documents,
and of results (`codec.record`)."""

import json
import math
import types
import typing
from collections.abc import Mapping
from dataclasses import is_dataclass
from typing import Any

from .codec import BY_TYPE, DocumentField, Schema, classes_in, fields_of, hook_of
from .setting import (
    REQUIRED,
    Each,
    OneOf,
    Pair,
    Setting,
    Several,
    Texts,
    Toggle,
    Triple,
    value_in_file,
)
from .values import Angle, Name, Number, Whole

TYPES = {bool: "boolean", int: "integer", float: "number", str: "string"}
"""Names of plain types in a schema."""
NULL = {"type": "null"}


def schema_of(cls: type) -> Schema:
    """Return the JSON schema of the plain data of a class."""
    properties, required, is_open = _properties(cls)
    found: Schema = {"type": "object", "properties": properties}
    found |= {} if is_open else {"additionalProperties": False}
    return found | ({"required": required} if required else {})


def schema_of_record(cls: type) -> Schema:
    """Return the JSON schema of the data that `codec.record` writes of a class; other classes are
    in ``$defs``. Keys may be added in a later version."""
    known: dict[str, Schema] = {}
    return _record_table(cls, known) | {"$defs": dict(sorted(known.items()))}


def schemas_of_records(hints: Mapping[str, Any]) -> Schema:
    """Return the JSON schema of a table whose keys are names, with the data of a type each."""
    known: dict[str, Schema] = {}
    properties = {name: _record(hint, known) for name, hint in hints.items()}
    return {"type": "object", "properties": properties, "$defs": dict(sorted(known.items()))}


def _record_table(cls: Any, known: dict[str, Schema]) -> Schema:
    properties: dict[str, Schema] = {}
    required: list[str] = []
    for each in fields_of(cls):
        if each.part.inline:
            inner = _record_table(each.hint, known) if is_dataclass(each.hint) else {}
            properties |= inner.get("properties", {})
            required += inner.get("required", [])
            continue
        own = _record(each.hint, known)
        about = {"description": each.part.about} if each.part.about else {}
        if each.part.at_times:
            own = _without_null(own)
        else:
            required.append(each.key)
        properties[each.key] = {**own, **about}
    return {"type": "object", "properties": properties, "required": required}


def _without_null(schema: Schema) -> Schema:
    if "anyOf" not in schema:
        return schema
    some = [each for each in schema["anyOf"] if each != NULL]
    return some[0] if len(some) == 1 else {"anyOf": some}


def _record(hint: Any, known: dict[str, Schema]) -> Schema:
    if hint is Any:
        return {}
    if hint is type(None):
        return NULL
    if hint in BY_TYPE:
        return {"type": TYPES[hint]}
    if hasattr(hint, "_fields"):
        hints = typing.get_type_hints(hint)
        keys = {name: _record(hints[name], known) for name in hint._fields}
        return {"type": "object", "properties": keys, "required": list(keys)}
    if is_dataclass(hint):
        name = typing.cast(type, hint).__name__
        if name not in known:
            known[name] = {}  # before: it may refer to itself
            known[name] = _record_table(hint, known)
        return {"$ref": f"#/$defs/{name}"}
    origin = typing.get_origin(hint)
    inner = typing.get_args(hint)
    if origin is typing.Literal:
        return {"enum": list(inner)}
    if origin in (types.UnionType, typing.Union):
        return {"anyOf": [_record(each, known) for each in inner]}
    if issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": _record(inner[1], known)}
    if len(inner) == 1 or inner[-1] is Ellipsis:
        return {"type": "array", "items": _record(inner[0], known)}
    items = [_record(each, known) for each in inner]
    return {"type": "array", "prefixItems": items, "minItems": len(items), "maxItems": len(items)}


def schema_of_setting(setting: Setting) -> Schema:
    """Return the schema of a setting: what it is, its values, its default."""
    unit = " [deg]" if isinstance(setting.rule, Angle) else ""
    own = {"description": f"{setting.text}{unit}", **schema_of_rule(setting.rule)}
    if setting.default is REQUIRED or setting.default is None:
        return own
    default = json.dumps(value_in_file(setting.rule, setting.default))
    return own if "Infinity" in default else own | {"default": json.loads(default)}


def _properties(cls: type) -> tuple[dict[str, Schema], list[str], bool]:
    """Return the schema of each key of a class, the required keys, and whether there are others."""
    properties = dict[str, Schema]()
    required = list[str]()
    is_open = False
    for each in fields_of(cls):
        if each.part.inline and is_dataclass(each.hint):
            inner, needed, more = _properties(typing.cast(type, each.hint))
            properties |= inner
            required += needed
            is_open = is_open or more
        elif each.part.inline:
            is_open = True
        else:
            properties[each.key] = _schema_of_field(each)
            required += [each.key] if _is_required(each) else []
    return properties, required, is_open


def _is_required(each: DocumentField) -> bool:
    """Whether a table without the key is wrong: one without a table of a class is read as empty."""
    return each.default is REQUIRED and not each.is_table


def _schema_of_field(each: DocumentField) -> Schema:
    if each.setting is not None:
        return schema_of_setting(each.setting)
    if each.rule is not None:
        return schema_of_rule(each.rule)
    if each.part.changes:
        found = _schema_of_hint(each.hint)
        return found | {"items": {k: v for k, v in found["items"].items() if k != "required"}}
    if not each.part.by_name:
        return _schema_of_hint(each.hint)
    inner = [_schema_of_hint(cls) for cls, _ in classes_in(each.hint)]
    for own in inner:
        own["properties"] = {"name": {"type": "string"}, **own["properties"]}
    return {"type": "array", "items": inner[0] if len(inner) == 1 else {"anyOf": inner}}


def _schema_of_hint(hint: Any) -> Schema:
    own = hook_of(hint)
    if own is not None:
        return schema_of(own.form) if isinstance(own.form, type) else own.form
    if hint in BY_TYPE:
        return schema_of_rule(BY_TYPE[hint])
    if is_dataclass(hint):
        return schema_of(typing.cast(type, hint))
    origin = typing.get_origin(hint)
    inner = typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        some = [_schema_of_hint(each) for each in inner if each is not type(None)]
        return some[0] if len(some) == 1 else {"anyOf": some}
    if issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": _schema_of_hint(inner[1])}
    if len(inner) == 1 or inner[-1] is Ellipsis:
        return {"type": "array", "items": _schema_of_hint(inner[0])}
    return _list_of(len(inner), _schema_of_hint(inner[0]))


def schema_of_rule(rule: object) -> Schema:
    """Return the schema of the values that a rule allows, as a document has them. A rule of another
    room says its own: ``json_schema``."""
    if (own := getattr(rule, "json_schema", None)) is not None:
        found: Schema = own(schema_of_rule)
        return found
    match rule:
        case Toggle():
            return {"type": "boolean"}
        case OneOf():
            return {"enum": list(rule.among)}
        case Several():
            return {"type": "array", "items": {"enum": list(rule.among)}, "uniqueItems": True}
        case Texts():
            return {"type": "array", "items": {"type": "string"}}
        case Name():
            return {"type": "string"}
        case Pair():
            return _list_of(2, schema_of_rule(rule.rule))
        case Triple():
            return _list_of(3, schema_of_rule(rule.rule))
        case Each():
            return {"type": "array", "items": schema_of_rule(rule.rule)}
        case Number() | Whole():
            kind = "integer" if isinstance(rule, Whole) else "number"
            return {"type": kind, **_range(rule)}
    return {}  # places of a zone: numbers, or texts such as "rear + 1"


def _list_of(count: int, item: Schema) -> Schema:
    return {"type": "array", "items": item, "minItems": count, "maxItems": count}


def _range(rule: Number | Whole) -> Schema:
    ends = (
        ("minimum", rule.minimum, "exclusiveMinimum", getattr(rule, "above", False)),
        ("maximum", rule.maximum, "exclusiveMaximum", getattr(rule, "below", False)),
    )
    return {
        open_key if is_open else key: end
        for key, end, open_key, is_open in ends
        if end is not None and math.isfinite(end)
    }
