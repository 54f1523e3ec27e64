"""Triangle mesh with named parts, and the options for the axes and the unit of a mesh file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from ..base.values import Number, choice, vector
from ..geometry.poses import ROTATION_DEG

AXIS_NAMES = ("+x", "-x", "+y", "-y", "+z", "-z")
SCALE = Number(0.0, above=True, cap=1e6)


@dataclass(frozen=True, slots=True)
class Mesh:
    """Triangles of one object; each triangle belongs to a named part.

    Attributes
    ----------
    triangles : (F, 3, 3) float64
        Corner coordinates in metres, ground frame (x forward, y left, z up);
        axis 1 is the corner, axis 2 the coordinate.
    parts : (F,) int32
        Index of each triangle's part in `part_names`.
    part_names : tuple of str
        Names of the parts; each part has a triangle, and names are unique.
    axes : str
        Text on how the file's axes were interpreted; empty if it is in the ground frame.
    """

    triangles: NDArray[np.float64]
    parts: NDArray[np.int32]
    part_names: tuple[str, ...]
    axes: str = ""


@dataclass(frozen=True, slots=True)
class MeshAxes:
    """Axes and scale of a mesh file, by a study; other values are from the file, or guessed.

    Parameters
    ----------
    up, forward : str, optional
        The file's axes that point up and forward, from `AXIS_NAMES`.
    scale : float
        Factor for lengths, applied after the file's own unit.
    rotation_deg : (3,) float, optional
        Roll, pitch, yaw [deg]: a rotation of the body, applied last. Then nothing is guessed.

    Raises
    ------
    InputError
        When an axis is unknown, both axes are parallel, the scale is not above 0, or the rotation
        is not three angles.
    """

    up: str | None = None
    forward: str | None = None
    scale: float = 1.0
    rotation_deg: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("up", "forward"):
            if (value := getattr(self, name)) is not None:
                choice("vehicle", name, value, AXIS_NAMES)
        if self.up and self.forward and self.up[1] == self.forward[1]:
            expected = f"an axis across up = {self.up}"
            raise InputError("vehicle", "forward", expected, self.forward)
        object.__setattr__(self, "scale", SCALE.checked("vehicle", "scale", self.scale))
        if self.rotation_deg is not None:
            angles = vector("vehicle", "rotation", self.rotation_deg, 3, ROTATION_DEG)
            object.__setattr__(self, "rotation_deg", angles)


AS_SAID = MeshAxes(rotation_deg=(0.0, 0.0, 0.0))
"""The axes that the file states, or the default axes of its format; nothing is guessed."""
