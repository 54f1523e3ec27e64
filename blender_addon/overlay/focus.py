"""Focus regions as boxes with their factors; no scene, no GPU."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..engine import graphics
from .mounts import outline

if TYPE_CHECKING:
    from ..engine import pe
    from .wish import FocusRegion

HEIGHT_M = 2.0
"""Height of a box: about that of what is met in it. A focus itself holds at all heights."""
INSET_M = 0.15
"""Regions that share an edge, or the edge of the space, are drawn beside each other."""
MORE: graphics.Rgba = (0.98, 0.82, 0.30, 0.90)
LESS: graphics.Rgba = (0.62, 0.66, 0.74, 0.90)


def focus_regions(regions: Sequence[FocusRegion], space: pe.PerceptionSpace) -> graphics.LayerShape:
    """Return an outlined box for each area of each focus, cut to the space, with its label."""
    lines, labels = [], []
    for number, region in enumerate(regions):
        inset = INSET_M * (number + 1)
        color = MORE if region.factor >= 1.0 else LESS
        for area in region.areas:
            (x0, x1), (y0, y1) = (
                (max(low, edge[0]) + inset, min(high, edge[1]) - inset)
                for (low, high), edge in zip(area, (space.x, space.y), strict=True)
            )
            if x0 >= x1 or y0 >= y1:
                continue
            box = outline((x0, y0, 0.0), (x1, y1, min(HEIGHT_M, space.z[1])))
            lines.append(graphics.Primitives.of(box, color))
            place = ((x0 + x1) / 2.0, (y0 + y1) / 2.0, 0.0)
            labels.append(graphics.Tag(region_text(region), place, color))
    legend = graphics.ColorKey("Focus", classes=_classes(regions)) if lines else None
    return graphics.LayerShape(
        lines=graphics.Primitives.joined(lines), labels=tuple(labels), legend=legend
    )


def region_text(region: FocusRegion) -> str:
    """Return what stands in a region: its name, factor, and classes where not all are meant."""
    classes = "" if region.classes is None else f" ({', '.join(region.classes)})"
    return f"{region.name}: \u00d7 {region.factor:g}{classes}"


def _classes(regions: Sequence[FocusRegion]) -> tuple[tuple[graphics.Rgba, str], ...]:
    rows = ((MORE, "counts more", True), (LESS, "counts less", False))
    kinds = {region.factor >= 1.0 for region in regions}
    return tuple((color, text) for color, text, more in rows if more in kinds)
