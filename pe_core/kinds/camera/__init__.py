"""Cameras: the pixels that a voxel covers, and the vehicle that hides it."""

from .kind import CAMERA
from .model import Camera

__all__ = ["CAMERA", "Camera"]
