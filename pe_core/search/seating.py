"""A sensor put on its mount, from wherever it stands: a place to start a search from."""

from __future__ import annotations

import math

from ..scene.geometry import Pose
from ..scene.housing import Housing
from ..scene.sensors import Sensor
from ..scene.vehicle import Vehicle
from .axes import rounded
from .domains import OnSurface
from .mounts import AnyMount, SlotMount
from .surface import Skin

ALL_ROUND = {axis: (-math.tau, math.tau) for axis in ("roll", "pitch", "yaw")}


def seated(
    sensor: Sensor,
    mount: AnyMount,
    vehicle: Vehicle | None = None,
    housing: Housing | None = None,
) -> Pose:
    """Return the pose on a mount that is nearest to where a sensor stands, rounded.

    On a surface, one that is upright keeps its angles, one on a base plate is level with it and
    keeps its heading, and one that looks out does so. Among slots the nearest is taken.

    Parameters
    ----------
    sensor : Sensor
    mount : SurfaceMount or SlotMount
    vehicle : Vehicle, optional
        The body that the mount is a part of.
    housing : Housing, optional
        The sensor's, where it is known.

    Raises
    ------
    InputError
        When the mount has no faces, or there is no vehicle.
    """
    if isinstance(mount, SlotMount):
        return rounded(mount.nearest(sensor.pose.position).pose)
    who = f"sensor {sensor.name!r}"
    skin = Skin(who, mount, vehicle)
    domain = OnSurface(who, mount, skin, sensor.pose, housing, ALL_ROUND, anywhere=True)
    *foot, roll, pitch, yaw = domain.start
    if mount.orientation == "normal":
        roll = pitch = 0.0
    elif mount.orientation == "facing":
        roll = pitch = yaw = 0.0
    return domain.placed((*foot, roll, pitch, yaw))[0]
