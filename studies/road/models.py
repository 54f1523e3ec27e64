"""The steps of the plan: from solid boxes to open bodies whose returns fade, and their fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

import pe_core as pe
from pe_core.base import Floats, Ints
from pe_core.geometry.ray_traversal import TriangleTree
from pe_core.geometry.raycast import VisibleTriangles
from pe_core.sensors.boxes import PlacedBoxes
from pe_core.sensors.kernels import ObjectView
from pe_core.sensors.lidar.definition import BoxHits, beam_directions
from pe_core.sensors.lidar.kernel_objects import LidarObjects
from pe_core.sensors.lidar.model import lidar_of
from pe_core.sensors.lidar.returns import passed, return_probability

from ..detectors.shapes import placed_mesh
from .logs import CLASSES, OTHER, Log

RINGS_M = (0.0, 15.0, 30.0, 60.0, 150.0)
MIN_BOXES = 50
ALL = "all"
LEAST_COSINE = 1e-3
FILLS = np.round(np.arange(0.1, 1.001, 0.025), 3)
HALVES_M = np.round(np.geomspace(10.0, 1000.0, 41), 1)
PASSES = 4
"""A class's beams depend on what others let through: the fit is repeated."""
SOLID, MESHES, OPEN, FADING, INCLINED = STEPS = (
    "default",
    "open bodies, fill of the meshes",
    "open bodies, fill fitted",
    "fading returns",
    "fading returns, with incidence",
)


Cells = dict[tuple[str, int], Ints]
"""Indices of the boxes of each class and ring that has enough of them."""


def cells_of(log: Log) -> Cells:
    """Return the cells of a log."""
    labels = log.objects.labels
    distance = log.distance
    found = {
        (name, ring): np.flatnonzero((labels == k) & (distance >= low) & (distance < high))
        for k, name in enumerate(CLASSES)
        if name != OTHER
        for ring, (low, high) in enumerate(pairwise(RINGS_M))
    }
    return {cell: boxes for cell, boxes in found.items() if len(boxes) >= MIN_BOXES}


@dataclass(frozen=True)
class Crossings:
    """Beams that enter boxes of a log, (H,) each, and the boxes' counted points (N,)."""

    log: Log
    box: Ints
    ray: Ints
    enter: Floats
    cosine: Floats


@dataclass(frozen=True)
class Fitted:
    """A step with its values: fill and half distance [m] of each class, (C,) each."""

    step: str
    fill: Floats
    half: Floats

    def predicted(self, beams: Crossings) -> Floats:
        """Return the expected points (N,) of the boxes."""
        label = beams.log.objects.labels[beams.box]
        share = _passed(beams, self.fill[label])
        weight = share * self.fill[label] * _returns(beams, self.half[label], self.step)
        return np.bincount(beams.box, weight, len(beams.log.points)).astype(float)


def crossings(log: Log, rig: pe.Rig) -> Crossings:
    """Return all crossings of a rig's beams and a log's boxes."""
    kernel = LidarObjects(ObjectView(log.objects, None, True))
    parts = []
    for k, sensor in enumerate(rig):
        hits = kernel.crossings(sensor)
        boxes = PlacedBoxes.of(log.objects, sensor.pose.position)
        cosine = cosines(hits, boxes, beam_directions(sensor)[hits.beam])
        parts.append((hits.box, hits.beam + k * lidar_of(sensor).beam_count, hits.enter, cosine))
    return Crossings(log, *(np.concatenate(w) for w in zip(*parts, strict=True)))


def cosines(hits: BoxHits, boxes: PlacedBoxes, directions: Floats) -> Floats:
    """Return the cosine (H,) between each beam and the normal of the face that it enters by."""
    enter = np.full(len(hits.box), -np.inf)
    cosine = np.zeros(len(hits.box))
    for k, speed in enumerate(boxes.along(hits.box, directions)):
        offset = boxes.offsets[hits.box, k]
        half = boxes.halves[hits.box, k]
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.minimum((offset - half) / speed, (offset + half) / speed)
        later = t > enter
        enter[later] = t[later]
        cosine[later] = np.abs(speed[later])
    return cosine


def _passed(beams: Crossings, fill: Floats) -> Floats:
    return passed(beams.box, beams.ray, beams.enter, beams.log.objects.scenes, fill=fill)


def _returns(beams: Crossings, half: Floats | float, step: str) -> Floats | float:
    if step not in (FADING, INCLINED):
        return 1.0
    if step == INCLINED:  # P ~ rho cos(theta) / R^2
        half = half * np.sqrt(np.maximum(beams.cosine, LEAST_COSINE))
    return return_probability(beams.enter, half)


