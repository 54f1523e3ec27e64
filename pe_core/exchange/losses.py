"""What a format cannot hold of a rig, in one line: what each holds is declared, a set a format.

Lenses have their own lines (`pictures`), as have channels that a format spaces evenly.
"""

from __future__ import annotations

from collections.abc import Iterator

from .. import catalog
from ..scene.sensors import Rig, Sensor, SensorModel
from .carried import CarriedSensor, carried

MODEL = "model"
"""The model's name: what the catalogue says of it is not lost."""
BEAMS = "beams"
"""A LiDAR's channels, azimuths and range."""
MIN_RANGE, MAX_RANGE = "minimum range", "maximum range"
FUSION, CURVE = "fusion group", "AP curve"
EVERYTHING = (BEAMS, MIN_RANGE, MAX_RANGE, FUSION, CURVE)


def lost_line(rig: Rig, title: str, holds: frozenset[str]) -> list[str]:
    """Return what of a rig a format has no room for, in one line; nothing where it has.

    Parameters
    ----------
    rig : Rig
    title : str
        The format, as people call it.
    holds : frozenset of str
        Of `MODEL` and `EVERYTHING`, what it holds.
    """
    pairs = zip(rig, carried(rig), strict=True)
    lost = {sensor.name: set(_owned(sensor, each, holds)) - holds for sensor, each in pairs}
    parts = []
    for feature in EVERYTHING:
        names = [name for name, features in lost.items() if feature in features]
        if names:
            parts.append(f"{feature} of {', '.join(names)}")
    return [f"left out of {title}: {'; '.join(parts)}"] if parts else []


def _owned(sensor: Sensor, each: CarriedSensor, holds: frozenset[str]) -> Iterator[str]:
    """Yield what a sensor has that is not there by itself."""
    if sensor.fusion is not None:
        yield FUSION
    if sensor.curve is not None:
        yield CURVE
    if MODEL in holds and _is_catalogued(sensor.model):
        return
    if each.scan is not None:
        yield BEAMS
        if BEAMS not in holds:
            return  # with its ranges
    if each.min_range is not None:
        yield MIN_RANGE
    if each.max_range is not None and each.scan is None:
        yield MAX_RANGE


def _is_catalogued(model: SensorModel) -> bool:
    """Whether the catalogue has a model of that name with the same figures."""
    if model.name not in catalog.names(model.kind):
        return False
    known = catalog.load(model.name)
    return known is model or catalog.to_table(known) == catalog.to_table(model)
