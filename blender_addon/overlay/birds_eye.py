"""The bird's-eye view as plain arrays: which squares of the ground each picture paints, blind
ground and the vehicle; no scene, no GPU.

All of it is in the unit square that the plate fills: ahead is up, left is left. Pictures are taken
so that they fill the same square, see `operators.birds_eye`: a corner of a square is the place in
the picture, too.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..engine import Flags, Floats, Singles, graphics, sight
from .ground_layers import HATCH_ALPHA, hatch, smoothed

FROM_ABOVE = ""
"""The name of the picture of the vehicle, among those of cameras."""
HATCH_M = 0.6
BODY: graphics.Rgba = (0.92, 0.92, 0.92, 0.9)
Bounds = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class BirdsEye(graphics.LayerShape):
    """What a plate shows of the ground `x` by `y` [m]. `painted` are corners (3 T, 2) of triangles
    in the unit square by the name of the picture that fills them, `over` what is drawn on it."""

    x: Bounds = (0.0, 1.0)
    y: Bounds = (0.0, 1.0)
    painted: Mapping[str, Singles] = field(default_factory=dict)
    over: graphics.LayerShape = field(default_factory=graphics.LayerShape)
    blind_m2: float = 0.0


def birds_eye(seen: sight.SurroundView, palette: graphics.Palette = graphics.VIEWPORT) -> BirdsEye:
    """Return what a plate shows of a surround view."""
    half = seen.step / 2.0
    x, y = ((float(w[0]) - half, float(w[-1]) + half) for w in (seen.x, seen.y))
    own = seen.camera == sight.VEHICLE
    flags = {name: seen.camera == number for number, name in enumerate(seen.cameras)}
    narrow = (seen.camera == sight.NO_CAMERA) & ~seen.blind  # no test body fits in there
    flags[FROM_ABOVE] = own | narrow
    painted = {name: rectangles(each) for name, each in flags.items() if each.any()}

    def on_plate(points: Floats) -> Floats:
        left = (y[1] - points[:, 1]) / (y[1] - y[0])
        return np.column_stack([left, (points[:, 0] - x[0]) / (x[1] - x[0]), 0.0 * left])

    def around(squares: Flags) -> tuple[Floats, ...]:
        return sight.outlines(squares.astype(float), 0.5, seen.x, seen.y)

    blind = around(seen.blind)
    color = palette.blind
    edges = [
        graphics.Primitives.of(graphics.polyline(on_plate(smoothed(line))), shade)
        for lines, shade in ((blind, color), (around(own), BODY))
        for line in lines
    ]
    hatching = on_plate(hatch(blind, HATCH_M))
    thin = graphics.Primitives.of(hatching, graphics.with_alpha(color, HATCH_ALPHA))
    over = graphics.LayerShape(lines=graphics.Primitives.joined(edges), thin=thin)
    return BirdsEye(x=x, y=y, painted=painted, over=over, blind_m2=seen.area)


def rectangles(squares: Flags) -> Singles:
    """Return corners (6 R, 2) of triangles in the unit square that fill squares (NX, NY): a
    rectangle for each run along x. The first row, the rear, is at the bottom; the first column,
    the right, is at the right."""
    edges = np.diff(np.pad(squares.T[::-1], ((0, 0), (1, 1))).astype(np.int8), axis=1)
    column, first = np.nonzero(edges == 1)
    _, last = np.nonzero(edges == -1)
    across = 1.0 / squares.shape[1]
    along = 1.0 / squares.shape[0]
    low = np.column_stack([column * across, first * along])
    high = np.column_stack([(column + 1) * across, last * along])
    right, left = (np.column_stack([a[:, 0], b[:, 1]]) for a, b in ((high, low), (low, high)))
    corners = np.stack([low, right, high, low, high, left], axis=1)
    return np.ascontiguousarray(corners.reshape(-1, 2), np.float32)
