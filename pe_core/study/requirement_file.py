"""Requirements in the study file, `[[requirement]]`, and the presets that are shipped.

A preset is a requirement of a regulation, a test or a maker, with its source. A study names it
(``preset = "r159_crossing"``) and may replace any key of it.
"""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any

from ..base.errors import shown
from ..base.setting import changed_settings, read_declared, settings_of
from ..base.table_reader import Table
from ..base.values import A_NAME, as_in_file, choice, degrees_in_file, listed
from ..scoring import requirements as room
from ..scoring.requirements import BODIES, Body, Criterion, Requirement, Under, Zone

CONFIDENCE = {"A": "the text of the standard or maker was read", "B": "a secondary source"}
SHAPES = ("x", "y", "polygon", "ring", "path", "spots")
TABLES = ("zone", "criterion", "under")
CUSTOM = "own"
MAX_REQUIREMENTS = 200
OF_FIRST = ("of", *(key for key in settings_of(Criterion) if key != "of"))
"""The order of keys is part of a study's fingerprint."""


@dataclass(frozen=True)
class Preset:
    """A requirement that is shipped: its identifier, confidence (A or B), and its plain table."""

    id: str
    confidence: str
    table: Mapping[str, Any]

    @property
    def name(self) -> str:
        """What it asks, in a few words."""
        return str(self.table["name"])

    @property
    def check(self) -> str:
        """The standard, test or maker."""
        return str(self.table["check"])

    @property
    def source(self) -> str:
        """Where its figures are from."""
        return str(self.table["source"])

    def requirement(self, name: str | None = None, **zone: Any) -> Requirement:
        """Return the requirement, perhaps under another name, with some keys of its zone replaced.
        `InputError` when a key is wrong."""
        table = {"preset": self.id, "name": name or self.id, **({"zone": zone} if zone else {})}
        return read_requirement(Table(table, f"preset {self.id}"))


@cache
def presets() -> Mapping[str, Preset]:
    """Return the presets that are shipped, by identifier."""
    text = resources.files(room.__package__ or room.__name__).joinpath("presets.toml")
    rows = tomllib.loads(text.read_text("utf-8"))["preset"]
    made = {}
    for row in rows:
        own = {k: v for k, v in row.items() if k not in ("id", "confidence")}
        made[row["id"]] = Preset(row["id"], row["confidence"], MappingProxyType(own))
    return MappingProxyType(made)


def preset(identifier: str, source: str = "presets", field: str = "preset") -> Preset:
    """Return a preset; `InputError` where there is none."""
    return presets()[choice(source, field, identifier, presets())]


def read_requirements(table: Table) -> tuple[Requirement, ...]:
    """Return the requirements of a study's table. `InputError` with one line that says what is
    wrong."""
    tables = table.tables("requirement")
    if len(tables) > MAX_REQUIREMENTS:
        expected = f"at most {MAX_REQUIREMENTS} requirements"
        raise table.error("requirement", expected, len(tables))
    found = [read_requirement(each) for each in tables]
    names = [each.name for each in found]
    for number, name in enumerate(names):
        if name in names[:number]:
            field = f"requirement[{number}].name"
            raise table.error(field, "each name once", f"{name!r} twice")
    return tuple(found)


def read_requirement(table: Table) -> Requirement:
    """Return one requirement from its table; `InputError` as `read_requirements`."""
    identifier = table.text("preset", None, rule=A_NAME)
    if identifier is None:
        return _read(table, None)
    base = preset(identifier, table.source, table.field("preset"))
    merged = Table(_merged(base.table, table.data), table.source, table.path)
    merged.raw("preset")
    return replace(
        _read(merged, identifier),
        original=_read(Table(_merged(base.table, {}), f"preset {base.id}"), base.id),
    )


def requirement_table(requirement: Requirement) -> dict[str, Any]:
    """Return the table that `read_requirement` reads: of a preset, what differs from it."""
    full = full_table(requirement)
    if requirement.preset is None:
        return full
    base = full_table(preset(requirement.preset).requirement())
    kept: dict[str, Any] = {"name": requirement.name, "preset": requirement.preset}
    for key, value in full.items():
        if key in kept or value == base.get(key):
            continue
        if key in TABLES:
            own = base.get(key, {})
            changed = {k: v for k, v in value.items() if v != own.get(k)}
            is_other_shape = key == "zone" and any(k in SHAPES for k in changed)
            kept[key] = value if is_other_shape else changed
        else:
            kept[key] = value
    return kept


