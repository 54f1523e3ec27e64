"""Where a search may put sensors: surfaces tinted, bounds and no-go areas as boxes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics

if TYPE_CHECKING:
    from .wish import MountFaces, SearchBox

Floats = NDArray[np.float64]

MOUNT: graphics.Rgba = (0.36, 0.80, 0.62, 1.0)
"""A calm green, far from the beams' blue and orange: legible on white and on black."""
TINT, STRONG, RIM = 0.34, 0.52, 0.95
"""How much of the body the tint hides: of a mount, and of the selected sensor's."""
BOUNDS: graphics.Rgba = (0.92, 0.92, 0.96, 0.80)
NO_GO: graphics.Rgba = (0.95, 0.45, 0.25, 0.95)
LIFT_M = 0.003
"""How far the tint stands off the surface, on both sides: it would flicker in it."""
CORNERS = np.array(list(product((0, 1), repeat=3)), float)
EDGES = [(a, b) for a in range(8) for b in range(a) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1]


def mounts(several: Sequence[MountFaces], boxes: Sequence[SearchBox]) -> graphics.LayerShape:
    """Return the tint of surfaces with their rims, and boxes."""
    faces, lines, classes = [], [], []
    for each in several:
        color = graphics.with_alpha(MOUNT, STRONG if each.strong else TINT)
        faces.append(graphics.Primitives.of(lifted(each.triangles), color))
        lines.append(graphics.Primitives.of(rim(each.triangles), graphics.with_alpha(MOUNT, RIM)))
    if several:
        classes.append((MOUNT, "a sensor may sit here"))
    for forbidden, color, words in ((False, BOUNDS, "bounds"), (True, NO_GO, "no-go area")):
        chosen = [box for box in boxes if box.forbidden == forbidden]
        lines += [graphics.Primitives.of(outline(box.low, box.high), color) for box in chosen]
        if chosen:
            classes.append((color, words))
    legend = graphics.ColorKey("Mounts", classes=tuple(classes)) if classes else None
    return graphics.LayerShape(
        lines=graphics.Primitives.joined(lines),
        faces=graphics.Primitives.joined(faces),
        legend=legend,
    )


def lifted(triangles: Floats) -> Floats:
    """Return triangles (F, 3, 3) twice, a little off the surface on either side (2 F, 3, 3).

    Corners that are one are moved as one: between flat pieces the surface would be seen.
    """
    if not len(triangles):
        return np.empty((0, 3, 3))
    faces = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    corner = _corners(triangles).reshape(-1)
    count = int(corner.max()) + 1
    each = np.repeat(faces, 3, axis=0)
    normal = np.stack([np.bincount(corner, each[:, k], count) for k in range(3)], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    away = LIFT_M * normal[corner].reshape(-1, 3, 3)
    return np.concatenate([triangles + away, triangles - away])


def rim(triangles: Floats) -> Floats:
    """Return ends (2 E, 3) of the edges that belong to one triangle alone."""
    if not len(triangles):
        return np.empty((0, 3))
    corner = _corners(triangles)
    starts, ends = corner.reshape(-1), np.roll(corner, -1, axis=1).reshape(-1)
    pairs = np.sort(np.stack([starts, ends], axis=1), axis=1)
    _, first, count = np.unique(pairs, axis=0, return_index=True, return_counts=True)
    alone = first[count == 1]
    after = np.roll(triangles, -1, axis=1).reshape(-1, 3)
    return np.stack([triangles.reshape(-1, 3)[alone], after[alone]], axis=1).reshape(-1, 3)


def _corners(triangles: Floats) -> NDArray[np.int64]:
    """(F, 3) which corners of triangles are one, to 0.01 mm."""
    points = np.round(triangles.reshape(-1, 3), 5) + 0.0
    return np.unique(points, axis=0, return_inverse=True)[1].reshape(-1, 3)


def outline(low: Sequence[float], high: Sequence[float]) -> Floats:
    """Return ends (24, 3) of a box's edges; it may be flat, or a line."""
    corners = np.array(low) + CORNERS * (np.array(high) - np.array(low))
    return corners[np.array(EDGES)].reshape(-1, 3)
