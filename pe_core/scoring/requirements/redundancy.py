"""Redundancy: by how many sensors and kinds each place is seen, and what is left of them.

At every place of a grid on the ground a test body stands alone: an upright cylinder as wide as
those of FMVSS 111 and UN R158 and as tall as stated. A radar sees it as a pedestrian, if it is no
lower than these. The map errs to the safe side as verdicts do.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Ints
from ...base.lazy_threads import threads
from ...base.values import Number
from ...geometry.grids import PerceptionSpace
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import ObjectMeasurementCache, kind_of
from ..sight.blind_ground import body_rectangle
from ..sight.ground_cells import GroundCells, widened
from .bodies import BODIES, Body
from .definition import cautious, placed
from .planes import VehiclePlanes
from .zones import INSIDE_M, signed_distance

HEIGHT = Number(0.01, 5.0, unit="m", noun="length")
NO_GROUND = -1
"""Value of places that the vehicle takes."""


@dataclass(frozen=True, eq=False)
class RedundancyMap:
    """By how many sensors and kinds each place is seen.

    Attributes
    ----------
    cells : GroundCells
        The places are the middles of its squares.
    height : float
        Of the body [m].
    sensors, kinds : (NX, NY) int
        How many sensors, and of how many kinds, see the body; -1 under the vehicle.
    sensors_left, kinds_left : (NX, NY) int
        The fewest of them when any one sensor is lost; -1 under the vehicle.
    by_sensor : dict of (NX, NY) bool
        Whether each sensor sees the body.
    """

    cells: GroundCells
    height: float
    sensors: Ints
    kinds: Ints
    sensors_left: Ints
    kinds_left: Ints
    by_sensor: dict[str, NDArray[np.bool_]]

    def share(self, sensors: int = 1, kinds: int = 1, *, one_lost: bool = False) -> float:
        """Return the share of the ground that so many sensors of so many kinds see.

        With `one_lost`: that they still see when any one sensor is lost.
        """
        counts, of_kinds = (
            (self.sensors_left, self.kinds_left) if one_lost else (self.sensors, self.kinds)
        )
        ground = self.sensors > NO_GROUND
        enough = (counts >= sensors) & (of_kinds >= kinds) & ground
        return float(np.count_nonzero(enough)) / max(int(np.count_nonzero(ground)), 1)

    def to_dict(self) -> dict[str, Any]:
        """Return the shares of the ground as plain data."""
        most, of_kinds = len(self.by_sensor), int(self.kinds.max(initial=0))
        ground = self.sensors > NO_GROUND
        return {
            "height_m": self.height,
            "step_m": self.cells.step,
            "ground_m2": round(float(np.count_nonzero(ground)) * self.cells.step**2, 3),
            "sensors": {str(k): round(self.share(k), 6) for k in range(1, most + 1)},
            "kinds": {str(k): round(self.share(k, k), 6) for k in range(1, of_kinds + 1)},
            "seen_with_one_lost": round(self.share(one_lost=True), 6),
        }


class Redundancy:
    """Computes redundancy maps round one vehicle; a sensor that has not moved costs nothing.

    Parameters
    ----------
    vehicle : Vehicle or None
    space : PerceptionSpace
        Ground outside of it is left out.
    height : float
        Of the body [m].
    within : float
        How far from the vehicle's rectangle [m].
    step : float
        Distance of the places [m].

    Raises
    ------
    InputError
        When a number is out of its range, or there are too many places.
    """

    def __init__(
        self,
        vehicle: Vehicle | None,
        space: PerceptionSpace,
        height: float = 0.8,
        within: float = 10.0,
        step: float = 0.5,
    ) -> None:
        self.height = HEIGHT.checked("redundancy", "height", height)
        self.cells = GroundCells.of(space, step, widened(body_rectangle(vehicle), within))
        grid = np.meshgrid(self.cells.x, self.cells.y, indexing="ij")
        points = np.stack(grid, axis=-1).reshape(-1, 2)
        free = np.ones(len(points), bool)
        if vehicle is not None:
            free = signed_distance(points, VehiclePlanes.of(vehicle).outline) > INSIDE_M
        self._free = free
        cylinder = BODIES["cylinder"]
        size = (*cylinder.size[:2], self.height)
        known = cylinder.class_name if self.height >= cylinder.size[2] else None
        body = Body("body", size, is_round=True, class_name=known)
        feet = np.column_stack([points[free], np.zeros(int(free.sum()))])
        objects = placed(body, feet, body.headings, False)
        self._sensors, self._lock = ObjectMeasurementCache(objects, vehicle), threads().RLock()

    def map(self, rig: Rig) -> RedundancyMap:
        """Return the redundancy map of a rig."""
        with self._lock:
            m = self._sensors.measure(cautious(rig))
        seen = {s.name: m[s.name] >= kind_of(s).point for s in rig}  # a beam, a pixel, a detection
        kinds = {kind_of(s).name: np.zeros(int(self._free.sum()), np.int64) for s in rig}
        for sensor in rig:
            kinds[sensor.kind] += seen[sensor.name]
        counts = np.sum(list(kinds.values()), axis=0)
        of_kinds = np.sum([own > 0 for own in kinds.values()], axis=0)
        alone = np.any([own == 1 for own in kinds.values()], axis=0)  # one kind has one sensor
        return RedundancyMap(
            self.cells,
            self.height,
            self._whole(counts),
            self._whole(of_kinds),
            self._whole(np.maximum(counts - 1, 0)),
            self._whole(np.where(alone, of_kinds - 1, of_kinds)),
            {name: self._whole(flags.astype(np.int64)) > 0 for name, flags in seen.items()},
        )

    def _whole(self, values: Ints) -> Ints:
        """Return values of free places as a map (NX, NY)."""
        whole = np.full(len(self._free), NO_GROUND)
        whole[self._free] = values
        return whole.reshape(self.cells.shape)
