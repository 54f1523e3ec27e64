"""Rig templates: models of the catalogue on the named places of any vehicle."""

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any

from ...base.values import choice
from ...geometry.poses import Pose
from ...scene.named_places import NamedPlace
from ...scene.rig import SensorModel
from ...sensors import kind_of
from ..rigs import KnownSensor

PlacesByName = Mapping[str, NamedPlace]
Load = Callable[[str], SensorModel]
"""From a name in the catalogue to its model."""


@dataclass(frozen=True, slots=True)
class RigTemplate:
    """Sensors on named places: a rig to start from, of no product.

    `sensors`: Of each the place, the model in the catalogue, yaw and pitch [deg] from where a
        sensor of that place looks.
    """

    key: str
    title: str
    note: str
    sensors: tuple[tuple[str, str, float, float], ...]


@cache
def templates() -> Mapping[str, RigTemplate]:
    """Return the templates by key."""
    text = (resources.files(__package__) / "templates.toml").read_text("utf-8")
    tables = tomllib.loads(text).items()
    found = {k: RigTemplate(k, t["title"], t["note"], _rows(t["sensors"])) for k, t in tables}
    return MappingProxyType(found)


def _rows(table: Iterable[Mapping[str, Any]]) -> tuple[tuple[str, str, float, float], ...]:
    rows = []
    for row in table:
        yaw = float(row.get("yaw", 0.0))
        pitch = float(row.get("pitch", 0.0))
        for place in row["at"]:
            rows.append((place, row["model"], 0.0 - yaw if "right" in place else yaw, pitch))
    return tuple(rows)


def filled(template: RigTemplate, places: PlacesByName, load: Load) -> tuple[KnownSensor, ...]:
    """Return a template's sensors, named by place; each is upright and stands off as its kind does.

    A sensor that looks all around looks ahead. `InputError` when a place is not there.
    """
    found = []
    for name, model, yaw, pitch in template.sensors:
        place = places[choice(template.key, "place", name, places)]
        kind = kind_of(load(model))
        ahead = place.yaw_deg + yaw if kind.outward(load(model)) else 0.0
        pose = Pose.from_degrees(place.beside(kind.stand_off_m), (0.0, pitch, ahead))
        found.append(KnownSensor(f"{kind.label} {name}", model, pose))
    return tuple(found)


def at_nearest(
    sensors: Iterable[KnownSensor], places: PlacesByName, load: Load
) -> list[KnownSensor]:
    """Return sensors, each at the nearest place that no nearer one has, with their own angles.

    Where no place is left for a sensor, it stays where it is.
    """
    found = list(sensors)
    free = dict(places)
    waiting = set(range(len(found)))
    for _, k, name in sorted(
        (math.dist(each.pose.position, place.point), k, name)
        for k, each in enumerate(found)
        for name, place in places.items()
    ):
        if k in waiting and name in free:
            waiting.remove(k)
            position = free.pop(name).beside(kind_of(load(found[k].model)).stand_off_m)
            found[k] = replace(found[k], pose=Pose(position, found[k].pose.rpy))
    return found
