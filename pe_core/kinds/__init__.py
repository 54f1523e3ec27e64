"""Kinds of sensors: one folder a kind, with its beams or pixels and all that counts them."""

from .camera import Camera
from .lidar import BeamField, Lidar, beam_field
from .measure import measure

__all__ = ["BeamField", "Camera", "Lidar", "beam_field", "measure"]
