"""A car that is a box, and sensors on it: what drawings of sensors are tried on."""

import numpy as np

import pe_core as pe


def box(low, high) -> pe.Vehicle:
    """Vehicle that is a box: (12, 3, 3) triangles."""
    corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, 8).T
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return pe.Vehicle(corners[np.array(faces)])


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
