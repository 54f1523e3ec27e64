"""AP curves of whole objects, m counted on the object: a voxel's carried over to a class's size."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..metric.entropy import ApCurve

BoxSize = tuple[float, float, float]
ClassCurves = Mapping[str, Mapping[str, ApCurve]]
"""By kind, then by class."""

PAPER_VOXEL_M = 0.1
"""The side of the voxels that the paper's curves are of."""
SIZES: dict[str, BoxSize] = {
    "car": (4.6, 1.9, 1.7),
    "pedestrian": (0.8, 0.7, 1.75),
    "cyclist": (1.76, 0.65, 1.74),
    "truck": (7.5, 2.55, 3.0),
    "cone": (0.4, 0.4, 0.9),
}
"""Length, width, height [m] of the classes that curves are carried over to: the road's means."""


def carried_over(curve: ApCurve, size: BoxSize, side: float = PAPER_VOXEL_M) -> ApCurve:
    """Return the curve of an object whose voxels have that curve.

    Seen along the ground from any side alike, a box of length l, width w and height h has a
    silhouette of 2 (l + w) h / pi on average, a cube of side s one of 4 s^2 / pi. An object gets as
    many times the beams or pixels of a voxel at its place: AP = a ln(m / k) + b, k = (l + w) h /
    (2 s^2).
    """
    length, width, height = size
    times = (length + width) * height / (2.0 * side * side)
    return ApCurve(curve.a, curve.b - curve.a * math.log(times))


def all_carried_over(curve: ApCurve) -> dict[str, ApCurve]:
    """Return the curves of the road's classes whose voxels have that curve."""
    return {name: carried_over(curve, size) for name, size in SIZES.items()}
