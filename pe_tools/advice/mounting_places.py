"""Labels of sensors by where they are mounted: "front", "left mirror", "rear"."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.scene.rig import Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.scene.vehicle_description import is_called
from pe_core.sensors import KINDS

MIRRORS, SKIPPED = ("mirror",), ("-",)
"""Beginnings of words in the names of parts: those of mirrors, and of none."""
NEAR_MIRROR_M, UNDER_ROOF_M = 0.25, 0.2
"""A sensor this near to a mirror is at it; one this little below the vehicle's top on the roof."""
END_SHARE, MIDDLE_SHARE, SIDE_SHARE = 0.15, 0.35, 0.7
"""Shares: of the length at either end that is front or rear; of half the width, from the middle,
within which no side is named, and beyond which a sensor is at a side."""
COPY = r"(?:\.\d{3,})?"


def plain_name(name: str) -> str | None:
    """Return the kind of which a sensor has its name, as "Camera" of "Camera.001"; else None."""
    for kind in KINDS.values():
        if re.fullmatch(re.escape(kind.label) + COPY, name):
            return kind.label
    return None


def sensor_labels(sensors: Iterable[Sensor], vehicle: Vehicle | None) -> dict[str, str]:
    """Return a label of each sensor, by name: its place, where its name only says its kind.

    Several at one place are told apart by their kind, then by a number.
    """
    sensors = list(sensors)
    if vehicle is None:
        return {sensor.name: sensor.name for sensor in sensors}
    mirrors = []  # lowest and highest corner of each part that is named so
    for number, name in enumerate(vehicle.part_names):
        points = vehicle.triangles[vehicle.parts == number].reshape(-1, 3)
        if is_called(name, MIRRORS, SKIPPED) and len(points):
            mirrors.append((points.min(axis=0), points.max(axis=0)))
    places, kinds = {}, {}
    for sensor in sensors:
        kind = plain_name(sensor.name)
        if kind is not None:
            kinds[sensor.name] = kind
            places[sensor.name] = place_name(sensor.pose.position, vehicle.bounds, mirrors)
    shared = Counter(places.values())
    labels = {
        name: place if shared[place] == 1 else f"{place} {kinds[name]}"
        for name, place in places.items()
    }
    numbers: Counter[str] = Counter()
    alike = Counter(labels.values())
    for name, label in labels.items():
        numbers[label] += 1
        labels[name] = label if alike[label] == 1 else f"{label} {numbers[label]}"
    return {sensor.name: labels.get(sensor.name, sensor.name) for sensor in sensors}


def place_name(
    position: tuple[float, float, float],
    bounds: tuple[Floats, Floats],
    mirrors: Sequence[tuple[Floats, Floats]] = (),
) -> str:
    """Return where on a vehicle a position [m] is; `bounds` are the lowest and highest corner (3,)
    of the vehicle, `mirrors` those of its mirrors."""
    at, (low, high) = np.array(position), bounds
    side = "left" if at[1] > (low[1] + high[1]) / 2.0 else "right"
    if any((at > a - NEAR_MIRROR_M).all() and (at < b + NEAR_MIRROR_M).all() for a, b in mirrors):
        return f"{side} mirror"
    along = (at[0] - low[0]) / (high[0] - low[0])
    aside = abs(at[1] - (low[1] + high[1]) / 2.0) / max((high[1] - low[1]) / 2.0, 1e-9)
    end = "front" if along > 1.0 - END_SHARE else "rear" if along < END_SHARE else ""
    beside = side if aside > MIDDLE_SHARE else ""
    if at[2] > high[2] - UNDER_ROOF_M:
        return " ".join(word for word in ("roof", end, beside) if word)
    if end:
        return f"{end} {beside}".strip()
    return f"{side} side" if aside > SIDE_SHARE else "cabin"
