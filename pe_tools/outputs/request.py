"""Request for an output: a study and its options; names for files and nodes, and colours."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pe_core.base.files import file_stem
from pe_core.base.values import LENGTH
from pe_core.scene.rig import Sensor
from pe_core.study import Study

from ..graphics import Rgb

NO_RANGE_M = 80.0
"""How far a sensor is drawn that has no range of its own: as far as the paper looks ahead."""
BLIND: Rgb = (0.75, 0.12, 0.12)
BODY: Rgb = (0.72, 0.74, 0.76)
GLASS: Rgb = (0.35, 0.42, 0.48)


def plain_names(names: Sequence[str]) -> tuple[dict[str, str], list[str]]:
    """Return a name of files for each name, and a message for each name that changed. Plain names
    have letters, digits, ``_`` and ``-``; they differ also without regard to case."""
    plain_by_name: dict[str, str] = {}
    for name in names:
        taken = {used.lower() for used in plain_by_name.values()}
        unique = stem = file_stem(name, "sensor")
        number = 2
        while unique.lower() in taken:
            unique = f"{stem}_{number}"
            number = number + 1
        plain_by_name[name] = unique
    return plain_by_name, [
        f"{a}: called {b} in names of files" for a, b in plain_by_name.items() if a != b
    ]


@dataclass(frozen=True, slots=True)
class OutputRequest:
    """A study, and the length to which fields of view are drawn. They end at `range_m` [m], which
    is positive, or at a sensor's own range where that is nearer."""

    study: Study
    range_m: float | None = None

    def __post_init__(self) -> None:
        if self.range_m is not None:
            checked = LENGTH.checked("export", "range", self.range_m)
            object.__setattr__(self, "range_m", checked)

    def reach(self, sensor: Sensor, default: float | None = None) -> float:
        """Return the range to which a sensor is drawn [m]. It is the smaller of the sensor's range
        and `range_m`. Without `range_m`, `default` is used instead. Without either, a sensor with
        infinite range is drawn to `NO_RANGE_M`."""
        sensor_range = float(getattr(sensor.model, "max_range", math.inf))
        limit = self.range_m if self.range_m is not None else default
        if limit is None:
            return sensor_range if math.isfinite(sensor_range) else NO_RANGE_M
        return min(sensor_range, limit)


def linear(color: Rgb) -> list[float]:
    """Return a colour in linear light, as glTF has it (IEC 61966-2-1)."""
    return [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in color]
