"""LiDARs: beams, the voxels they pass, and the vehicle that stops them."""

from .beams import BeamField, beam_field
from .kind import LIDAR
from .model import Lidar

__all__ = ["LIDAR", "BeamField", "Lidar", "beam_field"]
