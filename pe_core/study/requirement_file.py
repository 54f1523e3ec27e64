"""Requirements in the study file, `[[requirement]]`, and the presets that are shipped.

A preset is a requirement of a regulation, a test or a maker, with its source. A study names it
(``preset = "r159_crossing"``) and may replace any key of it.
"""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Annotated, Any

from ..base.codec import Node, hook, read_fields, write_fields
from ..base.errors import shown
from ..base.setting import Part
from ..base.values import as_in_file, choice, degrees_in_file, listed
from ..scoring import requirements as room
from ..scoring.requirements import BODIES, Body, Requirement

CONFIDENCE = {"A": "the text of the standard or maker was read", "B": "a secondary source"}
SHAPES = ("x", "y", "polygon", "ring", "path", "spots")
TABLES = ("zone", "criterion", "robust_to")


@dataclass(frozen=True)
class RequirementTable(Requirement):
    """The keys of a requirement's table: one body needs no list; all have the headings [deg]."""

    bodies: Annotated[tuple[Body, ...] | Body, Part(key="body")] = ()  # type: ignore[assignment]
    headings: tuple[float, ...] | None = None


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
        return read_requirement(Node(table, self.node.source))

    @property
    def node(self) -> Node:
        """The plain table of the requirement, to be read."""
        return Node({"preset": self.id, **self.table}, f"preset {self.id}")


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


def read_requirement(node: Node) -> Requirement:
    """Return a requirement from its table; `InputError` with the path of the key that is wrong."""
    identifier = node.at("preset")
    if identifier.value is None:
        return _read(node)
    base = preset(identifier.value, identifier.source, identifier.path)
    changed = _read(node.with_value(_merged(base.table, node.table), node.path))
    return replace(changed, original=replace(_read(base.node), preset=base.id))


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
        below = base.get(key, {})
        above = own.get(key, {})
        if not isinstance(above, Mapping):
            continue
        if key == "zone" and any(k in SHAPES for k in above):
            below = {k: v for k, v in below.items() if k not in SHAPES}
        merged[key] = {**below, **above}
    return {k: v for k, v in merged.items() if v != {} or k in own}


def _read(node: Node) -> Requirement:
    """Return a requirement from a table with all of its keys."""
    headings = node.at("headings")
    bodies = node.at("body", [])
    table = {key: value for key, value in node.table.items() if key != "headings"}
    if isinstance(bodies.value, str | Mapping):
        table["body"] = [bodies.value]
    made = read_fields(Requirement, node.with_value(table, node.path))
    turned = [_with_headings(body, headings) for body in made.bodies]
    return replace(made, bodies=tuple(turned))


def _with_headings(body: Body, headings: Node) -> Body:
    if headings.value is None:
        return body
    items = listed(headings.value, 72)
    good = (
        items
        and len(items) <= 72
        and all(
            isinstance(v, int | float) and not isinstance(v, bool) and abs(v) <= 360.0
            for v in items
        )
    )
    if not good:
        raise headings.error("1 to 72 angles within +-360 degrees", shown(headings.value))
    return replace(body, headings=tuple(as_in_file(math.radians(v)) for v in items or ()))


def full_table(requirement: Requirement) -> dict[str, Any]:
    """Return all of a requirement as plain data, without what has its default."""
    table = {**write_fields(requirement), "headings": _headings(requirement)}
    return {key: value for key, value in table.items() if value is not None and value != {}}


def _headings(requirement: Requirement) -> list[float] | None:
    """Return the headings of the bodies in degrees, where they are not the bodies' own."""
    for body in requirement.bodies:
        own = BODIES[body.name].headings if body.name in BODIES else (0.0,)
        if body.headings != own:
            return [degrees_in_file(h) for h in body.headings]
    return None


hook(Requirement, read_requirement, requirement_table, RequirementTable)
