"""Query one location: which sensors see it, how well, and what hides it from the others."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.codec import Recorded
from pe_core.base.errors import InputError, plural
from pe_core.base.values import listed, rounded, vector
from pe_core.geometry.grids import PerceptionSpace
from pe_core.geometry.poses import METRES
from pe_core.metric import average_precision
from pe_core.metric.entropy import ap_of_entropy, ranged
from pe_core.metric.fusion import Fusion
from pe_core.prior.prior import Prior
from pe_core.scene.rig import Rig, Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.requirements import part_in_the_way
from pe_core.scoring.rig_batch import fused_early
from pe_core.sensors import PerceptionModel, kind_named, kind_of, measure
from pe_tools.wording import times

SEES = "sees"
HIDDEN = "occluded"
"""Reason of a sensor that measures the location, and of one whose view of it the vehicle blocks.
The other reasons are those of the sensor's kind (`Kind.missed`)."""
WAYS = (("ahead", "behind"), ("left", "right"), ("up", "down"))
"""Names of the positive and the negative direction of each axis."""


@dataclass(frozen=True, slots=True)
class SensorAtPlace:
    """Measurement of one location by one sensor. `m` is the number of beams or pixels on the voxel
    (`sensors.measure`), `unhidden` that number if the vehicle hid nothing, `ap` the average
    precision of m (eq. 4). `occluded_by` is the part of the vehicle that blocks most of the rays,
    if it hides the location. `reason` is "sees", "occluded", or one of the kind: "out of view",
    "out of range", "between beams", ..."""

    name: str
    kind: str
    m: float
    unhidden: float
    ap: float
    occluded_by: str | None
    reason: str


@dataclass(frozen=True, slots=True)
class AskedPlace(Recorded):
    """Result of a location query: one voxel, and what each sensor measures there. `center` is its
    centre [m], `entropy` H (eq. 8) [nats], `ap` the average precision of all sensors fused, 0 to 1;
    `seen` is whether any sensor sees it. `density` is the prior density of objects, relative to the
    mean over the space; 0 in the vehicle. `in_vehicle` is whether it is in the vehicle's own
    volume, which is not scored. `sensors` are in the rig's order."""

    derived = ("text",)
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
        how = "" if times(self.density) == times(1.0) else f"{times(self.density)} "
        expected = f"objects are {how}as likely here as on average"
        expected = expected if self.density else "nothing is expected here"
        return (_headline(self), expected, *map(_sensor_line, self.sensors))


def ask_place(
    rig: Rig,
    space: PerceptionSpace,
    prior: Prior,
    vehicle: Vehicle | None,
    point: Sequence[float],
    model: PerceptionModel | None = None,
) -> AskedPlace:
    """Evaluate a rig at the voxel that contains a point. `point` (2,): ground frame [m]; z is 0 if
    it is missing or None. One outside the space raises `InputError`. `model`: AP curves and fusion
    rule; the paper's by default."""
    model = model or PerceptionModel()
    side = space.interval
    values = listed(point, 3) or []
    if len(values) == 2 or values[2:] == [None]:
        values = [*values[:2], 0.0]
    index = _voxel(space, vector("place", "point", values, count=3, rule=METRES))
    center = space.center_of(np.array([index]))
    sensors = tuple(_at_place(s, center, side, vehicle, model=model) for s in rig)
    measured = {s.name: np.array([s.m]) for s in sensors}
    fusion = Fusion(model)
    distance = np.hypot(*center[:, :2].T)
    fused = fusion.ranged(fused_early(rig, measured, list(measured)), distance)
    entropies, seen = fusion.entropies(fused)
    x, y, z = (float(v) for v in center[0])
    inside = False
    if vehicle is not None:  # below its top over the column of the voxel
        over_x, over_y = ((w - side / 2.0, w + side / 2.0) for w in (x, y))
        inside = z < float(vehicle.top(PerceptionSpace(over_x, over_y, space.z, side))[0, 0])
    densities = [] if inside else prior.densities(space)
    i, j, k = index
    density = sum((float(d.ground[i, j] * d.profile[k]) for d in densities), 0.0) * space.size
    return AskedPlace(
        center=(x, y, z),
        entropy=rounded(entropies[0]),
        ap=float(ap_of_entropy(entropies[0])),
        seen=bool(seen[0]),
        density=density,
        in_vehicle=inside,
        sensors=sensors,
    )


def _voxel(space: PerceptionSpace, point: Sequence[float]) -> tuple[int, int, int]:
    """Return the indices of the voxel that contains a point. A point on an upper face of the space
    belongs to the last voxel."""
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
    kind = kind_of(sensor)
    part = None
    reason = SEES
    unhidden = float(measure(sensor, center, side)[0])
    m = float(measure(sensor, center, side, vehicle)[0]) if unhidden and vehicle else unhidden
    if not unhidden:
        reason = kind.missed(sensor, center[0], side)
    elif not m and vehicle is not None:
        rays = kind.rays_to(sensor, center[0], side)
        part = part_in_the_way(sensor, vehicle, *rays)
        reason = HIDDEN
    curve = sensor.curve or model.curve(sensor.kind)
    ap = float(average_precision(ranged(m, curve, np.hypot(*center[0, :2])), curve))
    return SensorAtPlace(
        sensor.name, sensor.kind, m, unhidden, ap=ap, occluded_by=part, reason=reason
    )


def _headline(place: AskedPlace) -> str:
    pairs = zip(place.center, WAYS, strict=True)
    where = ", ".join(f"{abs(value):.2f} m {ways[value < 0.0]}" for value, ways in pairs)
    if place.in_vehicle:
        return f"{where}: inside the vehicle, which does not count"
    if not place.seen:
        return f"{where}: seen by no sensor; H {place.entropy:.2f} nats"
    seeing = sum(s.m > 0.0 for s in place.sensors)
    who = f"{seeing} of {plural(len(place.sensors), 'sensor')}"
    return f"{where}: seen by {who}; together AP {place.ap:.2f}, H {place.entropy:.2f} nats"


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
