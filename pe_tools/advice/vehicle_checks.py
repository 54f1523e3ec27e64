"""Checks of a vehicle's mesh: its size, its orientation, its position on the ground."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pe_core.scene.mesh import USUAL_SECOND_M, BodyShape, car_factor, fitting_units, is_usual
from pe_core.scene.vehicle import Vehicle
from pe_core.scene.vehicle_description import (
    LONGER,
    ON_GROUND,
    across,
    front_by_names,
    wheel_center,
)

from .advice import Advice

SUNK_M = 0.15
FLOATS_M = 0.3
"""Allowed depth below and height above the ground [m]: tyres may sink in a little, and a body
without wheels is a little above the ground."""
OFF_AXIS_M = 0.05
OFF_MIDDLE_M = 1.0
"""Allowed distance of the vehicle's axis from the x axis, and of its middle from x = 0 [m]: the
origin may be at an axle, but a mirror image is on the vehicle only if the axis is y = 0."""
WIDE_M = 3.2
"""Greatest width of a road vehicle [m]: a lorry is 2.6 m wide, and each mirror adds 0.3 m."""
FLOOR_M = 6.0  # A mesh wider than any vehicle and lower than this [m] may be a vehicle on a floor
WHEELS_BELOW = 0.1  # The wheels are this far off the middle of the up axis, as a share of the side


@dataclass(frozen=True)
class Bodywork:
    """Dimensions of a vehicle that the checks need; `vehicle` is the unchanged input."""

    vehicle: Vehicle

    @cached_property
    def shape(self) -> BodyShape:
        """Shape of the vehicle in the ground frame."""
        vehicle = self.vehicle
        return BodyShape(vehicle.triangles, vehicle.parts, tuple(vehicle.part_names))

    @cached_property
    def itself(self) -> Vehicle:
        """The vehicle without parts as large as a room."""
        own_triangles = self.shape.is_ours
        if own_triangles is None:
            return self.vehicle
        vehicle = self.vehicle
        parts = np.asarray(vehicle.parts)[own_triangles]
        names = vehicle.part_names
        glass = tuple(vehicle.glass)
        return Vehicle(
            vehicle.triangles[own_triangles], parts, names, glass, clearance=vehicle.clearance
        )


def odd_vehicle(body: Bodywork) -> Iterator[Advice]:
    """Yield warnings about a vehicle's mesh. After a warning about its size no other check in
    metres is made."""
    for name in body.shape.rooms:  # such as the floor of a studio
        yield Advice(None, "room", part=name)
    wrong_size = list(_size(body))
    yield from wrong_size
    if wrong_size:
        return  # the other checks compare lengths in metres
    for check in CHECKS:
        yield from check(body)


def _size(body: Bodywork) -> Iterator[Advice]:
    longest, second, third = sorted(body.shape.size, reverse=True)
    if is_usual(longest, second):
        return
    x, y, z = body.shape.size
    unit = None
    factor = car_factor(longest) if longest else 1.0
    if longest and (fitting := fitting_units(longest, second, third)):
        unit, factor = fitting[0]
    has_floor = min(x, y) > USUAL_SECOND_M and z < FLOOR_M
    values = {"size": [x, y, z], "factor": factor, "unit": unit, "has_floor": has_floor}
    fix, amount = ("scale_vehicle", (factor,)) if longest else (None, ())
    yield Advice(None, "size", values, fix=fix, amount=amount)


def _wide(body: Bodywork) -> Iterator[Advice]:
    """Check for a mesh in other units: wider than any road vehicle, but flat like a car. On its
    side, a bus is as wide as it is high."""
    x, y, z = body.shape.size
    if WIDE_M < y < x and z < y and across(body.shape) != 2:
        factor = car_factor(x)
        values = {"width": y, "factor": factor}
        yield Advice(None, "width", values, fix="scale_vehicle", amount=(factor,))


def _stands(body: Bodywork) -> Iterator[Advice]:
    """Check for a vehicle that stands on its tail or lies on its side."""
    x, y, z = body.shape.size
    if z > LONGER * max(x, y):
        values = {"height": z, "length": max(x, y)}
        yield Advice(None, "on_tail", values, fix="stand_vehicle", amount=_quarter_turn(body))
    elif across(body.shape) == 2:
        yield Advice(None, "on_side", fix="stand_vehicle", amount=_quarter_turn(body))


def _quarter_turn(body: Bodywork) -> tuple[float, float, float]:
    """Return the turn about x and y [deg] that puts the wheels of a lying vehicle below its body.
    Without names of wheels the side that is at coordinate 0 is taken for them; without either the
    vehicle may then be on its roof."""
    low, high = body.shape.bounds
    size = body.shape.size
    wheels = wheel_center(body.shape)
    mirrored = across(body.shape)
    offset = np.zeros(2)
    if wheels is not None:
        offset = (wheels[:2] - (low + high)[:2] / 2.0) / np.maximum(size[:2], 1)
    if np.abs(offset).max() > WHEELS_BELOW:
        up = int(np.argmax(np.abs(offset)))
    else:
        up = 1 - mirrored if mirrored in (0, 1) else int(np.argmin(size[:2]))
        offset[up] = -1.0 if abs(low[up]) <= ON_GROUND * size[up] else 1.0
    turn = -90.0 if offset[up] < 0.0 else 90.0
    return (0.0, turn, 0.0) if up == 0 else (-turn, 0.0, 0.0)


def _faces(body: Bodywork) -> Iterator[Advice]:
    """Check that forward is +x, by the names of parts, otherwise by the longest side."""
    x, y, z = body.shape.size
    if z > LONGER * max(x, y):
        return
    direction = front_by_names(body.shape)
    if direction is not None and direction[0] != 2:
        axis, sign = direction
        if (axis, sign) != (0, 1.0):
            turn = {(0, -1.0): 180.0, (1, 1.0): -90.0, (1, -1.0): 90.0}[axis, sign]
            values = {"turn": turn, "length": x, "width": y, "is_named": True}
            yield Advice(None, "faces", values, fix="turn_vehicle", amount=(turn,))
    elif y > LONGER * x or (y > x / LONGER and across(body.shape) == 0):
        values = {"turn": 90.0, "length": x, "width": y, "is_named": False}
        yield Advice(None, "faces", values, fix="turn_vehicle", amount=(90.0,))


def _on_its_roof(body: Bodywork) -> Iterator[Advice]:
    """Check for wheels, found by their names, above the middle of the vehicle."""
    wheels = wheel_center(body.shape)
    middle = float(body.shape.bounds[0][2] + body.shape.bounds[1][2]) / 2.0
    if wheels is not None and float(wheels[2]) > middle + 0.1 * body.shape.size[2]:
        turn = (180.0, 0.0, 0.0)
        yield Advice(None, "on_roof", fix="stand_vehicle", amount=turn)


def _height(body: Bodywork) -> Iterator[Advice]:
    """Check for a vehicle that is sunk into the ground or floats above it."""
    bottom = float(body.shape.bounds[0][2])
    if not -SUNK_M <= bottom <= FLOATS_M:
        values = {"bottom": bottom}
        amount = (0.0, 0.0, -bottom)
        yield Advice(None, "height", values, fix="move_vehicle", amount=amount)


def _not_centred(body: Bodywork) -> Iterator[Advice]:
    """Check that the vehicle's axis is the x axis, and its middle near the origin."""
    x, y = body.shape.middle
    if abs(y) > OFF_AXIS_M or abs(x) > OFF_MIDDLE_M:
        axis, off = ("y", y) if abs(y) > OFF_AXIS_M else ("x", x)
        amount = (0.0 - x, 0.0 - y, 0.0)
        values = {"axis": axis, "off": off}
        yield Advice(None, "not_centred", values, fix="move_vehicle", amount=amount)


CHECKS: tuple[Callable[[Bodywork], Iterator[Advice]], ...] = (
    _wide,
    _stands,
    _on_its_roof,
    _faces,
    _height,
    _not_centred,
)
