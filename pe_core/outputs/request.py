"""What is wanted of an output of the scene."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..scene.sensors import Sensor
from ..study import Study
from ..text.values import LENGTH

NO_RANGE_M = 80.0
"""How far a sensor is drawn that has no range of its own: as far as the paper looks ahead."""


@dataclass(frozen=True, slots=True)
class OutputRequest:
    """A study, and how far its sensors are drawn.

    Parameters
    ----------
    study : Study
    range_m : float, optional
        Fields of view end here, or at a sensor's own range where that is nearer [m].

    Raises
    ------
    InputError
        When the range is not positive.
    """

    study: Study
    range_m: float | None = None

    def __post_init__(self) -> None:
        if self.range_m is not None:
            checked = LENGTH.checked("export", "range", self.range_m)
            object.__setattr__(self, "range_m", checked)

    def reach(self, sensor: Sensor, most: float | None = None) -> float:
        """Return how far a sensor is drawn [m]: its own range, or what was asked for if nearer.

        Where nothing was asked for, `most`; or `NO_RANGE_M` for one that has no range.
        """
        own = float(getattr(sensor.model, "max_range", math.inf))
        asked = self.range_m if self.range_m is not None else most
        if asked is None:
            return own if math.isfinite(own) else NO_RANGE_M
        return min(own, asked)
