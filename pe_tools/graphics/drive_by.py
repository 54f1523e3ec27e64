"""A drive-by in pictures: bodies and their lines to sensors frame by frame, and AP as a strip. A
`MovingShape` is what the 3D view shows; a film and the review page take the strip's cells and marks
from here as well."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from pe_core.base import dump_json
from pe_core.base.arrays import Floats
from pe_core.motion import CHANCE, RATE_HZ, Actor, DriveBy, Scenario, SeenBody
from pe_core.scene import Rig, Vehicle

from .colors import CIVIDIS, Rgba, on_scale, with_alpha
from .primitives import ColorKey, LayerShape, Primitives, Tag, polyline

NEVER: Rgba = (0.843, 0.863, 0.882, 1.0)  # Colour of AP 0
DARK: Rgba = (0.17, 0.175, 0.185, 1.0)  # The same on a dark ground
UNSEEN: Rgba = (0.72, 0.73, 0.75, 1.0)  # Colour of bodies that are not seen, or only hide
CONFIRMED: Rgba = (0.35, 0.85, 0.55, 1.0)
BRAKE: Rgba = (1.0, 0.50, 0.25, 1.0)
WHOLE_RIG = "whole rig"
TRACK = "track confirmed"
SWATCHES = 12
MAX_RATE_HZ = 100.0
MAX_TIMES = 6000
"""Of what is drawn: times in a second, and in all."""
FACE_ALPHA = 0.25
PATH_ALPHA = 0.55
MARK_M = 0.6
CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
CROSS = np.array([(-0.3, 0.0, 0.0), (0.3, 0.0, 0.0), (0.0, -0.3, 0.0), (0.0, 0.3, 0.0)])
EDGES = [(a, b) for a in range(8) for b in range(a) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1]
FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
FACES += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


class ShadeRun(NamedTuple):
    """Frames of equal shade: the first, the one after the last, and AP in steps of 0.05."""

    first: int
    last: int
    ap: float


def color_of_ap(ap: float, never: Rgba = UNSEEN) -> Rgba:
    """Return the colour of an AP; `never` is that of 0."""
    red, green, blue = (float(c) for c in on_scale(ap, CIVIDIS))
    return (red, green, blue, 1.0) if ap > 0.0 else never


def strip_rows(body: SeenBody) -> dict[str, list[ShadeRun]]:
    """Return rows of AP over time, of the rig and each sensor, and the probability of a track."""
    rows = {WHOLE_RIG: body.ap, **body.by_sensor, TRACK: body.confirmed}
    return {name: list(_cells(values)) for name, values in rows.items()}


def _cells(values: Floats) -> Iterator[ShadeRun]:
    shades = np.round(values * 20.0) / 20.0
    edges = [0, *(np.flatnonzero(np.diff(shades)) + 1).tolist(), len(shades)]
    for first, last in pairwise(edges):
        yield ShadeRun(first, last, float(shades[first]))


@dataclass(frozen=True, slots=True, eq=False)
class MovingBody:
    """A body of a scenario, K frames: its size [m], positions (K, 2), headings (K,), AP (K,) and by
    sensor; `seen` is None where it only hides."""

    actor: Actor
    positions: Floats
    headings: Floats
    ap: Floats
    by_sensor: Mapping[str, Floats]
    seen: SeenBody | None

    @property
    def height(self) -> float:
        """Of its middle above the ground [m]."""
        return self.actor.body.low + self.actor.box[2] / 2.0

    def corners(self, k: int) -> Floats:
        """Return its corners (8, 3) at a frame."""
        x, y, z = (CORNERS * self.actor.box).T
        c = np.cos(self.headings[k])
        s = np.sin(self.headings[k])
        turned = np.column_stack([c * x - s * y, s * x + c * y, z])
        return np.asarray(turned + np.array((*self.positions[k], self.height)))


@dataclass(frozen=True, slots=True, eq=False)
class BodiesInTime:
    """The bodies of a drive-by at the times (K,) [s] of a film or a playback."""

    driven: DriveBy
    rate_hz: float
    times: Floats
    bodies: tuple[MovingBody, ...]

    @classmethod
    def of(cls, driven: DriveBy, vehicle: Vehicle | None, rate_hz: float) -> BodiesInTime:
        """Return bodies so many times a second; AP is that of the last frame of the sensors."""
        scenario = driven.scenario
        rate = min(rate_hz, MAX_RATE_HZ, MAX_TIMES / -scenario.start_s)
        times = scenario.times_at(rate)
        where, headings = scenario.positions(vehicle, times)
        found = ((times - scenario.start_s) * RATE_HZ + 1e-6).astype(int)
        frame = np.minimum(found, len(scenario.times) - 1)
        seen = {body.name: body for body in driven.bodies}
        bodies = []
        for k, actor in enumerate(scenario.actors):
            own = seen.get(actor.name) if actor.watched else None
            ap = np.zeros(len(frame)) if own is None else own.ap[frame]
            alone = {} if own is None else {n: v[frame] for n, v in own.by_sensor.items()}
            bodies.append(MovingBody(actor, where[k], headings[k], ap, by_sensor=alone, seen=own))
        return cls(driven, rate, times, tuple(bodies))


def digest(driven: DriveBy) -> str:
    """Return what identifies a drive-by in the file of its film."""
    known = dump_json(driven.to_dict()).encode()
    return f"perception-entropy {hashlib.sha256(known).hexdigest()[:24]}"


class Mark(NamedTuple):
    """A moment of a body: time [s], what it is, colour."""

    time_s: float
    text: str
    color: Rgba


def strip_ends(scenario: Scenario) -> tuple[float, float]:
    """Return the times at both ends of a strip [s], in which each frame has an equal width."""
    half = 0.5 / RATE_HZ
    return float(scenario.times[0]) - half, float(scenario.times[-1]) + half


def marks_of(scenario: Scenario, body: SeenBody) -> list[Mark]:
    """Return when a body is confirmed, and when the vehicle has to brake, the first one first."""
    moment = body.moments[CHANCE]
    marks = [Mark(max(scenario.brake_s, scenario.start_s), "must brake here", BRAKE)]
    if moment is not None:
        marks.append(Mark(moment.time_s, f"confirmed here {CHANCE:.0%}", CONFIRMED))
    return sorted(marks)


@dataclass(frozen=True, slots=True, eq=False)
class TimeStrip:
    """AP over time of the body with the least margin, in a unit square of K columns. `names` are
    those of the rows from above; `cells` (triangles) lie in x and y from 0 to 1. `ends` are the
    times at both ends, `first_s` is that of the first frame [s]."""

    title: str
    names: tuple[str, ...]
    cells: LayerShape
    marks: tuple[Mark, ...]
    first_s: float
    ends: tuple[float, float]

    def share(self, seconds: float) -> float:
        """Return where a time is, from 0 at the left to 1."""
        start, end = self.ends
        return min(max((seconds - start) / (end - start), 0.0), 1.0)


def time_strip(driven: DriveBy) -> TimeStrip:
    """Return the strip of the body with the least margin; sensors that never see it have no row."""
    scenario = driven.scenario
    never = -np.inf
    body = min(driven.bodies, key=lambda b: never if b.margin_s is None else b.margin_s)
    rows = {
        name: cells
        for name, cells in strip_rows(body).items()
        if name not in body.by_sensor or any(cell.ap > 0.0 for cell in cells)
    }
    count = len(scenario.times)
    parts = []
    for number, cells in enumerate(rows.values()):
        top = 1.0 - (number + 0.1) / len(rows)
        bottom = 1.0 - (number + 0.9) / len(rows)
        for cell in cells:
            a = cell.first / count
            b = cell.last / count
            square = [(a, bottom), (b, bottom), (b, top), (a, bottom), (b, top), (a, top)]
            parts.append(Primitives.of([(*p, 0.0) for p in square], color_of_ap(cell.ap, DARK)))
    margin = body.shown_margin_s
    told = "never confirmed" if margin is None else f"margin {margin:+.1f} s"
    return TimeStrip(
        f"{scenario.name}: {body.name}, {told}",
        tuple(rows),
        LayerShape(faces=Primitives.joined(parts)),
        tuple(marks_of(scenario, body)),
        first_s=float(scenario.times[0]),
        ends=strip_ends(scenario),
    )


@dataclass(frozen=True, slots=True, eq=False)
class MovingShape(LayerShape):
    """A shape for each frame of a playback, and the strip below it."""

    frames: tuple[LayerShape, ...] = ()
    rate_hz: float = 1.0
    strip: TimeStrip | None = None

    def at(self, seconds: float) -> LayerShape:
        """Return the shape that many seconds after the first frame; the last one after the end."""
        return self.frames[min(max(round(seconds * self.rate_hz), 0), len(self.frames) - 1)]


def moving_shape(driven: DriveBy, rig: Rig, vehicle: Vehicle | None, rate_hz: float) -> MovingShape:
    """Return a drive-by as it is played: bodies, lines from the sensors that see them, moments."""
    moving = BodiesInTime.of(driven, vehicle, rate_hz)
    places = {sensor.name: sensor.pose.position for sensor in rig}
    still = [_moments(moving, body) for body in moving.bodies if body.seen is not None]
    lines = [line for line, _ in still]
    tags = [tag for _, several in still for tag in several]
    scale = tuple(color_of_ap(ap) for ap in np.linspace(0.001, 1.0, SWATCHES).tolist())
    legend = ColorKey("AP of a body", scale, ("0", "0.5", "1"))
    frames = []
    for k in range(len(moving.times)):
        edges = [*lines]
        faces = []
        rays = []
        names = [*tags]
        for body in moving.bodies:
            color = color_of_ap(body.ap[k])
            corners = body.corners(k)
            edges.append(Primitives.of(corners[np.array(EDGES)], color))
            faces.append(Primitives.of(corners[np.array(FACES)], with_alpha(color, FACE_ALPHA)))
            if body.seen is None:
                continue
            x, y, z = (float(v) for v in (*body.positions[k], body.height))
            names.append(Tag(f"{body.actor.name}: AP {body.ap[k]:.2f}", (x, y, 2 * z), color, True))
            for name, ap in body.by_sensor.items():
                if ap[k] > 0.0:
                    rays.append(Primitives.of([places[name], (x, y, z)], color_of_ap(ap[k])))
        lined = Primitives.joined([*edges, *rays])
        filled = Primitives.joined(faces)
        frames.append(LayerShape(lined, filled, labels=tuple(names), legend=legend))
    strip = time_strip(driven)
    return MovingShape(frames=tuple(frames), rate_hz=moving.rate_hz, strip=strip)


def _moments(moving: BodiesInTime, body: MovingBody) -> tuple[Primitives, list[Tag]]:
    """Return the path of a body on the ground, with its marks."""
    assert body.seen is not None
    path = np.column_stack([body.positions, np.full(len(moving.times), 0.02)])
    parts = [Primitives.of(polyline(path), with_alpha(NEVER, PATH_ALPHA))]
    tags = []
    for mark in marks_of(moving.driven.scenario, body.seen):
        k = int(np.searchsorted(moving.times, mark.time_s - 1e-6).clip(0, len(path) - 1))
        foot = path[k]
        top = foot + np.array((0.0, 0.0, MARK_M))
        x, y, z = (float(v) for v in top)
        parts.append(Primitives.of([foot, top, *(foot + CROSS)], mark.color))
        tags.append(Tag(mark.text, (x, y, z), mark.color))
    return Primitives.joined(parts), tags
