"""An ultrasonic sensor's intrinsics: a cone, a range, the incidence that still gives an echo."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, cast

from ...base.values import A_NAME, Angle, Number
from ...scene.rig import Sensor, SensorModel
from ..field_of_view import NEAREST, SHORTEST_RANGE_M, checked_ranges
from ..ray_fan import AngleWindow

RANGE = Number(SHORTEST_RANGE_M, cap=1e3, unit="m", noun="length")
CONE = Angle(0.01, 178.0)
INCIDENCE = Angle(0.01, 90.0)
RIGHT_ANGLE = math.pi / 2.0


@dataclass(frozen=True, eq=False)
class Ultrasonic(SensorModel):
    """Intrinsics of an ultrasonic sensor.

    Parameters
    ----------
    name : str
        Catalogue name, or the user's own.
    max_range : float
        [m]
    hfov, vfov : float
        Angles of the elliptic cone, across and up, from edge to edge [rad].
    min_range : float
        Nothing is measured nearer [m].
    max_incidence : float
        Largest angle between a ray and the normal of a surface at which an echo comes back [rad].

    Raises
    ------
    InputError
        When an angle or a range is impossible.
    """

    kind: ClassVar[str] = "ultrasonic"

    name: str
    max_range: float
    hfov: float
    vfov: float
    min_range: float = NEAREST
    max_incidence: float = RIGHT_ANGLE

    def __post_init__(self) -> None:
        name, put = A_NAME.checked("ultrasonic", "name", self.name), object.__setattr__
        near, far = checked_ranges(name, self.min_range, self.max_range, RANGE)
        for key, rule in (("hfov", CONE), ("vfov", CONE), ("max_incidence", INCIDENCE)):
            put(self, key, rule.checked(name, key, getattr(self, key)))
        put(self, "min_range", near)
        put(self, "max_range", far)

    @property
    def window(self) -> AngleWindow:
        """Azimuths and elevations between which the cone is [rad]."""
        across, up = self.hfov / 2.0, self.vfov / 2.0
        return (-across, across), (-up, up)


def ultrasonic_of(sensor: Sensor) -> Ultrasonic:
    """Return the model of a sensor that is an ultrasonic sensor."""
    return cast(Ultrasonic, sensor.model)
