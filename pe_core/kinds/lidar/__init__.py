"""LiDARs: beams, the voxels they pass, and the vehicle that stops them."""

from .beams import BeamField, beam_field
from .kind import LIDAR
from .model import Lidar
from .range_picture import RangePicture, range_picture

__all__ = ["LIDAR", "BeamField", "Lidar", "RangePicture", "beam_field", "range_picture"]
