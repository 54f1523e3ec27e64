"""Scenarios: what moves round the vehicle, and how the vehicle has to stop for it.

At time 0 the vehicle, driving on at its speed, is where the scenario says: positions are metres
beyond its foremost plane then (reversing: its rearmost one), and to the left of the centre line, on
the ground that does not move. A scenario begins with the first path, and ends at time 0.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Annotated

import numpy as np

from ..base.arrays import Floats
from ..base.codec import Node, hook, read_changed, read_fields, write_changed
from ..base.errors import InputError, require_kind, shown
from ..base.files import decode_text, read_bytes
from ..base.setting import Named, Panel, Part, check_settings, setting
from ..base.table_reader import load_toml
from ..base.values import A_NAME, Angle, Number, listed, vector
from ..metric.frames import RATE_HZ
from ..scene.vehicle import Vehicle
from ..scoring.requirements.bodies import Body
from ..scoring.targets.scene_layout import CAR_SIZE_M

KMH = 3.6
SECOND = Number(-600.0, 600.0, unit="s", noun="time")
METRE = Number(-1000.0, 1000.0, unit="m", noun="position")
FILE = Path(__file__).with_name("scenarios.toml")
HEADING = Angle(-3600.0, 3600.0)
CHANCE = 0.9
"""Probability from which a track counts as confirmed; 0.99 is told beside it."""
START_S = -6.0  # Time of the first frame where nothing moves


@dataclass(frozen=True, slots=True)
class Actor:
    """A body of a scenario, and its path: (time [s], x [m], y [m]), straight between them.

    It heads where it moves. Before the first and after the last it stands. `watched`: whether it
    has to be confirmed; else it only occludes.
    """

    name: Named
    body: Body
    path: tuple[tuple[float, ...], ...]
    watched: bool = True
    heading: Annotated[float, Part(key="heading_deg", rule=HEADING)] = 0.0
    """While it stands [rad]."""

    def __post_init__(self) -> None:
        who = f"body {A_NAME.checked('scenario', 'name', self.name)!r}"
        rows = [vector(who, "path", row, count=3, rule=METRE) for row in listed(self.path) or []]
        times = [SECOND.checked(who, "path", row[0]) for row in rows]
        if not rows or times != sorted(set(times)):
            raise InputError(who, "path", "[s, m, m] at times that increase", shown(self.path))
        object.__setattr__(self, "path", tuple(rows))
        if self.watched and self.body.class_name is None:
            raise InputError(who, "body", "one of a class of objects", self.body.name)

    @property
    def box(self) -> tuple[float, float, float]:
        """Length, width and height [m] as it counts: what has to be seen is small, what only
        occludes is large."""
        return self.body.box if self.watched else self.body.hiding

    def at(self, times: Floats) -> tuple[Floats, Floats]:
        """Return positions (K, 2) [m] and headings (K,) [rad] at some times."""
        t, x, y = np.array(self.path).T
        where = np.column_stack([np.interp(times, t, x), np.interp(times, t, y)])
        leg = np.clip(np.searchsorted(t, times, side="right") - 1, 0, max(len(t) - 2, 0))
        headings = np.full(len(times), self.heading)
        if len(t) > 1:
            moving = (np.diff(x) != 0.0) | (np.diff(y) != 0.0)
            along = np.where(moving, np.arctan2(np.diff(y), np.diff(x)), self.heading)
            headings = along[leg]
        return where, headings


@dataclass(frozen=True, slots=True)
class Scenario:
    """A scene in time: the vehicle's own speed, how it stops, and what moves. `InputError` when a
    number is out of its range, or there is no body to watch."""

    name: Named
    title: str = ""
    source: str = ""
    preset: str = ""
    speed_kmh: float = setting(
        30.0,
        Number(-250.0, 250.0, unit="km/h"),
        "Own speed [km/h]; negative: it reverses, and positions are from its rear",
        Panel("speed_kmh", "Own Speed (km/h)"),
    )
    deceleration: float = setting(
        6.0,
        Number(0.1, 15.0, unit="m/s^2"),
        "Deceleration of a full braking [m/s^2]",
        Panel("deceleration", "Braking (m/s²)"),
    )
    latency_s: float = setting(
        0.5,
        Number(0.0, 10.0, unit="s"),
        "Time from a confirmed track to the brakes [s]",
        Panel("latency_s", "Latency (s)"),
    )
    before_s: float = setting(
        0.0,
        Number(0.0, 60.0, unit="s"),
        "How long before the last moment it has to be confirmed [s]",
        Panel("before_s", "Earlier By (s)"),
    )
    actors: Annotated[tuple[Actor, ...], Part(key="body")] = ()

    def __post_init__(self) -> None:
        who = f"scenario {A_NAME.checked('scenario', 'name', self.name)!r}"
        check_settings(self, who)
        if not any(actor.watched for actor in self.actors):
            raise InputError(who, "body", "at least one that is watched", "none")

    @property
    def start_s(self) -> float:
        """Time of the first frame [s]: the first of a path, at least one frame before 0."""
        first = min(actor.path[0][0] for actor in self.actors)
        return min(first, -1.0 / RATE_HZ) if first < 0.0 else START_S

    @property
    def times(self) -> Floats:
        """Times (K,) of the frames [s]; the last one is at 0."""
        return self.times_at(RATE_HZ)

    def times_at(self, rate_hz: float) -> Floats:
        """Return times (K,) from the first frame to 0, so many in a second [s]."""
        count = int(-self.start_s * rate_hz + 1e-6) + 1
        return np.round(self.start_s + np.arange(count) / rate_hz, 9)

    @property
    def speed(self) -> float:
        """Own speed [m/s]; backwards it is negative."""
        return self.speed_kmh / KMH

    @property
    def brake_s(self) -> float:
        """The last moment at which a track has to be confirmed to stop before the anchor [s]."""
        return -(self.latency_s + abs(self.speed) / (2.0 * self.deceleration))

    @property
    def stop_m(self) -> float:
        """The stopping distance after a confirmed track, ``v latency + v^2 / (2 a)`` [m]."""
        return abs(self.speed * self.brake_s)

    def positions(
        self, vehicle: Vehicle | None, times: Floats | None = None
    ) -> tuple[Floats, Floats]:
        """Return positions (A, K, 2) [m] and headings (A, K) [rad] of the actors in the ground
        frame, at the times (K,) of the frames or at others [s]."""
        low, high = outline(vehicle)
        sign, plane = (-1.0, low[0]) if self.speed < 0.0 else (1.0, high[0])
        times = self.times if times is None else times
        where = []
        headings = []
        for actor in self.actors:
            at, heading = actor.at(times)
            x = plane + sign * at[:, 0] - self.speed * times
            where.append(np.column_stack([x, at[:, 1]]))
            headings.append(heading if sign > 0.0 else math.pi - heading)
        return np.array(where), np.array(headings)


def checked_scenarios(scenarios: Sequence[Scenario]) -> tuple[Scenario, ...]:
    """Return scenarios; raise `InputError` for two of one name, or what is none."""
    names: set[str] = set()
    for each in scenarios:
        require_kind("study", "scenarios", each, Scenario)
        if each.name in names:
            raise InputError("study", "scenario", "each name once", f"{each.name!r} twice")
        names.add(each.name)
    return tuple(scenarios)


def outline(vehicle: Vehicle | None) -> tuple[Floats, Floats]:
    """Return the lowest and highest corner (2,) of the vehicle as drawn, from above; of a car
    without a vehicle."""
    if vehicle is None:
        half = np.array(CAR_SIZE_M) / 2.0
        return -half, half
    low, high = vehicle.as_drawn.bounds
    return low[:2], high[:2]


@cache
def scenarios() -> Mapping[str, Scenario]:
    """Return the scenarios that are shipped, by name."""
    tables = load_toml(FILE, "scenarios", decode_text(read_bytes(FILE)))
    found = {}
    for name, table in tables.items():
        node = Node({"name": name, **table}, FILE.name, name)
        found[name] = replace(read_fields(Scenario, node), preset=name)
    return found


hook(
    Scenario,
    lambda node: read_changed(Scenario, node, scenarios()),
    lambda scenario: write_changed(scenario, scenarios()),
    Scenario,
)
