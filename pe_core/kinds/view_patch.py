"""Where a sensor looks, as a piece of the unit sphere in triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class ViewPatch:
    """A sensor's field of view: directions that triangles of the unit sphere connect.

    Attributes
    ----------
    directions : (N, 3) float
        Unit, sensor frame.
    faces : (F, 3) int
        Indices into them, counter-clockwise as seen from outside.
    """

    directions: Floats
    faces: Ints


def grid_faces(index: Ints, *, closed: bool) -> Ints:
    """Return the triangles (F, 3) of a grid of points (R, C), whose rows may close to rings.

    Rows go up and columns to the right as seen from outside. Triangles that have a point twice,
    as at a pole, are left out.
    """
    if closed:
        index = np.hstack([index, index[:, :1]])
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=2)
    faces = faces.reshape(-1, 3)
    pairs = ((0, 1), (1, 2), (2, 0))
    whole = np.logical_and.reduce([faces[:, i] != faces[:, j] for i, j in pairs])
    return faces[whole]
