"""Results that a scene keeps for the panel: plain values, each group of them as one JSON text.

A property group has the text as its one property, and the values as attributes (`stored_fields`).
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, fields, replace
from functools import lru_cache
from typing import Any, NamedTuple

import bpy
from bpy.types import Object, PropertyGroup, Scene

from ..engine import wording


class ResultPart(NamedTuple):
    """A zone of the ground or a class of objects: its label, entropy [nats], visible share.

    Of a class, if objects were scored: its expected AP, and the distance ahead up to which it is
    found with an AP of 0.5.
    """

    name: str
    is_class: bool
    entropy: float
    coverage: float
    ap: str = ""
    reach: str = ""


class SensorFigures(NamedTuple):
    """A sensor in the last result.

    `entropy` [nats] and `coverage` (0 to 1) are of the sensor alone; `occluded` of its `beams` (or
    positions of a camera's picture) end on the vehicle, at `parts` by share. `loss` [nats] is how
    much the rig's entropy rises without it, and `where` the zone of the largest rise.
    """

    entropy: float
    coverage: float
    beams: int
    occluded: int
    parts: tuple[tuple[str, float], ...] = ()
    loss: str = ""
    where: str = ""


class StoredWarning(NamedTuple):
    """A warning (`pe_tools.advice.Advice`); an empty subject stands for the vehicle."""

    subject: str
    code: str
    values: dict[str, Any]
    part: str
    fix: str
    amount: tuple[float, float, float]

    @property
    def text(self) -> str:
        """The warning in a sentence, without the name of its subject."""
        return wording.warning_text(self.code, self.part, self.values)


class FrontRow(NamedTuple):
    """A design of a Pareto front: its name, its variant's key, and its figures."""

    name: str
    key: int
    figures: str


def _rows(row: type) -> Any:
    return field(default=(), metadata={"row": row})


@dataclass(frozen=True, slots=True)
class StoredResult:
    """Figures of the last result. Pairs are of the start of a search and of its result.

    Entropies are in nats, shares from 0 to 1. `result_figures` has the key figures (`KeyFigures`,
    as plain data) "before" and "after". Texts of several lines have one for each sentence.
    """

    result_kind: str = ""
    result_entropy: float = 0.0
    result_before: float = 0.0
    result_coverage: float = 0.0
    result_coverage_before: float = 0.0
    result_stderr: float = 0.0
    result_figures: dict[str, dict[str, Any]] = field(default_factory=dict)
    result_gain: str = ""
    result_cost: str = ""
    result_conditions: str = ""
    result_words: str = ""
    result_missing: str = ""
    result_ap: str = ""
    result_mounted_off: str = ""
    result_sensor_lost: str = ""
    result_sureness: str = ""
    result_fragile: str = ""
    result_parts: tuple[ResultPart, ...] = _rows(ResultPart)
    result_sensors: dict[str, SensorFigures] = field(
        default_factory=dict, metadata={"row": SensorFigures}
    )


@dataclass(frozen=True, slots=True)
class StoredChecks:
    """What the checks of a scene found: warnings, and the vehicle in a line."""

    result_warnings: tuple[StoredWarning, ...] = _rows(StoredWarning)
    vehicle_line: str = ""


@dataclass(frozen=True, slots=True)
class StoredFront:
    """The last Pareto front, cheapest first; how it was found, and what limits a comparison."""

    front: tuple[FrontRow, ...] = _rows(FrontRow)
    front_told: str = ""
    front_note: str = ""


def stored_fields(cls: Any, text: str) -> Any:
    """Return a mixin of a property group: the fields of a dataclass, stored as JSON in a text."""

    def attribute(name: str) -> property:
        def read(group: PropertyGroup) -> Any:
            return getattr(_loaded(cls, getattr(group, text)), name)

        def write(group: PropertyGroup, value: Any) -> None:
            store(group, text, replace(_loaded(cls, getattr(group, text)), **{name: value}))

        return property(read, write)

    content = {each.name: attribute(each.name) for each in fields(cls)}
    return type(cls.__name__, (), {"__doc__": cls.__doc__, "__module__": __name__, **content})


def store(group: PropertyGroup, text: str, values: Any) -> None:
    """Store a dataclass in a text property."""
    setattr(group, text, json.dumps(asdict(values)))


@lru_cache(maxsize=64)
def _loaded(cls: Any, text: str) -> Any:
    data = json.loads(text) if text else {}
    known = [each for each in fields(cls) if each.name in data]
    return cls(**{each.name: _value(data[each.name], each.metadata.get("row")) for each in known})


def _value(value: Any, row: Any) -> Any:
    if row is None:
        return tuple(value) if isinstance(value, list) else value
    if isinstance(value, dict):
        return {name: row(*own) for name, own in value.items()}
    return tuple(row(*own) for own in value)


def figures_of_sensor(obj: Object) -> SensorFigures | None:
    """Return an object's figures in the last result of its scene; None where it has none."""
    here = bpy.context.scene
    scene = here if here in obj.users_scene else next(iter(obj.users_scene), None)
    if scene is None or not scene.perception_entropy.has_result:
        return None
    found: SensorFigures | None = scene.perception_entropy.result_sensors.get(obj.name)
    return found


def rename_figures(scene: Scene, before: str, name: str) -> None:
    """Keep a sensor's figures in the last result under its new name."""
    settings = scene.perception_entropy
    if before in settings.result_sensors:
        figures = dict(settings.result_sensors)
        figures[name] = figures.pop(before)
        settings.result_sensors = figures
