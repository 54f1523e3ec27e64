"""Rigs of well-known vehicles, a TOML file each, with the source of their figures.

Files hold positions as they were published, in the frame of whoever published them; with
`base_frames` those of LiDARs are where their housings stand. Here they are put into the ground
frame, and stretched onto another vehicle where that is asked for.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any

from ...errors import InputError, shown
from ...scene.geometry import Pose
from ..scan_offsets import scan_above_base

Sides = tuple[float, float, float]
PAPER = "paper_"
"""What the names of the paper's rigs begin with."""


@dataclass(frozen=True, slots=True)
class KnownSensor:
    """A sensor of a known rig: its name there, its model in the catalogue, and where it is."""

    name: str
    model: str
    pose: Pose


@dataclass(frozen=True, slots=True)
class KnownRig:
    """A rig as it was published, moved into the ground frame.

    Attributes
    ----------
    key, title : str
        Its file's name, and what people call it.
    vehicle, origin, source, note : str
        The vehicle it is on, where its publisher's origin is, where the figures come from, and what
        has to be known of them.
    size : (3,) float or None
        Length, width and height of that vehicle [m], where they are known.
    sensors : tuple of KnownSensor
        Ground frame: the origin is under that vehicle's centre.
    """

    key: str
    title: str
    vehicle: str
    origin: str
    source: str
    note: str
    size: Sides | None
    sensors: tuple[KnownSensor, ...]

    def on_vehicle(self, low: Sequence[float], high: Sequence[float]) -> tuple[KnownSensor, ...]:
        """Return the sensors stretched onto another vehicle, which reaches from `low` to `high`.

        What lies within the box of the rig's own vehicle keeps its share of the box; what stands
        out of it stands out as far. Without a known size nothing is stretched.
        """
        if self.size is None:
            return self.sensors
        length, width, height = self.size
        own = ((-length / 2.0, length / 2.0), (-width / 2.0, width / 2.0), (0.0, height))
        other = tuple(zip(low, high, strict=True))
        return tuple(replace(each, pose=_stretched(each.pose, own, other)) for each in self.sensors)


def known_rigs() -> Mapping[str, KnownRig]:
    """All rigs by their keys."""
    return _shipped()


def known_rig(key: str) -> KnownRig:
    """Return the rig of that key.

    Raises
    ------
    InputError
        When there is none.
    """
    if key not in _shipped():
        raise InputError("catalogue", "rig", f"one of {', '.join(_shipped())}", shown(key))
    return _shipped()[key]


@cache
def _shipped() -> Mapping[str, KnownRig]:
    files = [f for f in resources.files(__package__).iterdir() if f.name.endswith(".toml")]
    rigs = (
        _from_table(f.name.removesuffix(".toml"), tomllib.loads(f.read_text("utf-8")))
        for f in files
    )
    return MappingProxyType({rig.key: rig for rig in sorted(rigs, key=_order)})


def _order(rig: KnownRig) -> tuple[bool, str]:
    """Rigs of vehicles that drive come first, then the paper's; by their titles."""
    return rig.key.startswith(PAPER), rig.title.lower()


def _from_table(key: str, table: Mapping[str, Any]) -> KnownRig:
    length, width, height = table.get("size", (None, None, None))
    lifted = table.get("base_frames", False)
    sensors = tuple(_sensor(row, table["center_x"], lifted) for row in table["sensor"])
    return KnownRig(
        key,
        table["title"],
        table["vehicle"],
        table["origin"],
        table["source"],
        table["note"],
        None if length is None else (length, width, height),
        sensors,
    )


def _sensor(row: Mapping[str, Any], center_x: float, is_base: bool) -> KnownSensor:
    """Return a sensor; a LiDAR whose base is published is put where the centre of its scan is."""
    x, y, z = row["position"]
    pose = Pose.from_degrees((round(x - center_x, 5), y, z), row["rotation"])
    if is_base and (height := scan_above_base(row["model"])):
        up = pose.ground_from_sensor[:, 2].tolist()
        x, y, z = (round(v + height * u, 5) for v, u in zip(pose.position, up, strict=True))
        pose = Pose((x, y, z), pose.rpy)
    return KnownSensor(row["name"], row["model"], pose)


def _stretched(
    pose: Pose, own: Sequence[tuple[float, float]], other: Sequence[tuple[float, float]]
) -> Pose:
    """Return a pose carried from one box to another."""
    ends = zip(pose.position, own, other, strict=True)
    x, y, z = (round(_carried(v, of, to), 5) for v, of, to in ends)
    return Pose((x, y, z), pose.rpy)


def _carried(value: float, of: tuple[float, float], to: tuple[float, float]) -> float:
    inside = min(max(value, of[0]), of[1])
    share = (inside - of[0]) / (of[1] - of[0])
    return to[0] + share * (to[1] - to[0]) + (value - inside)
