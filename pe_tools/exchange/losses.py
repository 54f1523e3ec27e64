"""Message about the properties of a rig that a format cannot express.

Each format declares the set of properties that it holds. Losses of lenses (`lens_pictures`) and of
uneven LiDAR channels (`portable`) have messages of their own.
"""

from __future__ import annotations

from collections.abc import Iterator

from pe_core import catalog
from pe_core.scene.rig import Rig, Sensor

from .portable import PortableSensor
from .portable_kinds import portable_sensors

MODEL = "model"
"""The model name; properties of a catalogued model are then not lost."""
BEAMS = "beams"
"""A LiDAR's channels, azimuths and range."""
MIN_RANGE, MAX_RANGE = "minimum range", "maximum range"
PARAMETERS = "parameters"
"""The table of a model that has neither lens nor beams."""
FUSION, CURVE = "fusion group", "AP curve"
EVERYTHING = (BEAMS, PARAMETERS, MIN_RANGE, MAX_RANGE, FUSION, CURVE)


def lost_line(rig: Rig, title: str, holds: frozenset[str]) -> list[str]:
    """Return one message with the properties of a rig that are not in `holds`; [] if none."""
    pairs = zip(rig, portable_sensors(rig), strict=True)
    lost = {sensor.name: set(_owned(sensor, portable, holds)) - holds for sensor, portable in pairs}
    parts = []
    for feature in EVERYTHING:
        names = [name for name, features in lost.items() if feature in features]
        if names:
            parts.append(f"{feature} of {', '.join(names)}")
    return [f"left out of {title}: {'; '.join(parts)}"] if parts else []


def _owned(sensor: Sensor, portable: PortableSensor, holds: frozenset[str]) -> Iterator[str]:
    """Yield the properties of a sensor that differ from the defaults of its model."""
    if sensor.fusion is not None:
        yield FUSION
    if sensor.curve is not None:
        yield CURVE
    model = sensor.model
    if MODEL in holds and model.name in catalog.names(model.kind):
        known = catalog.load(model.name)
        if known is model or catalog.to_table(known) == catalog.to_table(model):
            return
    if portable.scan is not None:
        yield BEAMS
        if BEAMS not in holds:
            return  # with its ranges
    if portable.parameters:
        yield PARAMETERS
        return  # with its ranges
    if portable.min_range is not None:
        yield MIN_RANGE
    if portable.max_range is not None and portable.scan is None:
        yield MAX_RANGE
