"""A rig on its vehicle with the housings that are known."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..base.plugins import shipped
from ..geometry.overlap import Hull
from ..scene.rig import Housing, Rig, Sensor, hull_of
from ..scene.vehicle import Vehicle


@dataclass(frozen=True)
class Placement:
    """A rig on its vehicle with the housings that are known; each hull is computed once."""

    rig: Rig
    vehicle: Any = None
    housings: Mapping[str, Housing] = field(default_factory=dict)
    _hulls: dict[str, Hull] = field(default_factory=dict)

    @classmethod
    def on(cls, rig: Rig, vehicle: Vehicle | None) -> "Placement":
        """Return a rig on a vehicle, with the housings of the catalogue."""
        return cls(rig, vehicle, housings_of(rig))

    def hull(self, name: str) -> Hull:
        """Return the convex hull of a sensor's housing."""
        if name not in self._hulls:
            self._hulls[name] = hull_of(self.rig[name].pose, self.housings.get(name))
        return self._hulls[name]


def housings_of(rig: Iterable[Sensor]) -> dict[str, Housing]:
    """Return the housings that the catalogue has, by sensor."""
    housing = shipped("catalog.housing")
    housings = {sensor.name: housing(sensor.model.name) for sensor in rig}
    return {name: housing for name, housing in housings.items() if housing is not None}
