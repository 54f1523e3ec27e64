"""A van with a LiDAR and two cameras, and zones round it, for the tests of requirements."""

import numpy as np

import pe_core as pe
from pe_core.scoring.requirements import RequirementChecker, Zone
from tests.engine import shapes

MIDDLE = Zone(x=("front + 0.6", "front + 1.6"), y=(-0.6, 0.6), step=0.3)
AHEAD = Zone(x=("front + 0.4", "front + 1.6"), y=("right", "left"), step=0.3)


def van(mirrors=False):
    """A box 5 m long and 2 m wide; with mirrors, two more that stick out by 0.25 m."""
    triangles = [shapes.box((-2.5, -1.0, 0.25), (2.5, 1.0, 2.4))]
    names = ["body"]
    if mirrors:
        triangles += [
            shapes.box((1.5, s * 1.25 - 0.25 * (s > 0), 1.0), (1.6, s * 1.0 + 0.25 * (s > 0), 1.3))
            for s in (-1, 1)
        ]
        names += ["mirror_right", "mirror_left"]
    parts = np.repeat(np.arange(len(names)), [len(t) for t in triangles]).astype(np.int32)
    return pe.Vehicle(np.concatenate(triangles), parts, names, clearance=0.0)


def rig():
    """A LiDAR high at the front, a camera that looks ahead, another behind."""
    return pe.Rig(
        [
            shapes.lidar_on_roof(
                shapes.small_lidar(24, 720), (2.37, 0.21, 2.63), (0.0, 9.0, 0.0), "top"
            ),
            shapes.camera(100.0, (2.53, 0.0, 0.93), (0.0, 18.0, 0.0), "front"),
            shapes.camera(120.0, (-2.53, 0.0, 1.5), (0.0, 30.0, 180.0), "rear"),
        ]
    )


def check(*requirements, vehicle=None, of=None, **options):
    checker = RequirementChecker(requirements, vehicle or van())
    return checker.check(of or rig(), **options)
