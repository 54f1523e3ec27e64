"""The edges of a field of view as lines: its border as far as it sees, and lines out to it."""

from __future__ import annotations

import numpy as np

from ..sight.outline import chained
from .solid import Floats, border
from .views import MountedView

SPOKES = 8
"""Lines from the sensor to each border; a picture's begins at a corner, so four go to corners."""


def view_wires(view: MountedView) -> list[Floats]:
    """Return lines (N, 3) in the ground frame [m]: closed borders, and spokes."""
    edges = border(view.faces)
    points = view.origin + view.directions * view.ends[:, None]
    lines = []
    for ring in chained(edges[:, 0], edges[:, 1]):
        lines.append(points[ring])
        start = ring.index(min(ring))
        around = np.array([*ring[start:-1], *ring[:start]])
        few = around[np.arange(SPOKES) * len(around) // SPOKES]
        lines += [np.stack([view.origin, point]) for point in points[few]]
    return lines
