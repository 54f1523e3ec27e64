"""Plates in the corners of 3D views: none is drawn over another, however narrow the view.

Whoever draws a plate reserves its box at each redraw, or lets go of it; what is drawn later in the
same redraw stands above it. Plain numbers by region: nothing of Blender's is held.
"""

from __future__ import annotations

PlateBox = tuple[float, float, float, float]
"""Left, bottom, right, top in the region [px]."""

_boxes: dict[int, dict[str, PlateBox]] = {}


def reserve(region: int, plate: str, box: PlateBox | None) -> None:
    """Note where a plate stands in a region, by the region's pointer; None: it is not drawn."""
    boxes = _boxes.setdefault(region, {})
    if box is None:
        boxes.pop(plate, None)
    else:
        boxes[plate] = box


def forget(plate: str) -> None:
    """Let go of a plate in all regions."""
    for boxes in _boxes.values():
        boxes.pop(plate, None)


def boxes(region: int) -> tuple[PlateBox, ...]:
    """Return where plates stand in a region."""
    return tuple(_boxes.get(region, {}).values())


def bottom_above(region: int, sides: tuple[float, float], bottom: float, gap: float) -> float:
    """Return where a plate between two sides may begin so that it stands on no other one.

    Parameters
    ----------
    region : int
        The region's pointer.
    sides : (left, right)
        [px].
    bottom : float
        Where it would begin by itself [px].
    gap : float
        Left free between plates [px].
    """
    left, right = sides
    tops = [box[3] + gap for box in boxes(region) if box[0] - gap < right and left < box[2] + gap]
    return max([bottom, *tops])
