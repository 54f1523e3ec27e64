"""A car that is a box, and sensors on it: what drawings of sensors are tried on."""

import numpy as np

import pe_core as pe
from tests.engine import shapes


def box(low, high) -> pe.Vehicle:
    """A vehicle that is a box."""
    return pe.Vehicle(shapes.box(low, high))


def car() -> pe.Vehicle:
    """A car as a box, 4 m long, 2 m wide, up to 1.5 m."""
    return box((-2.0, -1.0, 0.3), (2.0, 1.0, 1.5))


def lidar(elevations_deg=(10, 0, -10, -25, -40), azimuths=720, max_range=100.0, fov_deg=None):
    """A LiDAR of few channels."""
    fov = {} if fov_deg is None else {"horizontal_fov": tuple(np.radians(fov_deg))}
    return pe.Lidar("test", np.radians(elevations_deg), azimuths, max_range, **fov)


def mounted(model=None, position=(0.0, 0.0, 1.9), rotation=(0.0, 0.0, 0.0)) -> pe.Sensor:
    """A sensor over the car's roof."""
    pose = pe.Pose.from_degrees(position, rotation)
    return pe.Sensor("roof", lidar() if model is None else model, pose)
