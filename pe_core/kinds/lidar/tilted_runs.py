"""Which beams of a tilted LiDAR meet boxes: runs of channels, by azimuth, as of an upright one.

All channels of a fan at an azimuth lie in a plane through the LiDAR's axis. Along a beam of slope s
in it the inverse distance of a box's side is linear in s and in the azimuth's unit vector. The
beam meets the box where each near side's inverse is above each far side's; so each pair of sides
bounds s from below or above, by a number that again is linear in the azimuth's unit vector.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot, rotate
from ..placed_boxes import PlacedBoxes
from .from_above import IN_LINE_M
from .object_runs import RunBlock, TurnedFan

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

LEVEL = 1e-12
"""Sides whose inverse distances differ by less with the slope are told apart by azimuth alone."""
ALMOST_LEVEL = 1e-6
"""A box with sides between the two is unsure."""
NO_RISE = 1e-30
BETWEEN_M = 1e-3
"""Taken off a box's distance, against rounding."""


@dataclass(frozen=True, slots=True)
class PairBound:
    """Bounds of slopes through boxes by pairs of sides, (N,) each: ``a x + b y`` at azimuth (x, y).

    `below` is 0 where it is a lower bound and minus infinity where it is an upper one, `above` 0
    where it is an upper one and infinity else.
    """

    a: Floats
    b: Floats
    below: Floats
    above: Floats


@dataclass(frozen=True, slots=True)
class TiltedBoxes:
    """Boxes seen along a LiDAR's own axes: bounds of slopes, and what is not sure, (N,) each."""

    bounds: tuple[PairBound, ...]
    unsure: Flags
    outside: Flags
    near: Floats

    @classmethod
    def of(cls, boxes: PlacedBoxes, ground_from_sensor: Floats) -> TiltedBoxes:
        """Pair the near and far sides of boxes."""
        sides = _own_axes(boxes, ground_from_sensor)
        out = np.abs(boxes.offsets) - boxes.halves
        near, far = _near_sides(boxes, sides, out), _far_sides(boxes, sides, out)
        found, unsure = [], np.abs(out).min(axis=1) < IN_LINE_M
        for one in near:
            for other in far:
                x, y, rise = one - other
                unsure |= (np.abs(rise) > LEVEL) & (np.abs(rise) < ALMOST_LEVEL)
                rise = np.where(np.abs(rise) > LEVEL, rise, NO_RISE)
                lower = rise > 0.0
                limits = np.where(lower, 0.0, -np.inf), np.where(lower, np.inf, 0.0)
                found.append(PairBound(-x / rise, -y / rise, *limits))
        beyond = np.maximum(out, 0.0)
        distance = np.maximum(np.sqrt(dot(beyond, beyond)) - BETWEEN_M, BETWEEN_M)
        return cls(tuple(found), unsure, out.max(axis=1) > IN_LINE_M, 1.0 / distance)


def _own_axes(boxes: PlacedBoxes, ground_from_sensor: Floats) -> list[Floats]:
    """(3, N) each: the boxes' axes along the sensor's."""
    c, s = boxes.headings.T
    zero = np.zeros(len(c))
    axes = ((c, s, zero), (-s, c, zero), (zero, zero, zero + 1.0))
    return [rotate(ground_from_sensor.T, np.stack(w, axis=1)).T for w in axes]


def _near_sides(boxes: PlacedBoxes, axes: list[Floats], out: Floats) -> list[Floats]:
    """(3, N) each: inverse distances of the sides that the sensor sees; another for one unseen."""
    found = []
    with np.errstate(divide="ignore", invalid="ignore"):  # of sides that are not seen
        for k, axis in enumerate(axes):
            at = boxes.offsets[:, k]
            found.append(axis / (at - np.copysign(boxes.halves[:, k], at)))
    best = np.argmax(out, axis=1)  # a side that is seen
    seen = np.stack(found)[best, :, np.arange(len(best))].T
    return [np.where(out[:, k] > 0.0, own, seen) for k, own in enumerate(found)]


def _far_sides(boxes: PlacedBoxes, axes: list[Floats], out: Floats) -> list[Floats]:
    """(3, N) each: inverse distances of the sides that the sensor does not see."""
    found = []
    with np.errstate(divide="ignore", invalid="ignore"):  # of sides that are seen
        for k, axis in enumerate(axes):
            at = boxes.offsets[:, k]
            half = np.copysign(boxes.halves[:, k], at)
            back, front = axis / (at + half), axis / (at - half)
            found += [back, np.where(out[:, k] > 0.0, back, front)]
    return found


def tilted_runs(
    fan: TurnedFan, boxes: TiltedBoxes, spans: tuple[Floats, Floats], which: Ints
) -> Iterator[RunBlock]:
    """Yield the runs through boxes `which` between azimuths (N,) each, in the sensor's frame."""
    for some, column in fan.columns(spans[0][which], spans[1][which]):
        yield _through(fan, boxes, which[some], column)


def _through(
    fan: TurnedFan, boxes: TiltedBoxes, which: Ints, column: NDArray[np.int32]
) -> RunBlock:
    x, y = (np.take(w, column) for w in fan.rays)
    low, high = np.full(column.shape, -np.inf), np.full(column.shape, np.inf)
    for bound in boxes.bounds:
        value = bound.a[which] * x
        value += bound.b[which] * y
        np.maximum(low, value + bound.below[which], out=low)
        np.minimum(high, value + bound.above[which], out=high)
    missed = low >= high
    scale = fan.slopes.scale
    first, doubt = fan.slopes.below(low * scale)
    last, more = fan.slopes.below(high * scale)
    unsure = doubt | more
    unsure |= boxes.unsure[which]
    last[missed] = 0
    np.maximum(last, first, out=last)
    column[column >= fan.count] -= fan.count
    near = np.broadcast_to(boxes.near[which], column.shape)
    return RunBlock(which, column, first, last, near, near, unsure)
