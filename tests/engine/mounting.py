"""A box car with a roof to mount on, shared by the tests of mounts."""

import numpy as np

import pe_core as pe
from pe_core.search import Parametrization
from tests.engine import shapes

TOP = 1.4
"""Height of the roof [m]; it goes from x = -1.5 to 0.8 and from y = -0.7 to 0.7."""
BASE = 0.04
CAN = "Velodyne VLP-16 Puck"
"""A cylinder of 0.1033 m across and 0.0717 m high, its origin 0.0377 m above its base."""
RADIUS = 0.1033 / 2.0
HEIGHT = 0.0717
CENTER = 0.0377
ON_ROOF = (-0.43, 0.0, TOP + BASE + CENTER)


def car():
    """The box car; its roof, front and sides are parts of their own."""
    body = shapes.box((-2.3, -0.9, 0.2), (2.3, 0.9, 0.9))
    cabin = shapes.box((-1.5, -0.7, 0.8), (0.8, 0.7, TOP))
    triangles = np.concatenate([body, cabin])
    level = (triangles[:, :, 2] == TOP).all(axis=1)
    front = (triangles[:, :, 0] == 2.3).all(axis=1)
    left = (triangles[:, :, 1] == 0.9).all(axis=1)
    parts = np.select([level, front, left], [1, 2, 3], 0).astype(np.int32)
    return pe.Vehicle(triangles, parts, ("body", "roof", "front", "left"))


def can(position=ON_ROOF, name="roof", rotation=(0.0, 0.0, 0.0), model=CAN):
    """A small LiDAR of the catalogue, whose housing is known."""
    return pe.Sensor(name, pe.catalog.load(model), pe.Pose.from_degrees(position, rotation))


def space(
    *sensors,
    mount=None,
    limits=None,
    free=("x", "y", "z", "pitch"),
    vehicle=None,
    figures=None,
    **more,
):
    """A search space on the car; sensors named in `mount` are on it."""
    rig = pe.Rig(sensors)
    mounts = {name: each for name, each in (mount or {}).items()}
    mounting = pe.Mounting(mounts=mounts, on={name: name for name in mounts}, **more)
    study = pe.Study(
        rig,
        vehicle or car(),
        search=pe.Search({s.name: free for s in rig}, limits or {}, mounting=mounting),
        limits=pe.Limits(**(figures or {})),
    )
    return rig, study.search_space()


def coded(*sensors, **options):
    """The parametrization of a search space on the car."""
    rig, own = space(*sensors, **options)
    return Parametrization(rig, own)


def roof(standoff=BASE, orientation="upright"):
    """The roof as a mount."""
    return pe.SurfaceMount(["roof"], standoff, orientation)
