"""Objects set in scenes so that no two of a scene overlap, and none the vehicle."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..scene.vehicle import Vehicle
from .boxes import BoxSource, StandingBoxes
from .footprints import GroundRectangles, nowhere, overlap, rectangles

Ints = NDArray[np.int64]

ATTEMPTS = 200
"""An object that finds no room in so many places finds none."""
A_CAR_M = (4.6, 1.9)
"""Where there is no mesh of the vehicle, the room of a car is left free."""


def kept_free(vehicle: Vehicle | None) -> GroundRectangles:
    """Return the rectangle (1,) round the vehicle, seen from above."""
    if vehicle is None:
        (length, width), x, y = A_CAR_M, 0.0, 0.0
    else:
        low, high = vehicle.bounds
        (length, width), (x, y) = (high - low)[:2].tolist(), ((high + low) / 2.0)[:2].tolist()
    return rectangles(np.array([[x, y]]), np.array([[length, width, 0.0]]), np.zeros(1))


def placed(
    sources: Sequence[BoxSource],
    labels: Ints,
    scenes: Ints,
    free: GroundRectangles,
    ground_m2: float,
    names: Sequence[str],
) -> StandingBoxes:
    """Set objects in scenes, one after the other in each, each drawn anew until it has room.

    Parameters
    ----------
    sources : sequence of BoxSource
        Of every class: their boxes, one class after the other, are the N objects.
    labels, scenes : (N,) int
        Class and scene of each. In a scene they are set in the order in which they stand here.
    free : GroundRectangles
        What is to stay free.
    ground_m2 : float
        How much ground there is.
    names : sequence of str
        What classes are called.

    Raises
    ------
    InputError
        When an object finds no room.
    """

    @cache
    def drawn(attempt: int) -> tuple[StandingBoxes, GroundRectangles]:
        each = [source.drawn(attempt) for source in sources]
        boxes = StandingBoxes(*(np.concatenate(parts) for parts in zip(*each, strict=True)))
        return boxes, rectangles(boxes.centers[:, :2], boxes.sizes, boxes.yaws)

    found = StandingBoxes(*(values.copy() for values in drawn(0)[0]))
    areas = found.sizes[:, 0] * found.sizes[:, 1]
    most = int(np.bincount(scenes, areas).argmax())
    if np.bincount(scenes, areas)[most] > ground_m2:
        _complain(f"{np.bincount(scenes)[most]:,} in a scene, larger than the space together")
    turns = _turns(scenes)
    taken = nowhere((int(scenes.max()) + 1, int(turns.max()) + 1))
    for turn in range(int(turns.max()) + 1):
        waiting = np.flatnonzero(turns == turn)
        for attempt in range(ATTEMPTS):
            boxes, ground = drawn(attempt)
            own = ground.at(waiting)
            others = taken.at((scenes[waiting], slice(0, turn)))
            room = ~overlap(own, free) & ~overlap(own.among(), others).any(axis=1)
            settled = waiting[room]
            taken.put((scenes[settled], turn), ground.at(settled))
            for values, new in zip(found, boxes, strict=True):
                values[settled] = new[settled]
            waiting = waiting[~room]
            if not len(waiting):
                break
        else:
            count, name = np.bincount(scenes).max(), names[labels[waiting[0]]]
            _complain(f"{count:,} in a scene, and no room for a {name} in {ATTEMPTS} places")
    return found


def _turns(scenes: Ints) -> Ints:
    """(N,) how many objects of its scene stand before each."""
    order = np.argsort(scenes, kind="stable")
    first = np.searchsorted(scenes[order], scenes[order], side="left")
    turns = np.empty(len(scenes), np.int64)
    turns[order] = np.arange(len(scenes)) - first
    return turns


def _complain(found: str) -> None:
    expected = "objects that find room in the space without overlap"
    raise InputError("prior", "density", expected, found)
