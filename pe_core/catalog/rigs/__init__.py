"""Rigs of well-known vehicles: a TOML file for each, with the source of its figures.

Files have the published positions, in the publisher's frame; with `base_frames` those of LiDARs
are of the base of the housing. This module converts them to the ground frame, and can scale a rig
to another vehicle.
"""

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any

from ...base.values import choice
from ...geometry.poses import Pose
from ..housings import scan_above_base

Sides = tuple[float, float, float]
PAPER = "paper_"
"""Prefix of the names of the paper's rigs."""


@dataclass(frozen=True, slots=True)
class KnownSensor:
    """A sensor of a known rig: its name, its model in the catalogue, and its pose."""

    name: str
    model: str
    pose: Pose


@dataclass(frozen=True, slots=True)
class KnownRig:
    """A rig as it was published, moved into the ground frame.

    `key, title`: Name of its file, and its usual name.
    `vehicle, origin, source, note`: The vehicle, the origin of the publisher's frame, the source of
        the figures, and remarks on them.
    `size` (3,): Length, width and height of that vehicle [m]; None if not known.
    `sensors`: Ground frame: the origin is under that vehicle's centre.
    """

    key: str
    title: str
    vehicle: str
    origin: str
    source: str
    note: str
    size: Sides | None
    sensors: tuple[KnownSensor, ...]

    def on_vehicle(self, low: Iterable[float], high: Iterable[float]) -> tuple[KnownSensor, ...]:
        """Return the sensors scaled to another vehicle with bounds `low` and `high`, (3,) [m]. A
        coordinate within the bounds of the rig's vehicle keeps its share of the side; one outside
        keeps its distance from the bounds. Without a known size nothing is scaled."""
        if self.size is None:
            return self.sensors
        length, width, height = self.size
        old = ((-length / 2.0, length / 2.0), (-width / 2.0, width / 2.0), (0.0, height))
        new = tuple(zip(low, high, strict=True))
        sensors = []
        for sensor in self.sensors:
            position = []
            for value, (a, b), (c, d) in zip(sensor.pose.position, old, new, strict=True):
                inside = min(max(value, a), b)
                share = (inside - a) / (b - a)
                position.append(round(c + share * (d - c) + (value - inside), 5))
            x, y, z = position
            sensors.append(replace(sensor, pose=Pose((x, y, z), sensor.pose.rpy)))
        return tuple(sensors)


@cache
def known_rigs() -> Mapping[str, KnownRig]:
    """Return all rigs by key: those of real vehicles, then the paper's, each by title."""
    files = [f for f in resources.files(__package__).iterdir() if f.name.endswith(".toml")]
    rigs = (
        _from_table(f.name.removesuffix(".toml"), tomllib.loads(f.read_text("utf-8")))
        for f in files
    )
    in_order = sorted(rigs, key=lambda rig: (rig.key.startswith(PAPER), rig.title.lower()))
    return MappingProxyType({rig.key: rig for rig in in_order})


def known_rig(key: str) -> KnownRig:
    """Return the rig of that key. `InputError` when there is no rig of that key."""
    return known_rigs()[choice("catalogue", "rig", key, known_rigs())]


def _from_table(key: str, table: Mapping[str, Any]) -> KnownRig:
    length, width, height = table.get("size", (None, None, None))
    is_base = table.get("base_frames", False)
    sensors = tuple(_sensor(row, table["center_x"], is_base) for row in table["sensor"])
    return KnownRig(
        key=key,
        title=table["title"],
        vehicle=table["vehicle"],
        origin=table["origin"],
        source=table["source"],
        note=table["note"],
        size=None if length is None else (length, width, height),
        sensors=sensors,
    )


def _sensor(row: Mapping[str, Any], center_x: float, is_base: bool) -> KnownSensor:
    """Return a sensor; a LiDAR with the pose of its base is moved to the centre of its scan."""
    x, y, z = row["position"]
    pose = Pose.from_degrees((round(x - center_x, 5), y, z), row["rotation"])
    if is_base and (height := scan_above_base(row["model"])):
        up = pose.ground_from_sensor[:, 2].tolist()
        x, y, z = (round(v + height * u, 5) for v, u in zip(pose.position, up, strict=True))
        pose = Pose((x, y, z), pose.rpy)
    return KnownSensor(row["name"], row["model"], pose)
