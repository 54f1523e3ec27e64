"""Query one location: which sensors see it, how well, and what hides it from the others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, plural
from pe_core.base.values import listed, rounded, vector
from pe_core.geometry.grids import PerceptionSpace
from pe_core.geometry.poses import METRES
from pe_core.metric import average_precision
from pe_core.metric.entropy import ap_of_entropy
from pe_core.metric.fusion import Fusion
from pe_core.prior.prior import ClassDensity, Prior
from pe_core.scene.rig import Rig, Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.scenarios import fused_early
from pe_core.sensors import PerceptionModel, kind_named, kind_of, measure
from pe_tools.advice.advice import times

SEES, HIDDEN = "sees", "occluded"
"""Reason of a sensor that measures the location, and of one whose view of it the vehicle blocks.
The other reasons are those of the sensor's kind (`Kind.missed`)."""
WAYS = (("ahead", "behind"), ("left", "right"), ("up", "down"))
"""Names of the positive and the negative direction of each axis."""


@dataclass(frozen=True, slots=True)
class SensorAtPlace:
    """Measurement of one location by one sensor.

    Attributes
    ----------
    name, kind : str
    m : float
        Number of beams or pixels on the voxel (`sensors.measure`).
    unhidden : float
        The same number if the vehicle hid nothing.
    ap : float
        Average precision of m by the curve of its kind (eq. 4).
    occluded_by : str or None
        Part of the vehicle that blocks most of the rays, if the vehicle hides the location.
    reason : {"sees", "occluded", "out of view", "out of range", "between beams"}
        Kinds other than LiDAR and camera may have further reasons.
    """

    name: str
    kind: str
    m: float
    unhidden: float
    ap: float
    occluded_by: str | None
    reason: str


@dataclass(frozen=True, slots=True)
class AskedPlace:
    """Result of a location query: one voxel, and what each sensor measures there.

    Attributes
    ----------
    center : (3,) float
        Its centre [m].
    entropy : float
        H, eq. 8 [nats].
    ap : float
        Average precision of all sensors fused, 0 to 1.
    seen : bool
        Whether any sensor sees the voxel.
    density : float
        Prior density of objects, relative to the mean over the space; 0 in the vehicle.
    in_vehicle : bool
        Whether the voxel is in the vehicle's own volume, which is not scored.
    sensors : tuple of SensorAtPlace
        In the rig's order.
    """

    center: tuple[float, float, float]
    entropy: float
    ap: float
    seen: bool
    density: float
    in_vehicle: bool
    sensors: tuple[SensorAtPlace, ...]

    @property
    def text(self) -> tuple[str, ...]:
        """Lines of text: the location, the expected objects, then one line for each sensor."""
        if self.in_vehicle:
            return (_headline(self),)
        return (_headline(self), _expectation(self), *(_sensor_line(s) for s in self.sensors))

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain JSON data, with its text."""
        return {**asdict(self), "center": list(self.center), "text": list(self.text)}


def ask_place(
    rig: Rig,
    space: PerceptionSpace,
    prior: Prior,
    vehicle: Vehicle | None,
    point: Sequence[float],
    model: PerceptionModel | None = None,
    *,
    densities: Sequence[ClassDensity] | None = None,
) -> AskedPlace:
    """Evaluate a rig at the voxel that contains a point.

    Parameters
    ----------
    rig : Rig
    space : PerceptionSpace
    prior : Prior
    vehicle : Vehicle, optional
    point : (2,) or (3,) float
        x, y and optionally z in the ground frame [m]; z is 0 if it is missing or None.
    model : PerceptionModel, optional
        AP curves and fusion rule; the paper's by default.
    densities : sequence of ClassDensity, optional
        ``prior.densities(space)`` if the caller has it already: computing it takes longer than the
        rest of the query.

    Returns
    -------
    AskedPlace

    Raises
    ------
    InputError
        The point is not two or three numbers, or is outside the space.
    """
    model, side = model or PerceptionModel(), space.interval
    index = _voxel(space, _checked(point))
    center = space.center_of(np.array([index]))
    sensors = tuple(_at_place(s, center, side, vehicle, model) for s in rig)
    measured = {s.name: np.array([s.m]) for s in sensors}
    entropies, seen = Fusion(model).entropies(fused_early(rig, measured, list(measured)))
    inside = vehicle is not None and bool(center[0, 2] < _top(vehicle, space, center[0]))
    x, y, z = (float(v) for v in center[0])
    return AskedPlace(
        center=(x, y, z),
        entropy=rounded(entropies[0]),
        ap=float(ap_of_entropy(entropies[0])),
        seen=bool(seen[0]),
        density=0.0 if inside else _density(densities or prior.densities(space), space, index),
        in_vehicle=inside,
        sensors=sensors,
    )


def _checked(point: Sequence[float]) -> tuple[float, float, float]:
    values = listed(point, 3) or []
    if len(values) == 2 or values[2:] == [None]:
        values = [*values[:2], 0.0]
    x, y, z = vector("place", "point", values, 3, METRES)
    return x, y, z


def _voxel(space: PerceptionSpace, point: tuple[float, float, float]) -> tuple[int, int, int]:
    """Return the indices of the voxel that contains a point.

    A point on an upper face of the space belongs to the last voxel.
    """
    bounds = (space.x, space.y, space.z)
    for axis, value, (low, high) in zip("xyz", point, bounds, strict=True):
        if not low <= value <= high:
            expected = f"{low:g} to {high:g} m, inside the space"
            raise InputError("place", axis, expected, f"{value:g}")
    steps = ((v - low) / space.interval for v, (low, _) in zip(point, bounds, strict=True))
    i, j, k = (min(math.floor(s), n - 1) for s, n in zip(steps, space.shape, strict=True))
    return i, j, k


def _at_place(
    sensor: Sensor, center: Floats, side: float, vehicle: Vehicle | None, model: PerceptionModel
) -> SensorAtPlace:
    unhidden = float(measure(sensor, center, side)[0])
    m = float(measure(sensor, center, side, vehicle)[0]) if unhidden and vehicle else unhidden
    part, reason = None, SEES
    if not unhidden:
        reason = kind_of(sensor).missed(sensor, center[0], side)
    elif not m and vehicle is not None:
        part, reason = _part_in_the_way(sensor, center[0], side, vehicle), HIDDEN
    ap = float(average_precision(m, sensor.curve or model.curve(sensor.kind)))
    return SensorAtPlace(sensor.name, sensor.kind, m, unhidden, ap, part, reason)


def _part_in_the_way(sensor: Sensor, center: Floats, side: float, vehicle: Vehicle) -> str | None:
    """Return the part that blocks most of a sensor's rays to a cube; None if no part does."""
    directions, far = kind_of(sensor).rays_to(sensor, center, side)
    glass = sensor.model.sees_through_glass
    hits = vehicle.first_hit(sensor.pose.position, directions, glass)
    stopped = hits.face[hits.distance < far]
    if not len(stopped):
        return None
    counts = np.bincount(np.asarray(vehicle.parts)[stopped])
    return str(vehicle.part_names[int(np.argmax(counts))])


