"""Ground round the vehicle that nobody sees: its outline, hatched, and how far it goes by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, sight

Floats = NDArray[np.float64]
Box = tuple[Floats, Floats]

HATCH_M, HATCH_ALPHA = 0.35, 0.45
LEAST_M = 0.3
"""Less is no more than a strip along the body: it is not measured."""
SMOOTHED = 9
"""Points of an outline whose mean is drawn: it runs along squares of 5 cm."""
SIDES = {"front": (0, 1), "rear": (0, -1), "left": (1, 1), "right": (1, -1)}
"""By side: the axis that leads there, and which way."""
TICK_M = 0.35
"""Half the length of the bar across the end of a measure."""


def blind_ground(
    found: sight.BlindGround,
    body: Box | None,
    height: float,
    palette: graphics.Palette = graphics.VIEWPORT,
) -> graphics.LayerShape:
    """Return outline, hatching and measures, on the ground.

    `body` are the vehicle's bounds; without one there is nothing to measure from.
    """
    color = palette.blind
    hatching = hatch(found.outlines, HATCH_M)
    thin = graphics.Primitives.of(
        _flat(hatching), graphics.with_alpha(color, color[3] * HATCH_ALPHA)
    )
    lines = [
        graphics.Primitives.of(graphics.polyline(_flat(smooth(line))), color)
        for line in found.outlines
    ]
    labels: list[graphics.Tag] = []
    for side in SIDES if body is not None else ():
        measure = _measure(found, body, side, palette)
        if measure is not None:
            lines.append(measure[0])
            labels.append(measure[1])
    title = f"Blind to what is {height:g} m tall" if height else "Blind to what lies flat"
    text = f"{found.area:.0f} m² within {found.within:g} m"
    legend = graphics.ColorKey(title, classes=((color, text),))
    return graphics.LayerShape(
        lines=graphics.Primitives.joined(lines), thin=thin, labels=tuple(labels), legend=legend
    )


def smooth(line: Floats) -> Floats:
    """(N, 2) running means along a closed line (N, 2); one of a few points stays as it is."""
    if len(line) < 4 * SMOOTHED:
        return line
    reach = SMOOTHED // 2
    row = np.arange(len(line) - 1)[:, None] + np.arange(-reach, reach + 1)
    mean = line[:-1][row % (len(line) - 1)].mean(axis=1)
    return np.vstack([mean, mean[:1]])


def hatch(outlines: Sequence[Floats], spacing_m: float) -> Floats:
    """(2 H, 2) ends of slanted lines inside closed outlines (N, 2), holes left out."""
    closed = [line for line in outlines if len(line) > 2]
    if not closed:
        return np.empty((0, 2))
    start = np.concatenate([line[:-1] for line in closed])
    end = np.concatenate([line[1:] for line in closed])
    # Along a hatching line x - y stays the same: count where edges pass each of its values.
    first, last = ((p[:, 0] - p[:, 1]) / spacing_m for p in (start, end))
    low, high = np.ceil(np.minimum(first, last)), np.ceil(np.maximum(first, last))
    count = (high - low).astype(np.int64)  # of the whole numbers in [low, high)
    edge = np.repeat(np.arange(len(start)), count)
    value = low[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    part = ((value - first[edge]) / (last - first)[edge])[:, None]
    points = start[edge] + part * (end - start)[edge]
    order = np.lexsort((points[:, 0], value))  # an even number on each line: in, out, in, out
    return points[order]


def _measure(
    found: sight.BlindGround, body: Box, side: str, palette: graphics.Palette
) -> tuple[graphics.Primitives, graphics.Tag] | None:
    """A line from the body to where blind ground begins or ends, and the metres beside it."""
    spot, zone = found.nearest[side], found.zone[side]
    if spot is None or (zone is not None and 0.0 < zone < LEAST_M):
        return None
    if zone is None:
        distance, text = found.within, f"blind beyond {found.within:g} m out"
    elif zone:
        distance, text = zone, f"blind to {sight.shown_end(zone):.1f} m out"
    else:
        distance, text = spot.distance, f"blind from {sight.shown_start(spot.distance):.1f} m out"
    axis, sign = SIDES[side]
    end = np.zeros(3)
    end[axis] = body[1 if sign > 0 else 0][axis] + sign * distance
    end[1 - axis] = spot.point[1 - axis]
    return _measured(end, axis, sign, distance, palette.words), _label(end, text, palette.words)


def _measured(
    end: Floats, axis: int, sign: int, distance: float, color: graphics.Rgba
) -> graphics.Primitives:
    """A line as long as measured, with a bar across its end."""
    start, across = end.copy(), np.zeros(3)
    start[axis] -= sign * distance
    across[1 - axis] = TICK_M
    return graphics.Primitives.of(
        [start, end, end - across, end + across], graphics.with_alpha(color, 0.7)
    )


def _label(place: Floats, text: str, color: graphics.Rgba) -> graphics.Tag:
    x, y, z = place.tolist()
    return graphics.Tag(text, (x, y, z), color)


def _flat(points: Floats) -> Floats:
    """(N, 3) points on the ground."""
    return np.column_stack([points, np.zeros(len(points))])
