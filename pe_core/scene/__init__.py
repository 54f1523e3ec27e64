"""What stands on the ground: poses, the space of voxels, mounted sensors and their housings, the
vehicle's body."""

from .geometry import Pose, rotate, rotation_matrix, rpy_from_matrix
from .housing import Housing, cuts_body
from .objects import Objects
from .reference import Reference, guessed_reference
from .sensors import Rig, Sensor
from .simplify import simplified
from .space import PerceptionSpace
from .vehicle import Vehicle

__all__ = [
    "Housing",
    "Objects",
    "PerceptionSpace",
    "Pose",
    "Reference",
    "Rig",
    "Sensor",
    "Vehicle",
    "cuts_body",
    "guessed_reference",
    "rotate",
    "rotation_matrix",
    "rpy_from_matrix",
    "simplified",
]