def loss_of_boxes(counted: Ints, m: Floats) -> Floats:
    """Return |ln((n + 1/2) / (m + 1/2))| (N,)."""
    return np.abs(np.log((counted + 0.5) / (m + 0.5)))


def loss(log: Log, m: Floats) -> float:
    """Return the mean over the cells of a log of the mean loss of their boxes."""
    each = loss_of_boxes(log.points, m)
    return float(np.mean([each[boxes].mean() for boxes in cells_of(log).values()]))


def mesh_fills() -> Floats:
    """Return the share (C,) of a unit box's silhouette that the study's meshes fill; 1 without."""
    grid = (np.arange(40) + 0.5) / 40
    along, up = (w.ravel() for w in np.meshgrid(grid * 2.0 - 1.0, grid))
    sizes = {"car": (4.6, 1.9, 1.7), "pedestrian": (0.8, 0.7, 1.75), "cyclist": (1.76, 0.65, 1.74)}
    sizes |= {"truck": (7.5, 2.55, 3.0), "cone": (0.4, 0.4, 0.9), "bollard": (0.2, 0.2, 0.8)}
    return np.array([_fill(n, sizes[n], along, up) if n in sizes else 1.0 for n in CLASSES])


def _fill(name: str, size: tuple[float, float, float], along: Floats, up: Floats) -> float:
    tree = TriangleTree(placed_mesh(name, np.zeros(3), np.array(size), 0.0))
    hit = inside = 0
    for angle in np.pi * np.arange(8) / 8:
        axis = np.array([np.cos(angle), np.sin(angle)])
        side = np.array([-np.sin(angle), np.cos(angle)])
        half = (abs(side[0]) * size[0] + abs(side[1]) * size[1]) / 2.0
        far = 1000.0
        start = np.array([*(-far * axis), size[2] / 2.0])
        target = np.column_stack([np.outer(along * half, side), up * size[2]])
        rays = target - start
        rays /= np.sqrt((rays**2).sum(axis=1))[:, None]
        hit += int(np.isfinite(VisibleTriangles(tree, start).first_hit(rays).distance).sum())
        inside += len(rays)
    return hit / inside


def fit(step: str, logs: Sequence[Crossings], start: Fitted | None = None) -> Fitted:
    """Return a step with the values that minimise the loss over some logs."""
    count = len(CLASSES)
    fill = np.ones(count)
    half = np.full(count, np.inf)
    if step == SOLID:
        return Fitted(step, fill, half)
    fill = mesh_fills() if start is None else start.fill.copy()
    if step == MESHES:
        return Fitted(step, fill, half)
    halves = HALVES_M if step in (FADING, INCLINED) else np.array([np.inf])
    for _ in range(PASSES):
        found = _best(step, logs, fill, halves)
        rest = found.pop(ALL)
        values = [found.get(name, rest) for name in CLASSES]
        fill, half = (np.array(w) for w in zip(*values, strict=True))
    return Fitted(step, fill, half)


def _best(
    step: str, logs: Sequence[Crossings], fill: Floats, halves: Floats
) -> dict[str, tuple[float, float]]:
    """Return the best fill and half distance of each class with cells, what others let through."""
    counted = np.concatenate([b.log.points for b in logs])
    labels = np.concatenate([b.log.objects.labels for b in logs])
    distance = np.concatenate([b.log.distance for b in logs])
    ring = np.digitize(distance, RINGS_M) - 1
    shares = [_passed(b, fill[b.log.objects.labels[b.box]]) for b in logs]
    losses = np.empty((len(halves), len(FILLS), len(counted)), np.float32)
    for k, half in enumerate(halves):
        m = np.concatenate(
            [
                np.bincount(b.box, s * _returns(b, half, step), len(b.log.points))
                for b, s in zip(logs, shares, strict=True)
            ]
        )
        for j, f in enumerate(FILLS):
            losses[k, j] = loss_of_boxes(counted, f * m)
    best = {}
    for name in (*CLASSES[:-1], ALL):
        of_class = labels == CLASSES.index(name) if name != ALL else labels < len(CLASSES) - 1
        cells = [of_class & (ring == r) for r in range(len(RINGS_M) - 1)]
        cells = [cell for cell in cells if cell.sum() >= MIN_BOXES]
        if cells:
            total = np.mean([losses[:, :, cell].mean(axis=2) for cell in cells], axis=0)
            at = np.unravel_index(np.argmin(total), total.shape)
            best[name] = (float(FILLS[at[1]]), float(halves[at[0]]))
    return best
