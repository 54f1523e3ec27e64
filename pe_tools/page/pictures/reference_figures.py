"""Figures in pictures of sensors: persons and cars of known size, test bodies at worst places."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

import pe_core as pe
from pe_core import sensors as kinds
from pe_core.base.arrays import Floats
from pe_core.scoring import requirements
from pe_core.scoring.requirements.definition import placed

from .painted_mesh import GLASS, TAIL, TYRE, Paint, PaintedMesh, capped, lathe

PERSON_M = (0.5, 0.5, 1.75)
"""Length, width and height of a person."""
CAR_M = (4.5, 1.8, 1.5)
"""Length, width and height of a car; about the mean of cars on the road."""
SKIN, COAT = Paint((0.55, 0.36, 0.25)), Paint((0.80, 0.36, 0.02))
TROUSERS = Paint((0.10, 0.11, 0.14))
CAR_PAINT = Paint((0.03, 0.14, 0.38), 0.6)
DISTANCES = (5.0, 10.0, 20.0, 40.0)
"""Distances from the sensor to the near side of figures, along the ground [m]."""
FIRST_RAD, GAP_RAD = math.radians(0.8), math.radians(0.7)
"""Angles between straight ahead and the first figure, and between two figures."""
VIEW_SHARE = 0.72
"""Share of a wide view over which figures are spread."""
MAX_SPREAD = 3.0
"""Limit of the factor by which angles grow in a wide view."""
CLEAR_M = 0.3
"""Smallest distance between a figure and the vehicle."""
ROUND = 16
"""Points of a circle."""
PaintedParts = tuple[tuple[Floats, Paint], ...]


@dataclass(frozen=True, slots=True)
class ReferenceFigure:
    """A person or a car (`name`) at a `distance` [m]; `top` is the point that is labelled [m]."""

    name: str
    distance: float
    top: tuple[float, float, float]
    painted: PaintedMesh

    @property
    def label(self) -> str:
        """The text at the figure."""
        return f"{self.distance:g} m"


def reference_figures(
    sensor: pe.Sensor, half_view: float, vehicle: pe.Vehicle | None
) -> list[ReferenceFigure]:
    """Return persons on the left and cars on the right of a sensor's heading. Figures that do not
    fit into the horizontal field of view, twice `half_view` [rad], or that would overlap the
    vehicle are left out."""
    figures = []
    for name, size, side in (("person", PERSON_M, 1.0), ("car", CAR_M, -1.0)):
        for distance, angle in _angle_by_distance(size[1], half_view).items():
            heading = heading_of(sensor) + side * angle
            away = distance + (size[0] / 2.0 if name == "car" else 0.0)
            x = sensor.pose.position[0] + away * math.cos(heading)
            y = sensor.pose.position[1] + away * math.sin(heading)
            painted = car(x, y, heading) if name == "car" else person(x, y, heading + math.pi)
            if vehicle is not None:
                (low, high), (low_2, high_2) = painted.mesh.bounds, vehicle.bounds
                if not ((low > high_2 + CLEAR_M) | (high < low_2 - CLEAR_M))[:2].any():
                    continue
            figures.append(ReferenceFigure(name, distance, (x, y, size[2]), painted))
    return figures


def _angle_by_distance(width: float, half_view: float) -> dict[float, float]:
    """Return the angle from straight ahead [rad] by distance: side by side, the farthest first."""
    edge, angles = FIRST_RAD, {}
    for distance in reversed(DISTANCES):
        half = math.atan(width / 2.0 / distance)
        angles[distance] = edge + half
        edge += 2.0 * half + GAP_RAD
    spread = min(max(VIEW_SHARE * half_view / edge, 1.0), MAX_SPREAD)
    return {d: spread * angle for d, angle in angles.items() if angle < half_view}


def heading_of(sensor: pe.Sensor) -> float:
    """Return the heading of a sensor [rad]; if it looks up or down, that of its upper side."""
    ahead, up = (sensor.pose.ground_from_sensor[:2, k] for k in (0, 2))
    flat = ahead if math.hypot(*ahead.tolist()) > 0.2 else up
    return math.atan2(float(flat[1]), float(flat[0]))


def person(x: float, y: float, heading: float) -> PaintedMesh:
    """Return a person at a position [m] who faces a heading [rad]."""
    legs = [_limb(side * 0.09, ((0.0, 0.07), (0.45, 0.065), (0.88, 0.09))) for side in (1, -1)]
    arm = ((0.74, 0.04), (1.1, 0.047), (1.36, 0.06), (1.44, 0.03))
    arms = [_limb(side * 0.225, arm) for side in (1, -1)]
    shape = ((0.82, 0.12, 0.17), (1.05, 0.11, 0.16), (1.35, 0.13, 0.21), (1.46, 0.09, 0.17))
    torso = capped([_oval(*ring) for ring in (*shape, (1.52, 0.06, 0.06))])
    turn = np.linspace(-np.pi / 2.0, np.pi / 2.0, 9).tolist()
    head = lathe([(0.10 * math.cos(t), 1.625 + 0.125 * math.sin(t)) for t in turn], ROUND)
    groups = (
        (head, SKIN),
        (np.concatenate([torso, *arms]), COAT),
        (np.concatenate(legs), TROUSERS),
    )
    return _placed(groups, x, y, heading)


def car(x: float, y: float, heading: float) -> PaintedMesh:
    """Return a car with its centre at a position [m] and a heading [rad]."""
    lower = ((0.22, 2.15, 0.78), (0.34, 2.25, 0.88), (0.72, 2.23, 0.90), (0.90, 2.12, 0.84))
    body = capped([_rounded(z, x0, y0, 0.0) for z, x0, y0 in lower])
    upper = ((0.88, 1.45, 0.80), (1.44, 0.98, 0.64), (1.43, 0.99, 0.65), (1.5, 0.80, 0.52))
    cabin, roof = (
        capped([_rounded(*ring, -0.25) for ring in pair]) for pair in (upper[:2], upper[2:])
    )
    disc = lathe([(0.0, -0.1), (0.33, -0.1), (0.33, 0.1), (0.0, 0.1)], ROUND)[..., [0, 2, 1]]
    axles = [(x0, y0, 0.33) for x0 in (1.35, -1.35) for y0 in (0.80, -0.80)]
    wheels = np.concatenate([disc + np.array(axle) for axle in axles])
    ring = np.array([[0.0, 0.14, 0.0], [0.0, -0.14, 0.0], [-0.03, -0.14, 0.0], [-0.03, 0.14, 0.0]])
    lamps = np.concatenate(
        [capped([ring + np.array([-2.2, side, z]) for z in (0.68, 0.82)]) for side in (0.62, -0.62)]
    )
    painted = np.concatenate([body, roof])
    groups = ((painted, CAR_PAINT), (cabin, GLASS), (wheels, TYRE), (lamps, TAIL))
    return _placed(groups, x, y, heading)


def _placed(groups: PaintedParts, x: float, y: float, heading: float) -> PaintedMesh:
    c, s = math.cos(heading), math.sin(heading)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    triangles = np.concatenate([part for part, _ in groups])
    placed = np.einsum("ij,fkj->fki", turn, triangles) + np.array([x, y, 0.0])
    parts = np.repeat(np.arange(len(groups)), [len(part) for part, _ in groups])
    names = [f"part {k}" for k in range(len(groups))]
    return PaintedMesh(pe.Vehicle(placed, parts, names), tuple(paint for _, paint in groups))


def _oval(z: float, deep: float, wide: float) -> Floats:
    turn = np.arange(ROUND) * 2.0 * np.pi / ROUND
    return np.column_stack([deep * np.cos(turn), wide * np.sin(turn), np.full(ROUND, z)])


def _limb(y: float, rings: tuple[tuple[float, float], ...]) -> Floats:
    return capped([_oval(z, r, r) for z, r in rings]) + np.array([0.0, y, 0.0])


def _rounded(z: float, long: float, wide: float, x: float) -> Floats:
    """Return a ring around a car at a height: a shape between an oval and a rectangle."""
    turn = (np.arange(2 * ROUND) + 0.5) * np.pi / ROUND
    c, s = np.cos(turn), np.sin(turn)
    right, left = (np.sign(w) * np.abs(w) ** 0.4 for w in (c, s))
    return np.column_stack([right * long + x, left * wide, np.full(len(turn), z)])


@dataclass(frozen=True, eq=False)
class WorstBody:
    """The test body of a requirement, at the worst sample of its zone: at `foot` (3,) [m]. `number`
    is that of the requirement in the table, from 1; `counts` are points or pixels on the body by
    the name of the sensor, of the heading with the fewest."""

    number: int
    verdict: requirements.Verdict
    body: requirements.Body
    foot: tuple[float, float, float]
    counts: Mapping[str, float]


def worst_bodies(
    verdicts: Iterable[requirements.Verdict], rig: pe.Rig, vehicle: pe.Vehicle | None
) -> tuple[WorstBody, ...]:
    """Return each requirement's test body at its worst sample, with what each sensor has on it.
    Requirements of blind ground have no body and are left out."""
    found = []
    for number, verdict in enumerate(verdicts, start=1):
        bodies = {body.name: body for body in verdict.requirement.bodies}
        if verdict.worst is None or verdict.body not in bodies:
            continue
        body = bodies[verdict.body]
        foot = (*verdict.worst, verdict.requirement.zone.z[0])
        objects = placed(body, [foot], body.headings, False)
        measured = kinds.ObjectMeasurementCache(objects, vehicle).measure(rig)
        counts = {name: float(m.min()) for name, m in measured.items()}
        found.append(WorstBody(number, verdict, body, foot, counts))
    return tuple(found)


def count_text(sensor: pe.Sensor, count: float) -> str:
    """Return how many points or pixels a sensor has on a body, rounded down, as text."""
    unit = "points" if kinds.kind_of(sensor).counts_points else "px"
    return f"{int(count):,} {unit}"
