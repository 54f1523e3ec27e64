"""Boxes as sensors see them: placed round a sensor, rays that hit them, boxes that hide others.

`BodyParts` are the boxes of test bodies, of which a requirement asks how much is visible.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.arrays import Flags, Floats, Ints, read_only
from ..geometry.bins import count_up, stable_order
from ..geometry.poses import dot, rotate
from ..scene.objects import Objects

NUDGE_M = np.array([1.97, 3.02, 4.98]) * 1e-8
"""A sensor is moved by this, ground frame [m]: a beam that would run exactly along a face of a box
(the horizontal one, at the height of its roof) then runs beside it or through it, whatever the
rounding. The ratios are those of `lidar.kind`: of no beam at round angles, so that a beam
through an edge of a box is decided as well."""
NO_SPEED = 1e-30  # Replaces a direction component of exactly 0, to divide by it
NEAREST_M = 1e-6  # Replaces the distance 0 [m]
APART_RAD = 1e-6
"""Margin between the directions of balls, seen from above, that do not hide each other [rad]."""
CELLS, ROUND = range(2)
"""Layers of boxes: the cells that are measured, the shell round the body."""
LAYERS = 2
NO_END = -1
"""Band of a ray that does not enter a layer."""


@dataclass(frozen=True, slots=True)
class PlacedBoxes:
    """Boxes relative to a sensor, along the axes of each box: length, width, up. `offsets` (N, 3)
    are the centres from the sensor [m], `halves` (N, 3) half sizes [m], and `headings` (N, 2)
    cosine and sine of the yaws."""

    offsets: Floats
    halves: Floats
    headings: Floats

    @classmethod
    def of(cls, objects: Objects, position: Sequence[float]) -> "PlacedBoxes":
        """Return the boxes of objects relative to a position, moved by `NUDGE_M`."""
        x, y, z = (objects.centers - (np.asarray(position) + NUDGE_M)).T
        c, s = objects.headings.T
        offsets = np.stack([c * x + s * y, c * y - s * x, z], axis=1)
        return cls(offsets, objects.sizes / 2.0, objects.headings)

    def take(self, index: Ints) -> "PlacedBoxes":
        """Return some of the boxes."""
        return PlacedBoxes(self.offsets[index], self.halves[index], self.headings[index])

    def along(self, which: Ints, directions: Floats) -> tuple[Floats, Floats, Floats]:
        """Return ground-frame directions (P, 3) along the axes of box `which` (P,) each."""
        c, s = self.headings[which].T
        x, y, z = directions.T
        return c * x + s * y, c * y - s * x, z

    def in_ground(self, points: Floats, which: Ints | slice = slice(None)) -> Floats:
        """Return points (P, 3) along the axes of box `which` (P,) each along the ground axes."""
        c, s = self.headings[which].T
        x, y, z = points.T
        return np.stack([c * x - s * y, s * x + c * y, z], axis=1)

    def axes_in(self, ground_from_frame: Floats) -> list[Floats]:
        """Return the boxes' three axes in a frame, (3, N) each."""
        c, s = self.headings.T
        zero = np.zeros(len(c))
        axes = ((c, s, zero), (-s, c, zero), (zero, zero, zero + 1.0))
        return [rotate(ground_from_frame.T, np.stack(w, axis=1)).T for w in axes]

    def crossing(self, which: Ints, directions: Floats) -> tuple[Floats, Floats]:
        """Return distances (P,) at which rays from the sensor enter and leave one box each. `enter`
        is at least 0; if the ray misses, enter >= leave."""
        enter = np.zeros(len(which))
        leave = np.full(len(which), np.inf)
        for k, speed in enumerate(self.along(which, directions)):
            speed = np.where(np.abs(speed) < NO_SPEED, NO_SPEED, speed)
            offset = self.offsets[which, k]
            half = self.halves[which, k]
            t0 = (offset - half) / speed
            t1 = (offset + half) / speed
            np.maximum(enter, np.minimum(t0, t1), out=enter)
            np.minimum(leave, np.maximum(t0, t1), out=leave)
        return enter, leave

    def side_points(self, lattice: tuple[int, int]) -> "tuple[BoxRays, Floats]":
        """Return rays to points on the sides that face the sensor, and solid angles (R,) [sr].

        A side has points on a Fibonacci lattice, each with the solid angle of an equal piece of its
        area: `lattice` has their count and the Fibonacci number before it. No two points have the
        same distance from an edge of the side, so an edge that cuts the side at any angle has the
        right share of them on each side.
        """
        count, turn = lattice
        step = np.arange(count) + 0.5
        points = np.stack([step / count, (step * turn / count) % 1.0], axis=1) * 2.0 - 1.0
        return self._rays_to_sides(points)

    def side_corners(self, count: int) -> "tuple[BoxRays, Floats]":
        """Return rays to the corners of `count` x `count` equal patches of the sides that face the
        sensor, and what `side_points` does: side after side, row after row, (count + 1)^2 each."""
        step = np.linspace(-1.0, 1.0, count + 1)
        across, up = np.meshgrid(step, step, indexing="ij")
        return self._rays_to_sides(np.stack([across.ravel(), up.ravel()], axis=1))

    def _rays_to_sides(self, lattice: Floats) -> "tuple[BoxRays, Floats]":
        """Return rays to points of a lattice (K, 2), in half sides, on each side that faces the
        sensor, and the solid angle of a K-th of the side there (R,) [sr]."""
        items = []
        places = []
        pieces = []
        for axis in range(3):
            others = [k for k in range(3) if k != axis]
            facing = np.flatnonzero(np.abs(self.offsets[:, axis]) > self.halves[:, axis])
            offset = self.offsets[facing]
            half = self.halves[facing]
            points = np.repeat(offset[:, None], len(lattice), axis=1)
            points[:, :, axis] -= (np.sign(offset[:, axis]) * half[:, axis])[:, None]
            for k, other in enumerate(others):
                points[:, :, other] += half[:, other, None] * lattice[:, k]
            area = 4.0 * half[:, others[0]] * half[:, others[1]] / len(lattice)
            items.append(np.repeat(facing, len(lattice)))
            places.append(points.reshape(-1, 3))
            pieces.append(np.repeat(area * np.abs(points[:, 0, axis]), len(lattice)))
        item = np.concatenate(items)
        ground = self.in_ground(np.concatenate(places), item)
        distance = np.maximum(np.sqrt(dot(ground, ground)), NEAREST_M)
        solid = np.concatenate(pieces) / (distance * distance * distance)
        return BoxRays(item, ground / distance[:, None], distance), solid


