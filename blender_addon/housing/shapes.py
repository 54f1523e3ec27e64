"""A housing's surface as plain arrays: a can with a window all round, a box that looks ahead, a
camera with its lens. Nothing of Blender.

Outer sizes are the housing's; what is inside them is a maker's usual proportion, no drawing of his.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ..engine import pe

Floats = NDArray[np.float64]

BODY, TRIM, GLASS, MARK = range(4)
"""What a face is made of."""
AROUND = 48
"""Points of a circle."""
CORNER = 6
"""Points of a rounded corner."""
MARK_M = 0.001
"""How far the arrow that says where ahead is stands out."""


@dataclass(frozen=True)
class Surface:
    """Points (N, 3) in the sensor frame [m], faces that look outwards, and what each is made of."""

    points: Floats
    faces: tuple[tuple[int, ...], ...]
    made_of: tuple[int, ...]

    def __add__(self, other: Surface) -> Surface:
        """Both together."""
        moved = tuple(tuple(i + len(self.points) for i in face) for face in other.faces)
        points = np.concatenate([self.points, other.points])
        return Surface(points, self.faces + moved, self.made_of + other.made_of)

    def moved(self, by: Floats) -> Surface:
        """The same somewhere else."""
        return Surface(self.points + by, self.faces, self.made_of)


class Ring(NamedTuple):
    """Points (N, 3) round an axis, and what the surface is made of from here to the next."""

    points: Floats
    made_of: int = BODY


def surface_of(housing: pe.Housing, has_lens: bool) -> Surface:
    """Return the surface of a housing, the sensor frame's origin its optical centre."""
    if has_lens:
        surface = camera(housing.size)
    elif housing.shape == "cylinder":
        surface = can(housing.size, housing.optical_center[2])
    else:
        surface = visor(housing.size)
    return surface.moved(-np.array(housing.optical_center))


def can(size: Sequence[float], center: float) -> Surface:
    """An upright can, its window round the optical centre; its base is in z = 0."""
    radius, height = size[0] / 2.0, size[2]
    top = height - MARK_M
    bevel, inset = 0.04 * size[0], 0.02 * size[0]
    half = min(0.26 * height, center - 0.12 * height, top - center - 0.1 * height)
    half = max(half, 0.08 * height)
    low, high = max(center - half, 2.0 * bevel), min(center + half, top - 2.0 * bevel)
    profile = [(radius - bevel, 0.0, BODY), (radius, bevel, BODY), (radius, low, TRIM)]
    profile += [(radius - inset, low, GLASS), (radius - inset, high, TRIM)]
    profile += [(radius, high, BODY), (radius, top - bevel, BODY), (radius - bevel, top, BODY)]
    rings = [Ring(_circle(r, z), made_of) for r, z, made_of in profile]
    return loft(rings) + arrow(-0.05 * radius, top, 0.55 * radius)


def visor(size: Sequence[float]) -> Surface:
    """A box with a window in its front; its base is in z = 0."""
    front, back = size[0] / 2.0, -size[0] / 2.0
    wide, high = size[1], size[2] - MARK_M
    bevel, frame = 0.06 * min(size), 0.1 * min(wide, high)
    section = _sections(wide, high)
    rings = [Ring(section(back, bevel)), Ring(section(back + bevel, 0.0))]
    rings += [Ring(section(front - bevel, 0.0)), Ring(section(front, bevel), TRIM)]
    rings += [Ring(section(front, frame), TRIM), Ring(section(front - 0.5 * bevel, frame), GLASS)]
    return loft(rings) + arrow(0.0, high, 0.28 * size[0])


def camera(size: Sequence[float]) -> Surface:
    """A small box with a lens ahead; its base is in z = 0."""
    front, back = size[0] / 2.0, -size[0] / 2.0
    face = front - 0.35 * size[0]
    wide, high = size[1], size[2] - MARK_M
    bevel, radius = 0.08 * min(size), 0.36 * min(wide, high)
    section = _sections(wide, high)
    rings = [Ring(section(back, bevel)), Ring(section(back + bevel, 0.0))]
    rings += [Ring(section(face - bevel, 0.0)), Ring(section(face, bevel))]
    return (
        loft(rings) + lens(radius, face, front, high / 2.0) + arrow(0.6 * back, high, 0.35 * wide)
    )


def lens(radius: float, start: float, end: float, height: float) -> Surface:
    """A barrel along x with its glass a little behind its rim."""
    deep = 0.25 * (end - start)
    profile = [(radius, start, TRIM), (radius, end, TRIM), (0.82 * radius, end, TRIM)]
    profile += [(0.74 * radius, end - deep, GLASS), (0.4 * radius, end - 0.7 * deep, GLASS)]
    rings = [Ring(_circle(r, x)[:, [2, 0, 1]], made_of) for r, x, made_of in profile]
    return loft(rings).moved(np.array([0.0, 0.0, height]))


def arrow(x: float, z: float, length: float) -> Surface:
    """A flat arrow on top that points ahead."""
    tip, wing = x + length, 0.45 * length
    corners = [(tip, 0.0), (x, wing), (x + 0.25 * length, 0.0), (x, -wing)]
    rings = [
        Ring(np.array([(*each, height) for each in corners]), MARK) for height in (z, z + MARK_M)
    ]
    return loft(rings)


def loft(rings: Sequence[Ring]) -> Surface:
    """Return the surface through rings of as many points each, closed at both ends.

    Rings run counter-clockwise, seen from where the next one is.
    """
    count = len(rings[0].points)
    points = np.concatenate([ring.points for ring in rings])
    faces: list[tuple[int, ...]] = [tuple(range(count))[::-1]]
    made_of = [rings[0].made_of]
    for number, ring in enumerate(rings[:-1]):
        start = number * count
        for k in range(count):
            after = (k + 1) % count
            faces.append((start + k, start + after, start + count + after, start + count + k))
            made_of.append(ring.made_of)
    faces.append(tuple(range(len(points) - count, len(points))))
    return Surface(points, tuple(faces), (*made_of, rings[-1].made_of))


def _circle(radius: float, height: float) -> Floats:
    """(N, 3) points round the z axis, counter-clockwise from above."""
    angle = np.arange(AROUND) * (2.0 * np.pi / AROUND)
    flat = radius * np.cos(angle), radius * np.sin(angle)
    return np.stack([*flat, np.full(AROUND, height)], axis=1)


class _sections:
    """Sections of a box across x, with round corners: at a place, so much smaller on each side."""

    def __init__(self, wide: float, high: float) -> None:
        self.wide, self.high = wide, high
        self.round = 0.14 * min(wide, high)

    def __call__(self, x: float, smaller: float) -> Floats:
        """(N, 3) points, counter-clockwise from ahead."""
        radius = max(self.round - smaller, 0.2 * self.round)
        half = np.array([self.wide, self.high]) / 2.0 - smaller - radius
        rows = []
        for number, (right, up) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
            for angle in (number + np.arange(CORNER) / (CORNER - 1)) * (np.pi / 2.0):
                y = right * half[0] + radius * np.cos(angle)
                z = up * half[1] + radius * np.sin(angle)
                rows.append((x, y, z + self.high / 2.0))
        return np.array(rows)