def _top(vehicle: Vehicle, space: PerceptionSpace, center: Floats) -> float:
    """Return the height of the vehicle's top over one column of a space [m]."""
    half = space.interval / 2.0
    x, y = ((w - half, w + half) for w in center[:2].tolist())
    return float(vehicle.top(PerceptionSpace(x, y, space.z, space.interval))[0, 0])


def _density(
    densities: Sequence[ClassDensity], space: PerceptionSpace, index: tuple[int, int, int]
) -> float:
    """Return the prior of a voxel, relative to the mean over the space."""
    i, j, k = index
    density = sum(float(d.ground[i, j] * d.profile[k]) for d in densities)
    return density * space.size


def _way(distance: float, ways: tuple[str, str]) -> str:
    """Return a coordinate with its direction: "7.95 m behind"."""
    return f"{abs(distance):.2f} m {ways[distance < 0.0]}"


def _headline(place: AskedPlace) -> str:
    where = ", ".join(map(_way, place.center, WAYS))
    if place.in_vehicle:
        return f"{where}: inside the vehicle, which does not count"
    if not place.seen:
        return f"{where}: seen by no sensor; H {place.entropy:.2f} nats"
    seeing = sum(s.m > 0.0 for s in place.sensors)
    who = f"{seeing} of {plural(len(place.sensors), 'sensor')}"
    return f"{where}: seen by {who}; together AP {place.ap:.2f}, H {place.entropy:.2f} nats"


def _expectation(place: AskedPlace) -> str:
    if not place.density:
        return "nothing is expected here"
    how = times(place.density)
    return f"objects are {'' if how == times(1.0) else how + ' '}as likely here as on average"


def _sensor_line(sensor: SensorAtPlace) -> str:
    unit = kind_named(sensor.kind, sensor.name).unit
    if sensor.reason == HIDDEN:
        return f"{sensor.name}: occluded by {sensor.occluded_by or 'the vehicle'}"
    if sensor.reason != SEES:
        return f"{sensor.name}: {sensor.reason}"
    count = plural(sensor.m, unit.removesuffix("s"))
    lost = sensor.unhidden - sensor.m
    hidden = f" ({lost:.0f} more occluded)" if lost > 0.0 else ""
    return f"{sensor.name}: sees it with {count}{hidden}, AP {sensor.ap:.2f}"