@dataclass(frozen=True, slots=True)
class BoxRays:
    """Rays from a sensor that hit boxes, (R,) each. `item` is the box; `directions` (R, 3) are unit
    vectors in the ground frame; `distance` is the distance to the box [m]."""

    item: Ints
    directions: Floats
    distance: Floats


@dataclass(frozen=True, slots=True)
class Rivals:
    """Boxes that may hide boxes (P,): for box k, `count[k]` of `other` from `first[k]` on."""

    first: Ints
    count: Ints
    other: Ints

    @classmethod
    def of(cls, scenes: Ints, which: Ints) -> "Rivals":
        """Return all other boxes of the same scenes."""
        order = stable_order(scenes)
        first = np.searchsorted(scenes[order], scenes[which], "left")
        count = np.searchsorted(scenes[order], scenes[which], "right") - first
        other = order[np.repeat(first, count) + count_up(count)]
        rivals = cls(np.cumsum(count) - count, count, other)
        return rivals.some(other != which[rivals.ranks()])

    @classmethod
    def near(cls, boxes: PlacedBoxes, scenes: Ints, balls: Floats, which: Ints) -> "Rivals":
        """Return, for some boxes, the other boxes of their scenes that may hide them. `balls` (N,)
        are radii of balls round all boxes [m]."""
        rivals = cls.of(scenes, which)
        other = rivals.other
        item = which[rivals.ranks()]
        x, y, _ = boxes.in_ground(boxes.offsets).T
        flat = np.hypot(x, y)
        near = flat - balls
        across = x[item] * y[other] - y[item] * x[other]
        along = x[item] * x[other] + y[item] * y[other]
        half = np.arcsin(balls / np.maximum(flat, balls))
        apart = np.abs(np.arctan2(across, along)) > half[item] + half[other] + APART_RAD
        before = near[other] < flat[item] + balls[item]
        around = np.minimum(near[item], near[other]) <= 0.0
        return rivals.some(before & (around | ~apart))

    def ranks(self) -> Ints:
        """(R,) the box that each entry may hide."""
        return np.repeat(np.arange(len(self.count)), self.count)

    def some(self, kept: Flags) -> "Rivals":
        """Return the flagged entries (R,)."""
        count = np.bincount(self.ranks()[kept], minlength=len(self.count))
        return Rivals(np.cumsum(count) - count, count, self.other[kept])


def behind_others(boxes: PlacedBoxes, rivals: Rivals, rays: BoxRays) -> Flags:
    """Whether rays enter another box of `rivals` before their own; boxes have the same indices."""
    hidden = np.zeros(len(rays.item), bool)
    first = rivals.first[rays.item]
    count = rivals.count[rays.item]
    for rank in range(int(count.max(initial=0))):
        some = np.flatnonzero((count > rank) & ~hidden)
        box = rivals.other[first[some] + rank]
        enter, leave = boxes.crossing(box, rays.directions[some])
        hidden[some] = (enter < leave) & (enter < rays.distance[some])
    return hidden


@dataclass(frozen=True, eq=False)
class BodyParts:
    """Cells of bodies, and shells that tell in which band of a body a ray ends.

    The surface of a body is between the shell round it and the cells; that of a body without a
    shell is on the cells. The `cells` are measured; their scenes are the bodies. `shells` are boxes
    round the bodies, with the same scenes. `bands` (N,) are the bands of height of the cells and of
    the shells after them, `layers` (N,) `CELLS` or `ROUND`.
    """

    cells: Objects
    shells: Objects | None
    bands: Ints
    layers: Ints

    @cached_property
    def objects(self) -> Objects:
        """The cells, then the shells."""
        shells = () if self.shells is None else (self.shells,)
        return Objects.joined([self.cells, *shells])

    @cached_property
    def has_layer(self) -> Flags:
        """Whether each body has boxes of each layer, (LAYERS, bodies)."""
        scenes = self.objects.scenes
        has = np.zeros((LAYERS, int(scenes.max()) + 1), bool)
        has[self.layers, scenes] = True
        return read_only(has)
