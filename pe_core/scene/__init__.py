"""What stands on the ground: poses, the space of voxels, mounted sensors, the vehicle's body."""

from .geometry import Pose, rotate, rotation_matrix, rpy_from_matrix
from .sensors import Rig, Sensor
from .space import PerceptionSpace
from .vehicle import Vehicle

__all__ = [
    "PerceptionSpace",
    "Pose",
    "Rig",
    "Sensor",
    "Vehicle",
    "rotate",
    "rotation_matrix",
    "rpy_from_matrix",
]
