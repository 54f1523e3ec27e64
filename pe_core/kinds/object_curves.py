"""AP curves of whole objects: a and b of eq. 4 by kind of sensor and class, m on the object.

LiDARs find cars, pedestrians and cyclists as PointRCNN does in KITTI's tracking sequences, by the
beams of an HDL-64E that end on the box: `pe fit` on the tables in docs/objects. All else is the
paper's curve of a voxel carried over to an object of the class's size.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..metric.entropy import POINTPILLARS, RTM3D, ApCurve

Size = tuple[float, float, float]
ClassCurves = Mapping[str, Mapping[str, ApCurve]]
"""By kind, then by class."""

PAPER_VOXEL_M = 0.1
"""The side of the voxels that the paper's curves are of."""
SIZES: dict[str, Size] = {
    "car": (4.6, 1.9, 1.7),
    "pedestrian": (0.8, 0.7, 1.75),
    "cyclist": (1.76, 0.65, 1.74),
    "truck": (7.5, 2.55, 3.0),
    "cone": (0.4, 0.4, 0.9),
}
"""Length, width, height [m] of the classes that curves are carried over to: the road's means."""


def carried_over(curve: ApCurve, size: Size, side: float = PAPER_VOXEL_M) -> ApCurve:
    """Return the curve of an object whose voxels have that curve.

    Seen along the ground from any side alike, a box of length l, width w and height h has a
    silhouette of 2 (l + w) h / pi on average, a cube of side s one of 4 s^2 / pi. An object gets as
    many times the beams or pixels of a voxel at its place: AP = a ln(m / k) + b, k = (l + w) h /
    (2 s^2).
    """
    length, width, height = size
    times = (length + width) * height / (2.0 * side * side)
    return ApCurve(curve.a, curve.b - curve.a * math.log(times))


FITTED = {
    "car": ApCurve(0.237, -0.516),
    "pedestrian": ApCurve(0.163, -0.306),
    "cyclist": ApCurve(0.143, -0.022),
}
"""Fits to PointRCNN's detections (from the public AB3DMOT repository), weighed by objects; AP at 40
recalls by KITTI's overlaps (0.7 for cars, 0.5 for the others) in bins of beams. The detector was
trained on drives that overlap with these: its AP is on the high side."""
SHIPPED: ClassCurves = {
    "lidar": {name: carried_over(POINTPILLARS, size) for name, size in SIZES.items()} | FITTED,
    "camera": {name: carried_over(RTM3D, size) for name, size in SIZES.items()},
}
