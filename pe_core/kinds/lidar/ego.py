"""Which beams of a LiDAR its own vehicle stops, by channel and azimuth."""

from __future__ import annotations

from typing import cast

import numpy as np

from ...scene.sensors import Sensor
from ...scene.vehicle import Vehicle
from ..ego_mask import EgoMask
from .beams import beam_field
from .model import Lidar
from .range_picture import columns_around


def revolution_mask(sensor: Sensor, vehicle: Vehicle | None) -> EgoMask:
    """Ask every beam, as far as its range, however near it is stopped."""
    lidar = cast(Lidar, sensor.model)
    stopped, azimuths = beam_field(sensor, vehicle).stopped_by, columns_around(lidar)
    rows, columns = (np.argsort(-angles, kind="stable") for angles in (lidar.elevations, azimuths))
    parts = stopped.reshape(len(rows), len(columns))[np.ix_(rows, columns)]
    return EgoMask(parts.astype(np.int32), lidar.elevations[rows], azimuths[columns])
