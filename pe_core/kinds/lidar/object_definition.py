"""The measurement of objects by a LiDAR as it is defined: every beam, no tricks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot
from ...scene.objects import Objects
from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..placed_boxes import PlacedBoxes
from .definition import BEAM_TESTS_AT_ONCE, CULL_MARGIN_RAD, beam_directions, beam_ends
from .model import Lidar

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class BoxHits:
    """Beams that enter boxes, (H,) each: the object, the beam, and how far it has come [m]."""

    item: Ints
    beam: Ints
    enter: Floats


def count_on_objects(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
) -> Floats:
    """(N,) number of beams that end on each object."""
    directions = beam_directions(sensor)
    ends = beam_ends(sensor, directions, vehicle)
    hits = _hits(PlacedBoxes.of(objects, sensor.pose.position), directions, ends)
    if traffic:
        hits = first_of_scene(hits, objects.scenes)
    far = hits.enter >= cast(Lidar, sensor.model).min_range
    return np.bincount(hits.item[far], minlength=len(objects)).astype(float)


def first_of_scene(hits: BoxHits, scenes: Ints) -> BoxHits:
    """Return, of each beam in each scene, the nearest hit; of equals, that of the lowest index."""
    scene = scenes[hits.item]
    order = np.lexsort((hits.item, hits.enter, hits.beam, scene))
    beam, scene = hits.beam[order], scene[order]
    first = np.ones(len(order), bool)
    first[1:] = (beam[1:] != beam[:-1]) | (scene[1:] != scene[:-1])
    kept = order[first]
    return BoxHits(hits.item[kept], hits.beam[kept], hits.enter[kept])


def _hits(boxes: PlacedBoxes, directions: Floats, ends: Floats) -> BoxHits:
    """Return all hits of boxes by beams that have not ended before."""
    found = []
    for item, beam in _near_pairs(boxes, directions):
        enter, leave = boxes.crossing(item, directions[beam])
        hit = np.flatnonzero((enter < leave) & (enter <= ends[beam]))
        found.append((item[hit], beam[hit], enter[hit]))
    item, beam, enter = (np.concatenate(w) for w in zip(*found, strict=True))
    return BoxHits(item, beam, enter)


def _near_pairs(boxes: PlacedBoxes, directions: Floats) -> Iterator[tuple[Ints, Ints]]:
    """Yield (box, beam) pairs where the beam meets the ball round the box; the rest cannot hit."""
    c, s = boxes.headings.T
    x, y, z = boxes.offsets.T
    offsets = np.stack([c * x - s * y, s * x + c * y, z], axis=1)
    distance, ball = np.sqrt(dot(offsets, offsets)), np.sqrt(dot(boxes.halves, boxes.halves))
    safe = np.maximum(distance, ball)
    least = np.where(distance > ball, np.cos(np.arcsin(ball / safe) + CULL_MARGIN_RAD), -2.0)
    portion = max(1, BEAM_TESTS_AT_ONCE // len(directions))
    for start in range(0, len(offsets), portion):
        some = slice(start, start + portion)
        cosine = offsets[some] @ directions.T / safe[some, None]
        item, beam = np.nonzero(cosine >= least[some, None])
        yield item + start, beam
