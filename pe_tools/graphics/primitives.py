"""Elements of a picture as plain arrays: lines, triangles, a coloured sheet, labels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pe_core.base.arrays import Floats

from .colors import Rgba

Floats32 = NDArray[np.float32]
LabelRectangle = tuple[float, float, float, float]
"""Left, lower, right and upper side of a box in a picture; lower and upper may change places."""


def boxes_overlap(one: LabelRectangle, other: LabelRectangle) -> bool:
    """Whether two boxes overlap, for labels that must not."""
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


@dataclass(frozen=True, slots=True, eq=False)
class Primitives:
    """Lines (two points each) or triangles (three): `points` (P, 3) [m], `colors` (P, 4) sRGB."""

    points: Floats32
    colors: Floats32

    @classmethod
    def empty(cls) -> Primitives:
        """Return empty arrays of the right shape."""
        return cls(np.empty((0, 3), np.float32), np.empty((0, 4), np.float32))

    @classmethod
    def of(cls, points: ArrayLike, color: ArrayLike) -> Primitives:
        """Return points (..., 3) in one colour (4,), or in colours (..., 4)."""
        flat = np.ascontiguousarray(points, np.float32).reshape(-1, 3)
        colors = np.empty((len(flat), 4), np.float32)  # row-major, for the graphics card
        colors[:] = np.asarray(color, np.float32).reshape(-1, 4)
        return cls(flat, colors)

    @classmethod
    def joined(cls, several: Sequence[Primitives]) -> Primitives:
        """Return all primitives together, drawn in this order."""
        if not several:
            return cls.empty()
        points = np.concatenate([each.points for each in several])
        return cls(points, np.concatenate([each.colors for each in several]))


@dataclass(frozen=True, eq=False)
class GroundSheet:
    """A picture that lies on the ground: `image` (NY, NX, 4) sRGB with alpha, row 0 at low y. Its
    corners are `low` and `high` (x, y) [m]."""

    image: Floats32
    low: tuple[float, float]
    high: tuple[float, float]

    def prepared(self) -> GroundSheet:
        """Compute the mesh now, instead of at the first rendering; return the sheet."""
        _ = self.mesh
        return self

    @cached_property
    def mesh(self) -> tuple[Floats32, Floats32, NDArray[np.int32]]:
        """Points (P, 3) in the middles of its squares, their colours (P, 4), and triangles (T, 3)
        between them; none where all is transparent."""
        rows, columns = self.image.shape[:2]
        x, y = (
            low + (high - low) * (np.arange(count) + 0.5) / count
            for low, high, count in zip(self.low, self.high, (columns, rows), strict=True)
        )
        points = np.zeros((rows, columns, 3), np.float32)
        points[..., 0] = x
        points[..., 1] = y[:, None]
        number = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
        a = number[:-1, :-1]
        b = number[:-1, 1:]
        c = number[1:, 1:]
        d = number[1:, :-1]
        corners = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
        seen = (self.image[..., 3].ravel()[corners] > 0.0).any(axis=1)
        colors = np.ascontiguousarray(self.image, np.float32).reshape(-1, 4)
        return points.reshape(-1, 3), colors, np.ascontiguousarray(corners[seen])


@dataclass(frozen=True, slots=True)
class Tag:
    """A text label at a position (x, y, z) [m]; `strong` labels are larger."""

    text: str
    place: tuple[float, float, float]
    color: Rgba
    strong: bool = False


@dataclass(frozen=True, slots=True)
class ColorKey:
    """Legend of colours: a title, and a scale or classes. `scale` is a row of colours from the low
    end to the high one, with `ticks` evenly below it, and small `values` below these; `classes` are
    colours with a name each. `bounds` are the values of the scale's ends."""

    title: str
    scale: tuple[Rgba, ...] = ()
    ticks: tuple[str, ...] = ()
    classes: tuple[tuple[Rgba, str], ...] = ()
    bounds: tuple[float, float] | None = None
    values: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class LayerShape:
    """Everything that one layer draws for a sensor or for the rig. `lines` and `faces` are hidden
    by nearer objects; `through` are lines that are never hidden. `thin` lines have the minimum
    width, whatever the layer's width."""

    lines: Primitives = field(default_factory=Primitives.empty)
    faces: Primitives = field(default_factory=Primitives.empty)
    through: Primitives = field(default_factory=Primitives.empty)
    thin: Primitives = field(default_factory=Primitives.empty)
    sheet: GroundSheet | None = None
    labels: tuple[Tag, ...] = ()
    legend: ColorKey | None = None

    def at(self, _seconds: float) -> LayerShape:
        """Return what is drawn so long after the first frame of a scene."""
        return self


def polyline(points: Floats) -> Floats:
    """(2 (N - 1), 3) ends of the segments of a line through (N, 3) points."""
    return np.stack([points[:-1], points[1:]], axis=1).reshape(-1, 3)


def fan(points: Floats) -> Floats:
    """(3 (N - 2), 3) triangles that fill a convex outline of (N, 3) points."""
    count = max(len(points) - 2, 0)
    first = np.broadcast_to(points[:1], (count, 3))
    return np.stack([first, points[1 : count + 1], points[2 : count + 2]], axis=1).reshape(-1, 3)
