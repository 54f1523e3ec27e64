"""LiDARs: beams, the voxels they pass, and the vehicle that stops them."""

from .beams import BeamField, beam_field
from .model import Lidar

__all__ = ["BeamField", "Lidar", "beam_field"]
