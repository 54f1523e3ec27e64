"""Requirements in the study file, `[[requirement]]`, and the presets that are shipped.

A preset is a requirement of a regulation, a test or a maker, with its source. A study names it
(``preset = "r159_crossing"``) and may replace any key of it.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any

from ..base.codec import Node, read_changed, read_fields, write_changed
from ..base.values import choice
from ..scoring import requirements as room
from ..scoring.requirements import Requirement

CONFIDENCE = {"A": "the text of the standard or maker was read", "B": "a secondary source"}


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
        return read_requirement(Node(table, f"preset {self.id}"))


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


@cache
def _shipped() -> Mapping[str, Requirement]:
    """Return the requirements of all presets, which have their names."""
    tables = {key: {**row.table, "preset": key, "name": key} for key, row in presets().items()}
    return {key: read_fields(Requirement, Node(tables[key], f"preset {key}")) for key in tables}


def read_requirement(node: Node) -> Requirement:
    """Return a requirement from its table; `InputError` with the path of the key that is wrong."""
    own = read_changed(Requirement, node, _shipped())
    return replace(own, original=_shipped().get(own.preset or ""))


def write_requirement(requirement: Requirement) -> Any:
    """Return the table of a requirement: of a preset, the keys that are other than its own."""
    return write_changed(requirement, _shipped())
