"""Axles of the vehicle, and axes where other programs have their origin; no scene, no GPU."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..engine import graphics

if TYPE_CHECKING:
    from ..engine import pe

USUAL_HALF_WIDTH_M, BEYOND_M = 0.9, 0.15
"""Half an axle where no vehicle is known, and how far it stands out of the body."""
AXIS_M = 0.6
AXES: tuple[graphics.Rgba, ...] = (
    (0.93, 0.3, 0.35, 1.0),
    (0.5, 0.8, 0.15, 1.0),
    (0.25, 0.55, 0.98, 1.0),
)
"""Blender's colours of x, y and z."""
FAINT = 0.55


def axles(reference: pe.Reference, half_width: float | None) -> graphics.LayerShape:
    """Return both axles as lines across, with axes on the ground under the middle of the rear one.

    `half_width` is the vehicle's [m]; lines go a little beyond it, and shine through the body.
    """
    half = BEYOND_M + (USUAL_HALF_WIDTH_M if half_width is None else half_width)
    x, z = reference.rear_axle_x, reference.rear_axle_z
    lines = [_across(x, z, half)]
    if reference.wheelbase is not None:
        lines.append(_across(x + reference.wheelbase, z, half))
    origin = np.array([x, 0.0, 0.0])
    for color, axis in zip(AXES, np.eye(3), strict=True):
        lines.append(graphics.Primitives.of([origin, origin + AXIS_M * axis], color))
    label = graphics.Tag("rear axle", (x, -half, z), graphics.VIEWPORT.words)
    return graphics.LayerShape(through=graphics.Primitives.joined(lines), labels=(label,))


def _across(x: float, z: float, half: float) -> graphics.Primitives:
    return graphics.Primitives.of(
        [(x, -half, z), (x, half, z)], graphics.with_alpha(graphics.VIEWPORT.words, FAINT)
    )
