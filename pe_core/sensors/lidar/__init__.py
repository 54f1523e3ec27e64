"""LiDARs: beams, the voxels they pass through, and the vehicle that occludes them."""

from .beams import BeamField, beam_field
from .field_of_view import RangePicture, range_picture
from .kind import LIDAR
from .model import ALL, RETURNS, Lidar