def _merged(base: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """Return a preset's table with the keys of a study's: a zone of another shape replaces its."""
    merged = {**base, **own}
    for key in TABLES:
        below, above = base.get(key, {}), own.get(key, {})
        if not isinstance(above, Mapping):
            continue
        if key == "zone" and any(k in SHAPES for k in above):
            below = {k: v for k, v in below.items() if k not in SHAPES}
        merged[key] = {**below, **above}
    return {k: v for k, v in merged.items() if v != {} or k in own}


def _read(table: Table, identifier: str | None) -> Requirement:
    table.raw("preset", None)
    name = table.text("name", rule=A_NAME)
    zone = read_declared(table.table("zone"), Zone)
    criterion = read_declared(table.table("criterion"), Criterion)
    under = read_declared(table.table("under"), Under)
    headings = table.raw("headings", None)
    bodies = tuple(_with_headings(b, headings, table) for b in _read_bodies(table))
    source, check = table.text("source", ""), table.text("check", "")
    table.finish()
    with table.naming():
        return Requirement(name, zone, bodies, criterion, under, identifier, source, check)


def _read_bodies(table: Table) -> list[Body]:
    value = table.raw("body", ())
    items = [value] if isinstance(value, str | Mapping) else listed(value)
    if items is None:
        raise table.error("body", "a name, a table, or a list of them", shown(value))
    return [_read_body(each, table) for each in items]


def _read_body(value: Any, table: Table) -> Body:
    if isinstance(value, str):
        return BODIES[choice(table.source, table.field("body"), value, BODIES)]
    own = Table(value, table.source, table.field("body"))
    name = own.text("name", CUSTOM, rule=A_NAME)
    if own.names == ["name"]:
        return _read_body(name, table)
    is_round = "diameter" in own
    if is_round:
        diameter = own.number("diameter")
        size: tuple[float, ...] = (diameter, diameter, own.number("height"))
    else:
        size = own.numbers("size", 3)
    low, class_name = own.number("low", 0.0), own.text("class", None, rule=A_NAME)
    own.finish()
    with own.naming():
        return Body(name, (size[0], size[1], size[2]), low, is_round, class_name=class_name)


def _with_headings(body: Body, headings: Any, table: Table) -> Body:
    if headings is None:
        return body
    items = listed(headings, 72)
    good = (
        items
        and len(items) <= 72
        and all(
            isinstance(v, int | float) and not isinstance(v, bool) and abs(v) <= 360.0
            for v in items
        )
    )
    if not good:
        raise table.error("headings", "1 to 72 angles within +-360 degrees", shown(headings))
    return replace(body, headings=tuple(as_in_file(math.radians(v)) for v in items or ()))


def full_table(requirement: Requirement) -> dict[str, Any]:
    """Return all of a requirement as plain data, without what has its default."""
    table: dict[str, Any] = {
        "name": requirement.name,
        "preset": requirement.preset,
        "check": requirement.check or None,
        "source": requirement.source or None,
        "body": _bodies_value(requirement.bodies) or None,
        "headings": _headings(requirement),
        "zone": changed_settings(requirement.zone),
        "criterion": changed_settings(requirement.criterion, OF_FIRST),
        "under": changed_settings(requirement.under),
    }
    return {k: v for k, v in table.items() if v is not None and v != {}}


def _bodies_value(bodies: Sequence[Body]) -> list[Any]:
    """Return bodies by name; as tables where one of them is none of `BODIES`."""
    values = [_body_table(body) for body in bodies]
    return [v["name"] for v in values] if all(len(v) == 1 for v in values) else values


def _body_table(body: Body) -> dict[str, Any]:
    known = BODIES.get(body.name)
    if known is not None and replace(body, headings=known.headings) == known:
        return {"name": body.name}
    sizes: dict[str, Any] = {"size": list(body.size)}
    if body.is_round:
        sizes = {"diameter": body.size[0], "height": body.size[2]}
    more = {"low": body.low or None, "class": body.class_name}
    return {"name": body.name, **sizes} | {k: v for k, v in more.items() if v is not None}


def _headings(requirement: Requirement) -> list[float] | None:
    """Return the headings of the bodies in degrees, where they are not the bodies' own."""
    for body in requirement.bodies:
        own = BODIES[body.name].headings if body.name in BODIES else (0.0,)
        if body.headings != own:
            return [degrees_in_file(h) for h in body.headings]
    return None
