"""Regions as boxes and tinted surfaces: mounts, bounds, no-go areas, focus; no scene, no GPU."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..engine import Floats, graphics

if TYPE_CHECKING:
    from ..choices import FocusRegion, LimitBox
    from ..engine import pe
    from .request import MountFaces


MOUNT: graphics.Rgba = (0.36, 0.80, 0.62, 1.0)
"""A calm green, unlike the beams' blue and orange: visible on white and on black."""
TINT_ALPHA = 0.34
STRONG_ALPHA = 0.52
RIM_ALPHA = 0.95
"""Opacity of the tint: of a mount, and of the selected sensor's mount."""
BOUNDS: graphics.Rgba = (0.92, 0.92, 0.96, 0.80)
NO_GO: graphics.Rgba = (0.95, 0.45, 0.25, 0.95)
LIFT_M = 0.003
"""Distance of the tint from the surface, on both sides: it would flicker in it."""
FOCUS_HEIGHT_M = 2.0
"""Height of a box: about that of objects in it. The focus itself holds at all heights."""
INSET_M = 0.15  # Distance of neighbouring boxes: regions may share an edge
MORE_COLOR: graphics.Rgba = (0.98, 0.82, 0.30, 0.90)
LESS_COLOR: graphics.Rgba = (0.62, 0.66, 0.74, 0.90)


def mount_regions(
    several: "Sequence[MountFaces]", boxes: "Sequence[LimitBox]"
) -> graphics.LayerShape:
    """Return the tint of surfaces with their rims, and boxes."""
    faces = []
    lines = []
    classes = []
    for each in several:
        color = graphics.with_alpha(MOUNT, STRONG_ALPHA if each.strong else TINT_ALPHA)
        faces.append(graphics.Primitives.of(offset_surface(each.triangles), color))
        lines.append(
            graphics.Primitives.of(rim(each.triangles), graphics.with_alpha(MOUNT, RIM_ALPHA))
        )
    if several:
        classes.append((MOUNT, "a sensor may be mounted here"))
    for forbidden, color, words in ((False, BOUNDS, "bounds"), (True, NO_GO, "no-go area")):
        chosen = [box for box in boxes if box.forbidden == forbidden]
        lines += [graphics.Primitives.of(box_edges(box.low, box.high), color) for box in chosen]
        if chosen:
            classes.append((color, words))
    legend = graphics.ColorKey("Mounts", classes=tuple(classes)) if classes else None
    return graphics.LayerShape(
        lines=graphics.Primitives.joined(lines),
        faces=graphics.Primitives.joined(faces),
        legend=legend,
    )


def offset_surface(triangles: Floats) -> Floats:
    """Return triangles (F, 3, 3) twice, a little off the surface on either side (2 F, 3, 3). Shared
    corners are moved together: otherwise gaps would show the surface."""
    if not len(triangles):
        return np.empty((0, 3, 3))
    faces = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    corner = _corners(triangles).reshape(-1)
    count = int(corner.max()) + 1
    each = np.repeat(faces, 3, axis=0)
    normal = np.stack([np.bincount(corner, each[:, k], count) for k in range(3)], axis=1)
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    away = LIFT_M * normal[corner].reshape(-1, 3, 3)
    return np.concatenate([triangles + away, triangles - away])


def rim(triangles: Floats) -> Floats:
    """Return ends (2 E, 3) of the edges that belong to one triangle alone."""
    if not len(triangles):
        return np.empty((0, 3))
    corner = _corners(triangles)
    starts = corner.reshape(-1)
    ends = np.roll(corner, -1, axis=1).reshape(-1)
    pairs = np.sort(np.stack([starts, ends], axis=1), axis=1)
    _, first, count = np.unique(pairs, axis=0, return_index=True, return_counts=True)
    alone = first[count == 1]
    after = np.roll(triangles, -1, axis=1).reshape(-1, 3)
    return np.stack([triangles.reshape(-1, 3)[alone], after[alone]], axis=1).reshape(-1, 3)


def _corners(triangles: Floats) -> NDArray[np.int64]:
    """Return the number (F, 3) of each corner; corners equal to 0.01 mm share one."""
    points = np.round(triangles.reshape(-1, 3), 5) + 0.0
    return np.unique(points, axis=0, return_inverse=True)[1].reshape(-1, 3)


def box_edges(low: Sequence[float] | Floats, high: Sequence[float] | Floats) -> Floats:
    """Return ends (24, 3) of a box's edges; it may be flat, or a line."""
    corners = np.array(low) + (graphics.CORNERS + 0.5) * (np.array(high) - np.array(low))
    return corners[np.array(graphics.EDGES)].reshape(-1, 3)


def focus_regions(
    regions: "Sequence[FocusRegion]", space: "pe.PerceptionSpace"
) -> graphics.LayerShape:
    """Return an outlined box for each area of each focus, cut to the space, with its label."""
    lines = []
    labels = []
    for number, region in enumerate(regions):
        inset = INSET_M * (number + 1)
        color = MORE_COLOR if region.factor >= 1.0 else LESS_COLOR
        for area in region.areas:
            (x0, x1), (y0, y1) = (
                (max(low, edge[0]) + inset, min(high, edge[1]) - inset)
                for (low, high), edge in zip(area, (space.x, space.y), strict=True)
            )
            if x0 >= x1 or y0 >= y1:
                continue
            box = box_edges((x0, y0, 0.0), (x1, y1, min(FOCUS_HEIGHT_M, space.z[1])))
            lines.append(graphics.Primitives.of(box, color))
            place = ((x0 + x1) / 2.0, (y0 + y1) / 2.0, 0.0)
            classes = "" if region.classes is None else f" ({', '.join(region.classes)})"
            text = f"{region.name}: \u00d7 {region.factor:g}{classes}"
            labels.append(graphics.Tag(text, place, color))
    legend = graphics.ColorKey("Focus", classes=_classes(regions)) if lines else None
    return graphics.LayerShape(
        lines=graphics.Primitives.joined(lines), labels=tuple(labels), legend=legend
    )


def _classes(regions: "Sequence[FocusRegion]") -> tuple[tuple[graphics.Rgba, str], ...]:
    rows = ((MORE_COLOR, "counts more", True), (LESS_COLOR, "counts less", False))
    kinds = {region.factor >= 1.0 for region in regions}
    return tuple((color, text) for color, text, more in rows if more in kinds)
