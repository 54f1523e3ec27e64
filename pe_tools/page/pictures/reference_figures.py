"""Figures in pictures of sensors: persons and cars of known size, test bodies at worst places."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

import pe_core as pe
from pe_core import sensors as kinds
from pe_core.scoring import requirements
from pe_core.scoring.requirements.definition import placed

from .painted_mesh import GLASS, TYRE, PaintedMesh, Rgb, rounded_box

PERSON_M = (0.5, 0.5, 1.75)  # Length, width and height of a person
CAR_M = (4.5, 1.8, 1.5)  # Length, width and height of a car; about the mean of cars on the road
SKIN = (0.55, 0.36, 0.25)
COAT = (0.80, 0.36, 0.02)
TROUSERS = (0.10, 0.11, 0.14)
CAR_PAINT = (0.03, 0.14, 0.38)
Block = tuple[tuple[float, float, float], tuple[float, float, float], Rgb]
"""Half the sizes of a block, its middle [m], and its linear colour."""
PERSON: tuple[Block, ...] = (
    ((0.10, 0.16, 0.42), (0.0, 0.0, 0.42), TROUSERS),
    ((0.12, 0.25, 0.34), (0.0, 0.0, 1.17), COAT),
    ((0.10, 0.09, 0.12), (0.0, 0.0, 1.63), SKIN),
)
CAR: tuple[Block, ...] = (
    ((2.25, 0.9, 0.36), (0.0, 0.0, 0.58), CAR_PAINT),
    ((1.2, 0.74, 0.26), (-0.25, 0.0, 1.18), GLASS),
    ((1.1, 0.7, 0.03), (-0.25, 0.0, 1.47), CAR_PAINT),
    *(((0.33, 0.1, 0.33), (x, y, 0.33), TYRE) for x in (1.35, -1.35) for y in (0.82, -0.82)),
)
DISTANCES = (5.0, 10.0, 20.0, 40.0)
"""Distances from the sensor to the near side of figures, along the ground [m]."""
FIRST_RAD = math.radians(0.8)
GAP_RAD = math.radians(0.7)
"""Angles between straight ahead and the first figure, and between two figures."""
VIEW_SHARE = 0.72  # Share of a wide view over which figures are spread
MAX_SPREAD = 3.0  # Limit of the factor by which angles grow in a wide view
CLEAR_M = 0.3  # Smallest distance between a figure and the vehicle


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
            painted = blocks(CAR if name == "car" else PERSON, x, y, heading)
            if vehicle is not None:
                low, high = painted.mesh.bounds
                low_2, high_2 = vehicle.bounds
                if not ((low > high_2 + CLEAR_M) | (high < low_2 - CLEAR_M))[:2].any():
                    continue
            figures.append(ReferenceFigure(name, distance, (x, y, size[2]), painted))
    return figures


def _angle_by_distance(width: float, half_view: float) -> dict[float, float]:
    """Return the angle from straight ahead [rad] by distance: side by side, the farthest first."""
    edge = FIRST_RAD
    angles = {}
    for distance in reversed(DISTANCES):
        half = math.atan(width / 2.0 / distance)
        angles[distance] = edge + half
        edge += 2.0 * half + GAP_RAD
    spread = min(max(VIEW_SHARE * half_view / edge, 1.0), MAX_SPREAD)
    return {d: spread * angle for d, angle in angles.items() if angle < half_view}


def blocks(shape: Sequence[Block], x: float, y: float, heading: float) -> PaintedMesh:
    """Return a figure of blocks with its middle at a position [m] and a heading [rad]."""
    c = math.cos(heading)
    s = math.sin(heading)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    solids = [rounded_box(np.array(half)) + np.array(middle) for half, middle, _ in shape]
    parts = np.repeat(np.arange(len(solids)), [len(solid) for solid in solids])
    triangles = np.concatenate(solids) @ turn + np.array([x, y, 0.0])
    names = [f"part {k}" for k in range(len(solids))]
    return PaintedMesh(pe.Vehicle(triangles, parts, names), tuple(paint for *_, paint in shape))


def heading_of(sensor: pe.Sensor) -> float:
    """Return the heading of a sensor [rad]; if it looks up or down, that of its upper side."""
    ahead, up = (sensor.pose.ground_from_sensor[:2, k] for k in (0, 2))
    flat = ahead if math.hypot(*ahead.tolist()) > 0.2 else up
    return math.atan2(float(flat[1]), float(flat[0]))


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
        found.append(WorstBody(number, verdict, body, foot, counts=counts))
    return tuple(found)


def count_text(sensor: pe.Sensor, count: float) -> str:
    """Return how many points or pixels a sensor has on a body, rounded down, as text."""
    unit = "points" if kinds.kind_of(sensor).counts_points else "px"
    return f"{int(count):,} {unit}"
