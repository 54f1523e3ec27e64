"""What is odd about the vehicle: its size, its place, which way it faces."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..scene.facing import LONGER, across, front_by_names, wheel_center
from ..scene.vehicle_size import USUAL_SECOND_M, car_factor, fitting_units, is_usual
from .advice import Advice
from .bodywork import Bodywork
from .figures import metres

SUNK_M, FLOATS_M = 0.15, 0.3
"""Tyres may sink a little, and a body without wheels hangs a little over the ground."""
OFF_ORIGIN_M = 1.0
WIDE_M = 3.2
"""A lorry is 2.6 m wide, and mirrors stand out by 0.3 m on either side."""
FLOOR_M = 6.0
"""What is wider than any vehicle and lower than this may be a vehicle on a floor."""


def odd_vehicle(body: Bodywork) -> Iterator[Advice]:
    """Yield advice on a vehicle."""
    yield from map(_room, body.rooms)
    wrong_size = list(_size(body))
    yield from wrong_size
    if wrong_size:
        return  # nothing else can be told of it in metres
    for check in CHECKS:
        yield from check(body)


def _room(name: str) -> Advice:
    text = f"{name} is as large as a room: a floor or a studio that belongs to no vehicle?"
    return Advice(None, "room", text, part=name)


def _size(body: Bodywork) -> Iterator[Advice]:
    longest, second, _ = sorted(body.size, reverse=True)
    if is_usual(longest, second):
        return
    x, y, z = body.size
    found = f"{metres(x)} long, {metres(y)} wide and {metres(z)} high is no vehicle"
    if not longest:
        yield Advice(None, "size", "all of it is one point")
        return
    if fitting := fitting_units(longest, second):
        unit, factor = fitting[0]
        long, wide, high = (metres(factor * w) for w in (x, y, z))
        would = f"if these are {unit}, scale by {factor:g}: {long} x {wide} x {high}"
    else:
        factor = car_factor(longest)
        would = f"scaled by {factor:g} it would be as long as a car"
    if min(x, y) > USUAL_SECOND_M and z < FLOOR_M:
        would = f"is a floor part of its mesh? Or, {would}"
    yield Advice(None, "size", f"{found}; {would}", fix="scale_vehicle", amount=(factor,))


def _wide(body: Bodywork) -> Iterator[Advice]:
    """As wide as no vehicle on a road, and flat as a car: in units of its own."""
    x, y, z = body.size
    if WIDE_M < y < x and z < y:
        factor = car_factor(x)
        text = (
            f"{metres(y)} wide is more than roads allow; scaled by {factor:g} it would be as long "
            "as a car"
        )
        yield Advice(None, "width", text, fix="scale_vehicle", amount=(factor,))


def _stands(body: Bodywork) -> Iterator[Advice]:
    """On its tail, or on its side."""
    x, y, z = body.size
    if z > LONGER * max(x, y):
        text = f"taller ({metres(z)}) than long ({metres(max(x, y))}): does it stand on its tail?"
        yield Advice(None, "on_tail", text)
    elif across(body.shape) == 2:
        text = "its left half mirrors its right one from top to bottom: does it lie on its side?"
        yield Advice(None, "on_side", text)


def _faces(body: Bodywork) -> Iterator[Advice]:
    """Forward is +x: told from the names of parts, else from the longest side."""
    x, y, z = body.size
    if z > LONGER * max(x, y):
        return
    ahead = front_by_names(body.shape)
    if ahead is not None and ahead[0] != 2:
        axis, sign = ahead
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
    """Wheels, by their names, above the middle."""
    wheels = wheel_center(body.shape)
    middle = float(body.low[2] + body.high[2]) / 2.0
    if wheels is not None and float(wheels[2]) > middle + 0.1 * body.size[2]:
        yield Advice(None, "on_roof", "its wheels are on top: does it lie on its roof?")


def _height(body: Bodywork) -> Iterator[Advice]:
    """Sunk into the ground, or above it."""
    bottom = float(body.low[2])
    if bottom < -SUNK_M:
        text = f"it stands {metres(-bottom)} deep in the ground, z = 0"
    elif bottom > FLOATS_M:
        text = f"it floats {metres(bottom)} above the ground, z = 0"
    else:
        return
    yield Advice(None, "height", text, fix="move_vehicle", amount=(0.0, 0.0, -bottom))


def _off_origin(body: Bodywork) -> Iterator[Advice]:
    """The origin belongs on the ground under the vehicle's centre."""
    x, y, _ = ((body.low + body.high) / 2.0).tolist()
    away = float(np.hypot(x, y))
    if away > OFF_ORIGIN_M:
        text = (
            f"its centre is {metres(away)} off the origin, at ({x:.1f}, {y:.1f}); objects are "
            "expected round the origin"
        )
        yield Advice(None, "off_origin", text, fix="move_vehicle", amount=(-x, -y, 0.0))


CHECKS: tuple[Callable[[Bodywork], Iterator[Advice]], ...] = (
    *(_wide, _stands, _on_its_roof, _faces, _height, _off_origin),
)
