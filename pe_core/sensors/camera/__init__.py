"""Cameras: the pixels that a voxel covers, and the vehicle that hides it."""

from .kind import CAMERA
from .lens import BrownConrady, FTheta, KannalaBrandt, Lens, Pinhole
from .model import Camera
