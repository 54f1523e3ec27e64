"""What is odd about the vehicle: its size, its place, which way it faces."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from .advice import Advice
from .bodywork import Bodywork
from .figures import metres

Floats = NDArray[np.float64]

LONGEST_M, SHORTEST_M, SECOND_M = 30.0, 0.4, 10.0
"""No vehicle's longest side is beyond these, nor its second longest beyond the last."""
UNITS = {"inches": 0.0254, "centimetres": 0.01, "millimetres": 0.001, "feet": 0.3048}
LARGER_UNITS = {"units of 100 m": 100.0, "kilometres": 1000.0}
CAR_M = 4.5
"""Length of a usual car: what a size is compared with."""
LONGER = 1.15
"""One side is longer than another from this ratio on."""
SUNK_M, FLOATS_M = 0.15, 0.3
"""Tyres may sink a little, and a body without wheels hangs a little over the ground."""
OFF_ORIGIN_M = 1.0
EVEN, UNEVEN = 0.01, 5.0
"""`Bodywork.lopsided`: from side to side less than the first, along the other two axes more than
one and a half times that, and so many times as much as from side to side."""
FRONT = ("hood", "bonnet", "headl", "windshield", "windscreen", "grill", "front")
REAR = ("tail", "trunk", "boot", "rear", "back")
WHEELS, NO_WHEELS = ("wheel", "tire", "tyre"), ("steering", "spare", "arch", "well")
"""What a word in a part's name begins with when it is at the front, at the rear; when it is a
wheel, and when it only sounds like one."""
WORD = re.compile("[A-Z]*[a-z]+|[A-Z]+")
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
    if _fits(longest, second, 1.0):
        return
    x, y, z = body.size
    found = f"{metres(x)} long, {metres(y)} wide and {metres(z)} high is no vehicle"
    if not longest:
        yield Advice(None, "size", "all of it is one point")
        return
    units = UNITS if longest > SHORTEST_M else LARGER_UNITS
    fitting = {n: f for n, f in units.items() if _fits(longest, second, f)}
    if fitting:
        unit = min(fitting, key=lambda n: abs(np.log(fitting[n] * longest / CAR_M)))
        factor = fitting[unit]
        long, wide, high = (metres(factor * w) for w in (x, y, z))
        would = f"if these are {unit}, scale by {factor:g}: {long} x {wide} x {high}"
    else:
        factor = float(f"{CAR_M / longest:.2g}")
        would = f"scaled by {factor:g} it would be as long as a car"
    if min(x, y) > SECOND_M and z < FLOOR_M:
        would = f"is a floor part of its mesh? Or, {would}"
    yield Advice(None, "size", f"{found}; {would}", fix="scale_vehicle", amount=(factor,))


def _fits(longest: float, second: float, factor: float) -> bool:
    return SHORTEST_M <= factor * longest <= LONGEST_M and factor * second <= SECOND_M


def _stands(body: Bodywork) -> Iterator[Advice]:
    """On its tail, or on its side."""
    x, y, z = body.size
    if z > LONGER * max(x, y):
        text = f"taller ({metres(z)}) than long ({metres(max(x, y))}): does it stand on its tail?"
        yield Advice(None, "on_tail", text)
    elif _across(body) == 2:
        text = "its left half mirrors its right one from top to bottom: does it lie on its side?"
        yield Advice(None, "on_side", text)


def _faces(body: Bodywork) -> Iterator[Advice]:
    """Forward is +x: told from the names of parts, else from the longest side."""
    x, y, z = body.size
    if z > LONGER * max(x, y):
        return
    ahead = _front_by_names(body)
    if ahead is not None:
        axis, sign = ahead
        if (axis, sign) != (0, 1.0):
            turn = {(0, -1.0): 180.0, (1, 1.0): -90.0, (1, -1.0): 90.0}[axis, sign]
            side = {180.0: "backwards (-x)", -90.0: "left (+y)", 90.0: "right (-y)"}[turn]
            text = f"it faces {side} by its parts' names; forward is +x: turn it by {turn:g} deg"
            yield Advice(None, "faces", text, fix="turn_vehicle", amount=(turn,))
    elif y > LONGER * x or (y > x / LONGER and _across(body) == 0):
        text = (
            f"it lies along y ({metres(y)} wide, {metres(x)} long) but forward is +x: turn it by "
            "90 or -90 deg; its shape does not tell which end is the front"
        )
        yield Advice(None, "faces", text, fix="turn_vehicle", amount=(90.0,))


def _on_its_roof(body: Bodywork) -> Iterator[Advice]:
    """Wheels, by their names, above the middle."""
    wheels = _named(body, WHEELS, NO_WHEELS)
    middle = float(body.low[2] + body.high[2]) / 2.0
    if wheels and float(np.mean(wheels, axis=0)[2]) > middle + 0.1 * body.size[2]:
        yield Advice(None, "on_roof", "its wheels are on top: does it lie on its roof?")


def _front_by_names(body: Bodywork) -> tuple[int, float] | None:
    """Tell the axis (0 or 1) and the sign of where the parts of the front are."""
    front, rear = _named(body, FRONT, REAR), _named(body, REAR, FRONT)
    if not front or not rear:
        return None
    way = np.mean(front, axis=0) - np.mean(rear, axis=0)
    axis = int(np.argmax(np.abs(way[:2])))
    if abs(way[axis]) < 0.25 * body.size[axis]:
        return None
    return axis, float(np.sign(way[axis]))


def _named(body: Bodywork, begin: tuple[str, ...], but: tuple[str, ...]) -> list[Floats]:
    """Return the middles of parts whose names have a word that begins so, and none as in `but`."""
    found = []
    for name, center in body.part_centers().items():
        words = [word.lower() for word in WORD.findall(name)]
        if any(w.startswith(begin) for w in words) and not any(w.startswith(but) for w in words):
            found.append(center)
    return found


def _across(body: Bodywork) -> int | None:
    """Axis along which the body is its own mirror image, where it is so along one alone."""
    axis = int(np.argmin(body.lopsided))
    others = [v for k, v in enumerate(body.lopsided) if k != axis]
    least = body.lopsided[axis]
    clear = least < EVEN and min(others) > max(UNEVEN * least, 1.5 * EVEN)
    return axis if clear else None


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
    *(_stands, _on_its_roof, _faces, _height, _off_origin),
)
