"""Geometry without sensors or vehicles: poses, grids, meshes, ray casting, convex shapes."""

from .grids import GroundGrid, PerceptionSpace
from .poses import Pose, rotate, rotation_matrix, rpy_from_matrix
