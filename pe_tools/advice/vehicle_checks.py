"""Checks of a vehicle's mesh: its size, its orientation, its position on the ground."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pe_core.scene.body_shape import USUAL_SECOND_M, BodyShape, car_factor, fitting_units, is_usual
from pe_core.scene.orientation import LONGER, ON_GROUND, across, front_by_names, wheel_center
from pe_core.scene.vehicle import Vehicle
from pe_tools.advice.advice import metres

from .advice import Advice


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
        parts, names = np.asarray(vehicle.parts)[own_triangles], vehicle.part_names
        glass = tuple(vehicle.glass)
        return Vehicle(vehicle.triangles[own_triangles], parts, names, glass, vehicle.clearance)


SUNK_M, FLOATS_M = 0.15, 0.3
"""Allowed depth below and height above the ground [m]: tyres may sink in a little, and a body
without wheels is a little above the ground."""
OFF_AXIS_M, OFF_MIDDLE_M = 0.05, 1.0
"""Allowed distance of the vehicle's axis from the x axis, and of its middle from x = 0 [m]: the
origin may be at an axle, but a mirror image is on the vehicle only if the axis is y = 0."""
WIDE_M = 3.2
"""Greatest width of a road vehicle [m]: a lorry is 2.6 m wide, and each mirror adds 0.3 m."""
FLOOR_M = 6.0
"""A mesh wider than any vehicle and lower than this [m] may be a vehicle on a floor."""


WHEELS_BELOW = 0.1
"""The wheels are this far off the middle of the up axis, as a share of the side."""


def odd_vehicle(body: Bodywork) -> Iterator[Advice]:
    """Yield warnings about a vehicle's mesh.

    After a warning about its size no other check in metres is made.
    """
    for name in body.shape.rooms:  # such as the floor of a studio
        text = f"{name} is as large as a room: a floor or a studio that belongs to no vehicle?"
        yield Advice(None, "room", text, part=name)
    wrong_size = list(_size(body))
    yield from wrong_size
    if wrong_size:
        return  # the other checks compare lengths in metres
    for check in CHECKS:
        yield from check(body)


def _size(body: Bodywork) -> Iterator[Advice]:
    longest, second, _ = sorted(body.shape.size, reverse=True)
    if is_usual(longest, second):
        return
    x, y, z = body.shape.size
    found_text = f"{metres(x)} long, {metres(y)} wide and {metres(z)} high is no vehicle"
    if not longest:
        yield Advice(None, "size", "all of it is one point")
        return
    if fitting := fitting_units(longest, second):
        unit, factor = fitting[0]
        long, wide, high = (metres(factor * w) for w in (x, y, z))
        fix_text = f"if these are {unit}, scale by {factor:g}: {long} x {wide} x {high}"
    else:
        factor = car_factor(longest)
        fix_text = f"scaled by {factor:g} it would be as long as a car"
    if min(x, y) > USUAL_SECOND_M and z < FLOOR_M:
        fix_text = f"is a floor part of its mesh? Or, {fix_text}"
    yield Advice(None, "size", f"{found_text}; {fix_text}", fix="scale_vehicle", amount=(factor,))


def _wide(body: Bodywork) -> Iterator[Advice]:
    """Check for a mesh in other units: wider than any road vehicle, but flat like a car.

    On its side, a bus is as wide as it is high.
    """
    x, y, z = body.shape.size
    if WIDE_M < y < x and z < y and across(body.shape) != 2:
        factor = car_factor(x)
        text = (
            f"{metres(y)} wide is more than roads allow; scaled by {factor:g} it would be as long "
            "as a car"
        )
        yield Advice(None, "width", text, fix="scale_vehicle", amount=(factor,))


def _stands(body: Bodywork) -> Iterator[Advice]:
    """Check for a vehicle that stands on its tail or lies on its side."""
    x, y, z = body.shape.size
    if z > LONGER * max(x, y):
        text = f"taller ({metres(z)}) than long ({metres(max(x, y))}): does it stand on its tail?"
        yield Advice(None, "on_tail", text, fix="stand_vehicle", amount=_quarter_turn(body))
    elif across(body.shape) == 2:
        text = "its left half mirrors its right one from top to bottom: does it lie on its side?"
        yield Advice(None, "on_side", text, fix="stand_vehicle", amount=_quarter_turn(body))


def _quarter_turn(body: Bodywork) -> tuple[float, float, float]:
    """Return the turn about x and y [deg] that puts the wheels of a lying vehicle below its body.

    Without names of wheels the side that is at coordinate 0 is taken for them; without either the
    vehicle may then be on its roof.
    """
    (low, high), size = body.shape.bounds, body.shape.size
    wheels, mirrored = wheel_center(body.shape), across(body.shape)
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
            side = {180.0: "backwards (-x)", -90.0: "left (+y)", 90.0: "right (-y)"}[turn]
            text = f"it faces {side} by its parts' names; forward is +x: turn it by {turn:g} deg"
            yield Advice(None, "faces", text, fix="turn_vehicle", amount=(turn,))
    elif y > LONGER * x or (y > x / LONGER and across(body.shape) == 0):
        text = (
            f"it lies along y ({metres(y)} wide, {metres(x)} long) but forward is +x: turn it by "
            "90 or -90 deg; its shape does not tell which end is the front"
        )
        yield Advice(None, "faces", text, fix="turn_vehicle", amount=(90.0,))


def _on_its_roof(body: Bodywork) -> Iterator[Advice]:
    """Check for wheels, found by their names, above the middle of the vehicle."""
    wheels = wheel_center(body.shape)
    middle = float(body.shape.bounds[0][2] + body.shape.bounds[1][2]) / 2.0
    if wheels is not None and float(wheels[2]) > middle + 0.1 * body.shape.size[2]:
        text = "its wheels are on top: does it lie on its roof?"
        turn = (180.0, 0.0, 0.0)
        yield Advice(None, "on_roof", text, fix="stand_vehicle", amount=turn)


def _height(body: Bodywork) -> Iterator[Advice]:
    """Check for a vehicle that is sunk into the ground or floats above it."""
    bottom = float(body.shape.bounds[0][2])
    if bottom < -SUNK_M:
        text = f"it stands {metres(-bottom)} deep in the ground, z = 0"
    elif bottom > FLOATS_M:
        text = f"it floats {metres(bottom)} above the ground, z = 0"
    else:
        return
    yield Advice(None, "height", text, fix="move_vehicle", amount=(0.0, 0.0, -bottom))


def _not_centred(body: Bodywork) -> Iterator[Advice]:
    """Check that the vehicle's axis is the x axis, and its middle near the origin."""
    x, y = body.shape.middle
    if abs(y) > OFF_AXIS_M:
        side = "left" if y > 0.0 else "right"
        text = f"not centred: its axis is {metres(abs(y))} to the {side} of y = 0"
        text += "; mirror images of sensors would be off the vehicle"
    elif abs(x) > OFF_MIDDLE_M:
        text = f"not centred: its middle is {metres(abs(x))} off the origin, at x = {x:.1f} m"
    else:
        return
    yield Advice(None, "not_centred", text, fix="move_vehicle", amount=(0.0 - x, 0.0 - y, 0.0))


CHECKS: tuple[Callable[[Bodywork], Iterator[Advice]], ...] = (
    *(_wide, _stands, _on_its_roof, _faces, _height, _not_centred),
)
