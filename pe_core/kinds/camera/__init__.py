"""Cameras: the pixels that a voxel covers, and the vehicle that hides it."""

from .model import Camera

__all__ = ["Camera"]
