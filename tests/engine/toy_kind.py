"""A kind of sensor that only tests know: a toy ring, m from the distance alone.

All of the kind is in this file; no module of the engine or the add-on names it.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

import pe_core as pe
from pe_core import sensors as kinds
from pe_core.scene.rig import SensorModel

CURVE = pe.ApCurve(0.1, 0.4)


@dataclass(frozen=True, eq=False)
class Ring(SensorModel):
    """A toy ring."""

    kind: ClassVar[str] = "toyring"
    name: str
    range_m: float


def measure(sensor, centers, side, vehicle):
    """How many times the distance goes into the range, 0 beyond it."""
    offsets = centers - np.asarray(sensor.pose.position)
    distance = np.sqrt((offsets**2).sum(axis=1))
    times = sensor.model.range_m / np.maximum(distance, side / 2)
    return np.where(times >= 1.0, times, 0.0)


def read(name, table, folder):
    if "range_m" not in table:
        raise pe.InputError(name, "range_m", "a range in metres", "none")
    return Ring(name, float(table["range_m"]))


RING = kinds.Kind(
    name="toyring",
    label="Toy Ring",
    plural="Toy Rings",
    unit="echoes",
    model=Ring,
    curve=CURVE,
    keys=frozenset({"range_m"}),
    measure=measure,
    read=read,
    write=lambda model: {"range_m": model.range_m},
    data_sheet=lambda model: [f"range           {model.range_m:g} m"],
)
