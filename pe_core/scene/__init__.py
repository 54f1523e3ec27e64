"""What stands on the ground: poses, the space of voxels, mounted sensors and their housings, the
vehicle's body."""

from .geometry import Pose, rotate, rotation_matrix, rpy_from_matrix
from .housing import Housing, cuts_body
from .sensors import Rig, Sensor
from .simplify import simplified
from .space import PerceptionSpace
from .vehicle import Vehicle

__all__ = [
    "Housing",
    "PerceptionSpace",
    "Pose",
    "Rig",
    "Sensor",
    "Vehicle",
    "cuts_body",
    "rotate",
    "rotation_matrix",
    "rpy_from_matrix",
    "simplified",
]
