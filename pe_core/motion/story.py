"""Stories: what moves round the vehicle, and how the vehicle has to stop for it.

At time 0 the vehicle, driving on at its speed, is where the story says: `anchor` is its foremost
(or rearmost) plane then. Positions are metres beyond that plane, and to the left of the centre
line, on the ground that does not move; of the anchor `ORIGIN` in the vehicle's ground frame.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.errors import InputError, one_of, shown
from ..base.files import decode_text, read_bytes
from ..base.setting import FLAG, OneOf, Panel, check_settings, read_settings, setting
from ..base.table_reader import Table, load_toml
from ..base.values import A_NAME, Number, listed, vector
from ..scene.vehicle import Vehicle
from ..scoring.requirements.bodies import BODIES, Body
from ..scoring.targets.scene_layout import CAR_SIZE_M

FRONT, REAR, ORIGIN = "front", "rear", "origin"
KMH = 3.6
SECOND = Number(-600.0, 600.0, unit="s", noun="time")
METRE = Number(-1000.0, 1000.0, unit="m", noun="position")
FILE = Path(__file__).with_name("stories.toml")
MAX_FRAMES = 6000


@dataclass(frozen=True, slots=True)
class Actor:
    """A body of a story, and its path: (time [s], x [m], y [m]), straight between them.

    Where all have a fourth number, it is the heading [deg]; else it heads where it moves. Before
    the first and after the last it stands. `watched`: whether it has to be confirmed; else it only
    occludes.
    """

    name: str
    body: Body
    path: tuple[tuple[float, ...], ...]
    watched: bool = True
    heading: float = 0.0
    """While it stands [rad]."""

    def __post_init__(self) -> None:
        who = f"body {A_NAME.checked('story', 'name', self.name)!r}"
        given = listed(self.path) or []
        size = 4 if given and len(listed(given[0]) or ()) == 4 else 3
        rows = [vector(who, "path", row, size, METRE) for row in given]
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
        t, x, y, *turn = np.array(self.path).T
        where = np.column_stack([np.interp(times, t, x), np.interp(times, t, y)])
        if turn:
            return where, np.interp(times, t, np.unwrap(np.radians(turn[0])))
        leg = np.clip(np.searchsorted(t, times, side="right") - 1, 0, max(len(t) - 2, 0))
        headings = np.full(len(times), self.heading)
        if len(t) > 1:
            moving = (np.diff(x) != 0.0) | (np.diff(y) != 0.0)
            along = np.where(moving, np.arctan2(np.diff(y), np.diff(x)), self.heading)
            headings = along[leg]
        return where, headings


@dataclass(frozen=True, slots=True)
class Story:
    """A scene in time: the vehicle's own speed, how it stops, and what moves. `InputError` when a
    number is out of its range, or there is no body to watch."""

    name: str
    title: str = ""
    source: str = ""
    preset: str = ""
    speed_kmh: float = setting(
        30.0,
        Number(0.0, 250.0, unit="km/h"),
        "Own speed [km/h]",
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
    chance: float = setting(0.9, Number(0.5, 0.999), "Probability of a confirmed track")
    rate_hz: float = setting(10.0, Number(1.0, 100.0, unit="Hz"), "Frames in a second")
    start_s: float = setting(-6.0, Number(-600.0, 0.0, unit="s"), "Time of the first frame")
    end_s: float = setting(0.0, Number(-600.0, 600.0, unit="s"), "Time of the last frame")
    anchor: str = setting(FRONT, OneOf((FRONT, REAR, ORIGIN)), "What positions are from")
    actors: tuple[Actor, ...] = field(default=())

    def __post_init__(self) -> None:
        who = f"story {A_NAME.checked('story', 'name', self.name)!r}"
        check_settings(self, who)
        if not any(actor.watched for actor in self.actors):
            raise InputError(who, "body", "at least one that is watched", "none")
        frames = (self.end_s - self.start_s) * self.rate_hz
        if not 1.0 <= frames <= MAX_FRAMES:
            expected = f"1 to {MAX_FRAMES} frames from start_s to end_s"
            raise InputError(who, "end_s", expected, f"{frames:g}")

    @property
    def times(self) -> Floats:
        """Times (K,) of the frames [s]."""
        count = int((self.end_s - self.start_s) * self.rate_hz + 1e-6) + 1
        return np.round(self.start_s + np.arange(count) / self.rate_hz, 9)

    @property
    def speed(self) -> float:
        """Own speed [m/s]; backwards it is negative."""
        return (-self.speed_kmh if self.anchor == REAR else self.speed_kmh) / KMH

    @property
    def brake_s(self) -> float:
        """The last moment at which a track has to be confirmed to stop before the anchor [s]."""
        return -(self.latency_s + abs(self.speed) / (2.0 * self.deceleration))

    @property
    def stop_m(self) -> float:
        """The stopping distance after a confirmed track, ``v latency + v^2 / (2 a)`` [m]."""
        return abs(self.speed * self.brake_s)

    def positions(self, vehicle: Vehicle | None) -> tuple[Floats, Floats]:
        """Return positions (A, K, 2) and headings (A, K) of the actors in the ground frame."""
        low, high = outline(vehicle)
        planes = {FRONT: (1.0, high[0]), REAR: (-1.0, low[0]), ORIGIN: (1.0, 0.0)}
        sign, plane = planes[self.anchor]
        moved = (0.0 if self.anchor == ORIGIN else self.speed) * self.times
        where, headings = [], []
        for actor in self.actors:
            at, heading = actor.at(self.times)
            x = plane + sign * at[:, 0] - moved
            where.append(np.column_stack([x, at[:, 1]]))
            headings.append(heading if sign > 0.0 else math.pi - heading)
        return np.array(where), np.array(headings)

    @property
    def speeds(self) -> Floats:
        """Speeds (A, K) of the actors over the ground [m/s]."""
        own = np.array((self.speed if self.anchor == ORIGIN else 0.0, 0.0))
        step = 1.0 / self.rate_hz
        steps = [own + np.gradient(a.at(self.times)[0], step, axis=0) for a in self.actors]
        return np.asarray(np.hypot(*np.moveaxis(np.array(steps), -1, 0)))


def outline(vehicle: Vehicle | None) -> tuple[Floats, Floats]:
    """Return the lowest and highest corner (2,) of the vehicle as drawn, from above; of a car
    without a vehicle."""
    if vehicle is None:
        half = np.array(CAR_SIZE_M) / 2.0
        return -half, half
    low, high = vehicle.as_drawn.bounds
    return low[:2], high[:2]


def read_story(table: Table, name: str) -> Story:
    """Return a story from its table; a `preset` is changed by the other keys."""
    preset = table.text("preset", "")
    base = None
    if preset:
        if preset not in stories():
            raise table.error("preset", one_of(stories(), preset), shown(preset))
        base = stories()[preset]
    values = read_settings(table, Story, default=base)
    texts: dict[str, Any] = {
        key: table.text(key, getattr(base, key, "")) for key in ("title", "source")
    }
    if table.text("name", name) != name:
        raise table.error("name", f"{name!r}, as the table", table.text("name"))
    actors = tuple(_read_actor(row) for row in table.tables("body"))
    table.finish()
    with table.naming():
        return Story(
            name, **texts, preset=preset, **values, actors=actors or (base.actors if base else ())
        )


def _read_actor(table: Table) -> Actor:
    kind = table.text("body")
    shape = BODIES.get(kind)
    if shape is None:
        size: Any = table.numbers("size", 3)
        shape = Body(kind, size, class_name=table.text("class", "") or None)
    watched = FLAG.checked(table.source, table.field("watched"), table.raw("watched", True))
    name, heading = table.text("name", kind), math.radians(table.number("heading_deg", 0.0))
    path = listed(table.raw("path")) or []
    table.finish()
    with table.naming():
        return Actor(name, shape, tuple(path), watched, heading)


@cache
def stories() -> Mapping[str, Story]:
    """Return the stories that are shipped, by name."""
    table = Table(load_toml(FILE, "stories", decode_text(read_bytes(FILE))), FILE.name)
    read = {name: read_story(table.table(name), name) for name in table.names}
    return {name: replace(story, preset=name) for name, story in read.items()}
