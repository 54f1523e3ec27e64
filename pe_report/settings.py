"""What experiment 1 is sensitive to: one thing changed at a time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pe_core as pe
from pe_core.prior import ROAD_CLASSES

Change = Callable[[pe.Study], pe.Study]

KITTI = {
    "car": (29.5, 13.93, 5.73, 0.73),
    "pedestrian": (8.1, 6.55, 13.26, 0.817),
    "cyclist": (12.2, 11.77, 9.5, 0.009),
    "truck": (59.5, 2.07, 14.22, 0.318),
}
"""decay_x, laplace_y, gauss_y [m], laplace_share: the road prior's form fitted by maximum
likelihood to the labels of KITTI tracking (21 sequences, ahead of the car only), without cones."""


def _classes(change: Callable[[pe.ObjectClass], pe.ObjectClass]) -> Change:
    def changed(study: pe.Study) -> pe.Study:
        classes = tuple(change(c) for c in ROAD_CLASSES)
        return replace(study, prior=pe.Prior("road", classes, study.prior.focus))

    return changed


def _along(factor: float) -> Change:
    return _classes(lambda c: replace(c, decay_x=factor * c.decay_x))


def _across(factor: float) -> Change:
    return _classes(
        lambda c: replace(c, laplace_y=factor * c.laplace_y, gauss_y=factor * c.gauss_y)
    )


def _kitti(cls: pe.ObjectClass) -> pe.ObjectClass:
    if cls.name not in KITTI:
        return cls
    along, laplace, gauss, share = KITTI[cls.name]
    return replace(cls, decay_x=along, laplace_y=laplace, gauss_y=gauss, laplace_share=share)


def _interval(side: float) -> Change:
    """Voxels of another side; the space ends at the largest whole number of them below 5 m."""

    def changed(study: pe.Study) -> pe.Study:
        top = math.floor(study.space.z[1] / side + 1e-6) * side
        return replace(study, space=pe.PerceptionSpace(z=(0.0, top), interval=side))

    return changed


SHIPPED = "as shipped"
NEARER = "positions as in KITTI"
SETTINGS: dict[str, Change] = {
    SHIPPED: lambda study: study,
    "objects half as far ahead and behind": _along(0.5),
    "twice as far ahead and behind": _along(2.0),
    "half as far to the sides": _across(0.5),
    "twice as far to the sides": _across(2.0),
    NEARER: _classes(_kitti),
    "voxels of 0.2 m": _interval(0.2),
    "voxels of 0.4 m (space 4.8 m high)": _interval(0.4),
    "no vehicle": lambda study: replace(study, vehicle=None),
}
"""By name: the change to a study. Expected counts are a setting of their own (`expected`)."""
EXPECTED = "expected beam counts, no vehicle"
GROUPS = {
    "the side of the voxels": tuple(name for name in SETTINGS if name.startswith("voxels")),
    "the prior's scales": (*(name for name in SETTINGS if "as far" in name), NEARER),
    "the vehicle": ("no vehicle",),
    "expected counts": (EXPECTED,),
}
"""What the settings change."""
