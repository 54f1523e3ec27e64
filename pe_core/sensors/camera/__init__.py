"""Cameras: the pixels that a voxel covers, and the vehicle that hides it."""

from .kind import CAMERA
from .lens import Lens
from .lens_models import BrownConrady, FTheta, KannalaBrandt, Pinhole
from .model import Camera

__all__ = ["CAMERA", "BrownConrady", "Camera", "FTheta", "KannalaBrandt", "Lens", "Pinhole"]
