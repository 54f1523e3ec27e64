"""Sensors with a body: a mesh of the housing's true size as the sensor object's own data.

The mesh is the sensor's, not an object beside it: it is selected, copied, hidden and deleted with
the sensor, and a sensor never stops its own beams.
"""

from .meshes import KEY, housing_mesh, known_housing

__all__ = ["KEY", "housing_mesh", "known_housing"]
