"""What a rig sees of test bodies that stand somewhere: m of each sensor, and AP of all fused."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pe_core.base.errors import InputError, plural
from pe_core.base.values import Number, choice, rounded, vector
from pe_core.geometry.poses import METRES
from pe_core.metric.entropy import ap_of_entropy
from pe_core.scene.objects import Objects
from pe_core.scene.rig import Rig
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.requirements import BODIES, placed
from pe_core.scoring.targets import FusedObjects
from pe_core.sensors import ObjectMeasurementCache, PerceptionModel, kind_named

HEADING = Number(-360.0, 360.0, unit="degrees", noun="angle")


@dataclass(frozen=True, slots=True)
class StandingBody:
    """A test body alone on the ground, named in `BODIES`: `place` x, y [m], `heading` [deg].

    `InputError` when there is no such body, or a value is none.
    """

    body: str
    place: tuple[float, float]
    heading: float = 0.0

    def __post_init__(self) -> None:
        choice("body", "name", self.body, BODIES)
        place = vector("body", "place", self.place, count=2, rule=METRES)
        object.__setattr__(self, "place", (place[0], place[1]))
        object.__setattr__(self, "heading", HEADING.checked("body", "heading", self.heading))

    @property
    def objects(self) -> Objects:
        """The body as the object that is measured."""
        feet = [(*self.place, 0.0)]
        return placed(BODIES[self.body], feet, [math.radians(self.heading)], False)


@dataclass(frozen=True, slots=True)
class SensorOnBody:
    """What one sensor measures of a body: m, beams or pixels, in the unit of its kind."""

    name: str
    m: float
    unit: str

    @property
    def text(self) -> str:
        """The measurement with its unit: "63 beams"."""
        return plural(self.m, self.unit.removesuffix("s"))


@dataclass(frozen=True, slots=True)
class BodySight:
    """What a rig sees of a body. `ap` is that of all sensors fused, by the curve of the body's
    class, 0 to 1; None where there is no such curve. `sensors` are in the rig's order."""

    standing: StandingBody
    ap: float | None
    sensors: tuple[SensorOnBody, ...]

    @property
    def seeing(self) -> tuple[SensorOnBody, ...]:
        """The sensors that see it."""
        return tuple(each for each in self.sensors if each.m > 0.0)

    @property
    def summary(self) -> str:
        """By how many sensors it is seen, and AP."""
        if not self.seeing:
            return "seen by no sensor"
        together = "" if self.ap is None else f", AP {self.ap:.2f}"
        return f"seen by {len(self.seeing)} of {len(self.sensors)}{together}"

    @property
    def text(self) -> tuple[str, ...]:
        """Lines of text: the body, then each sensor that sees it."""
        standing = self.standing
        x, y = standing.place
        where = f"{standing.body} at ({x:g}, {y:g}) m, heading {standing.heading:g} deg"
        lines = (f"{each.name}: {each.text}" for each in self.seeing)
        return (f"{where}: {self.summary}", *lines)

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain JSON data, with its text."""
        standing = self.standing
        return {
            "body": standing.body,
            "place": list(standing.place),
            "heading": standing.heading,
            "ap": self.ap,
            "sensors": {each.name: {"m": each.m, "unit": each.unit} for each in self.sensors},
            "text": list(self.text),
        }


def see_bodies(
    rig: Rig,
    vehicle: Vehicle | None,
    bodies: Sequence[StandingBody],
    model: PerceptionModel | None = None,
    kernel_caches: dict[str, Any] | None = None,
) -> tuple[BodySight, ...]:
    """Return what a rig sees of bodies, each alone with the vehicle, as objects are measured.

    `kernel_caches` are those of the sensors' kernels on that vehicle, for the next call.
    """
    found = []
    for standing in bodies:
        objects = standing.objects
        measured = ObjectMeasurementCache(objects, vehicle, kernel_caches=kernel_caches)
        m = measured.measure(rig)
        ap = None
        if BODIES[standing.body].class_name is not None:
            fused = FusedObjects(objects, np.ones(1), model or PerceptionModel())
            try:
                fused.check(rig)
                ap = rounded(ap_of_entropy(fused.entropies(rig, m)[0])[0])
            except InputError:  # a class, or a sensor, without a curve of objects
                pass
        units = ((s.name, kind_named(s.kind, s.name).unit) for s in rig)
        sensors = tuple(SensorOnBody(name, rounded(m[name][0]), unit) for name, unit in units)
        found.append(BodySight(standing, ap, sensors))
    return tuple(found)
