"""Beams that may meet boxes, by direction, whatever the LiDAR's orientation and pattern."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import rotate
from ...scene.numbering import blocks
from .box_beams import BoxBeams
from .lattice import WINDOW_MARGIN, Windows, lattice_of
from .object_definition import BoxHits

Floats = NDArray[np.float64]

BOXES_AT_ONCE = 256
"""Their candidates fit the memory, however near they are."""
NEAREST_M = 1e-3
"""A LiDAR whose axis comes nearer to a box than this has all its beams tested."""


def candidate_hits(beams: BoxBeams) -> Iterator[BoxHits]:
    """Yield all hits of boxes, box by box: those of the beams in its window."""
    windows, beside = _windows(beams)
    lattice = lattice_of(beams.lidar)
    yield beams.all_hits(np.flatnonzero(~beside))
    which = np.flatnonzero(beside)
    for some in blocks(len(which), BOXES_AT_ONCE):
        own = which[some]
        part = Windows(*(w[own] for w in windows))
        item, beam = lattice.candidates(part)
        yield beams.hits(own[item], beam)


def azimuth_spans(beams: BoxBeams) -> tuple[Floats, Floats]:
    """First and last azimuth (N,) of boxes in the sensor's frame; all round of one on the axis."""
    (middle, half, _, _), beside = _windows(beams)
    half = np.where(beside, half, np.pi)
    return middle - half, middle + half


def _windows(beams: BoxBeams) -> tuple[tuple[Floats, Floats, Floats, Floats], NDArray[np.bool_]]:
    """Windows of all boxes, and whether they lie beside the LiDAR's axis."""
    boxes, axes = beams.boxes, beams.sensor.pose.ground_from_sensor
    c, s = boxes.headings.T
    x, y, z = boxes.offsets.T
    x, y, z = rotate(axes.T, np.stack([c * x - s * y, s * x + c * y, z], axis=1)).T
    flat = np.sqrt(x * x + y * y)
    ahead, aside = x / np.maximum(flat, NEAREST_M), y / np.maximum(flat, NEAREST_M)
    zero = np.zeros(len(c))
    own = [np.stack(w, axis=1) for w in ((c, s, zero), (-s, c, zero), (zero, zero, zero + 1.0))]
    turned = [rotate(axes.T, w).T for w in own]  # the box's axes in the sensor's frame
    halves = boxes.halves.T
    deep = sum(h * np.abs(w[0] * ahead + w[1] * aside) for h, w in zip(halves, turned, strict=True))
    wide = sum(h * np.abs(w[1] * ahead - w[0] * aside) for h, w in zip(halves, turned, strict=True))
    tall = sum(h * np.abs(w[2]) for h, w in zip(halves, turned, strict=True))
    near, far = flat - deep, np.sqrt((flat + deep) ** 2 + wide**2)
    beside = near > NEAREST_M
    room = np.where(beside, near, 1.0)
    high = np.arctan2(z + tall, np.where(z + tall > 0.0, room, far)) + WINDOW_MARGIN
    low = np.arctan2(z - tall, np.where(z - tall > 0.0, far, room)) - WINDOW_MARGIN
    half = np.arctan2(wide, room) + WINDOW_MARGIN
    return (np.arctan2(y, x), half, low, high), beside
