"""Wheels, turned from an outline, with spokes in pairs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from parts import Part, flipped, join, tube
from skin import quads, split_quads

# Radius and offset from the wheel's centre plane (outwards positive), from the inside out.
Outline = list[tuple[float, float]]


class Wheel(NamedTuple):
    """Outlines of a wheel, and its spokes."""

    tyre: Outline
    rim: Outline
    disc: Outline
    hub: Outline
    spoke: list[tuple[float, float, float]]  # radius, offset of the face, half width
    pairs: int  # of spokes
    apart: float  # half the angle between the two spokes of a pair
    segments: int  # around the wheel


def lathe(outline: Outline, segments: int, material: str, inner: bool, outer: bool) -> Part:
    """Turn (radius, offset) pairs about the wheel's axis, y, with flat ends where asked."""
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False) - np.pi / 2
    rings = [np.column_stack([r * np.cos(angle), np.full(segments, y), r * np.sin(angle)])
             for r, y in outline]  # fmt: skip
    return tube(np.array(rings), material, (inner, outer))


def spoke(face: list[tuple[float, float, float]], turn: float) -> Part:
    """One spoke: a face and two flanks."""
    rows = []
    for _, offset, half in face:
        rows.append([(-half * 1.25, offset - 0.045), (-half, offset), (half, offset),
                     (half * 1.25, offset - 0.045)])  # fmt: skip
    flat = np.array(rows)
    radius = np.array([row[0] for row in face])[:, None]
    cos = np.cos(turn)
    sin = np.sin(turn)
    x = radius * cos - flat[..., 0] * sin
    z = radius * sin + flat[..., 0] * cos
    points = np.stack([x, flat[..., 1], z], axis=-1).reshape(-1, 3)
    faces = split_quads(points, quads(3, 4))[:, ::-1]
    return Part(points, faces, ["rim"] * len(faces))


def wheel(shape: Wheel) -> Part:
    """A left wheel about its own centre: the outer face looks along +y."""
    turns = [np.pi / 2 + 2 * np.pi * k / shape.pairs + side * shape.apart
             for k in range(shape.pairs) for side in (-1, 1)]  # fmt: skip
    return join(
        lathe(shape.tyre, shape.segments, "tyre", inner=True, outer=False),
        lathe(shape.rim, shape.segments, "rim", inner=False, outer=False),
        lathe(shape.disc, shape.segments, "trim", inner=False, outer=True),
        lathe(shape.hub, shape.segments, "rim", inner=False, outer=True),
        *[spoke(shape.spoke, turn) for turn in turns],
    )


def scaled(shape: Wheel, factor: float, segments: int = 24) -> Wheel:
    """A wheel with all lengths multiplied."""
    grown = {
        name: [tuple(factor * value for value in row) for row in getattr(shape, name)]
        for name in ("tyre", "rim", "disc", "hub", "spoke")
    }
    return shape._replace(**grown, segments=segments)


def four_wheels(shape: Wheel, axles: dict[str, float]) -> dict[str, Part]:
    """Named wheels, each about its own centre."""
    left = wheel(shape)
    right = flipped(left)
    return {
        f"wheel_{axle}_{side}": part
        for axle in axles
        for side, part in (("left", left), ("right", right))
    }


def places(
    axles: dict[str, float], track: float, radius: float
) -> dict[str, tuple[float, float, float]]:
    """Centres of the named wheels on the ground."""
    return {
        f"wheel_{axle}_{side}": (x, y, radius)
        for axle, x in axles.items()
        for side, y in (("left", track / 2), ("right", -track / 2))
    }
