"""Test bodies at the worst places of their zones, as cameras and LiDARs see them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

import pe_core as pe
from pe_core import sensors as kinds
from pe_core.base.arrays import Floats
from pe_core.scoring import requirements
from pe_core.scoring.requirements.definition import placed

from .painted_mesh import Paint, PaintedMesh, capped
from .reference_figures import ReferenceFigure

MET_PAINT, NOT_MET_PAINT = Paint((0.02, 0.24, 0.10)), Paint((0.62, 0.09, 0.01))
AROUND = 24
"""Points of a circle."""
POLE_M = 0.06
"""Width of the pole below a body that is not on the ground."""


@dataclass(frozen=True, eq=False)
class WorstBody:
    """The test body of a requirement, at the worst sample of its zone: at `foot` (3,) [m].

    `number` is that of the requirement in the table, from 1; `counts` are points or pixels on the
    body by the name of the sensor, of the heading with the fewest.
    """

    number: int
    verdict: requirements.Verdict
    body: requirements.Body
    foot: tuple[float, float, float]
    counts: Mapping[str, float]

    def figure(self, sensor: pe.Sensor) -> ReferenceFigure:
        """Return the body as a figure in a sensor's picture."""
        x, y, z = self.foot
        top = x, y, z + self.body.low + self.body.size[2]
        label = f"{self.number}: {count_text(sensor, self.counts[sensor.name])}"
        return ReferenceFigure(self.body.name, 0.0, top, self._painted(), label)

    def _painted(self) -> PaintedMesh:
        paint = MET_PAINT if self.verdict.met else NOT_MET_PAINT
        low, high = self.body.low, self.body.low + self.body.size[2]
        shapes = [self._solid(low, high, self.body.size[:2])]
        if self.body.shape is not None:
            c, s = np.cos(self.body.headings[0]), np.sin(self.body.headings[0])
            turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
            shapes = [self.body.shape.triangles @ turn + np.array([0.0, 0.0, low])]
        if low > 0.0:
            shapes.append(self._solid(0.0, low, (POLE_M, POLE_M)))
        triangles = np.concatenate(shapes) + np.array(self.foot)
        return PaintedMesh(pe.Vehicle(triangles), (paint,))

    def _solid(self, low: float, high: float, size: tuple[float, ...]) -> Floats:
        """Return an upright cylinder or box round the origin, turned as the body stands."""
        length, width = size[0] / 2.0, size[1] / 2.0
        if self.body.is_round:
            turn = np.arange(AROUND) * 2.0 * np.pi / AROUND
            ring = np.column_stack([length * np.cos(turn), width * np.sin(turn)])
        else:
            ring = np.array(
                [[length, width], [-length, width], [-length, -width], [length, -width]]
            )
            heading = self.body.headings[0]
            c, s = np.cos(heading), np.sin(heading)
            ring = ring @ np.array([[c, s], [-s, c]])
        return capped([np.column_stack([ring, np.full(len(ring), z)]) for z in (low, high)])


def worst_bodies(
    verdicts: Iterable[requirements.Verdict], rig: pe.Rig, vehicle: pe.Vehicle | None
) -> tuple[WorstBody, ...]:
    """Return each requirement's test body at its worst sample, with what each sensor has on it.

    Requirements of blind ground have no body and are left out.
    """
    found = []
    for number, verdict in enumerate(verdicts, start=1):
        bodies = {body.name: body for body in verdict.requirement.bodies}
        if verdict.worst is None or verdict.body not in bodies:
            continue
        body = bodies[verdict.body]
        foot = (*verdict.worst, verdict.requirement.zone.z[0])
        objects = placed(body, [foot], body.headings, False)
        measured = kinds.ObjectMeasurementCache(objects, vehicle).measure(rig)
        counts = {
            name: float(m.reshape(-1, body.box_count).max(axis=1).min())
            for name, m in measured.items()
        }
        found.append(WorstBody(number, verdict, body, foot, counts))
    return tuple(found)


def count_text(sensor: pe.Sensor, count: float) -> str:
    """Return how many points or pixels a sensor has on a body, rounded down, as text."""
    unit = "points" if kinds.kind_of(sensor).counts_points else "px"
    return f"{int(count):,} {unit}"
