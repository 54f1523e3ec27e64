"""The body in the colours of a figure with one more sensor there; the region where one may go."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..engine import graphics
from .regions import offset_surface, rim

if TYPE_CHECKING:
    from ..engine import advice, jobs, pe

REASONS_NAMED = 3
TICKS = 3
NARROWEST = 0.01
"""The scale has all but 1 % of the values at either end; a narrower range would show noise."""
GREY: graphics.Rgba = (*graphics.FORBIDDEN, 1.0)
MARK = (1.0, 1.0, 1.0, 0.95)
INSIDE = (0.10, 0.75, 0.62, 0.55)
"""Colour of a free region: blue-green, as what is met."""


def place_colors(found: "jobs.PlaceMap", sensors: "Sequence[pe.Sensor]") -> graphics.LayerShape:
    """Return the surface in colours, bright is good, with the best place named. `sensors` are those
    of the scene: where they are not those that were scored with, the legend says so."""
    row = found.row
    figure = row.figure
    values = np.array([math.nan if e.value is None else e.value for e in found.places])
    points, normals = (
        np.array([getattr(each, name) for each in found.places]) for name in ("point", "normal")
    )
    known = values[np.isfinite(values)]
    low, high = np.percentile(known, (1.0, 99.0)).tolist() if len(known) else (0.0, 0.0)
    lack = max((1.0 if row.exact else NARROWEST) - (high - low), 0.0)
    low, high = (low - lack / 2.0, high + lack / 2.0)[:: 1 if row.sign < 0.0 else -1]
    faces = graphics.colored_surface(found.surface, points, normals, values, bounds=(low, high))
    ends = [low + (high - low) * k / (TICKS - 1) for k in range(TICKS)]
    classes = [(GREY, f"forbidden: {why} ({n:,})") for why, n in found.reasons().items()]
    unit = f" [{figure.unit}]" if figure.unit else ""
    title = f"{figure.label} with {found.sensor.model.name} here{unit}{_state(found, sensors)}"
    legend = graphics.ColorKey(
        f"{title}; small: its change",
        scale=graphics.swatches_of(graphics.VIRIDIS),
        ticks=tuple(f"{end:.{figure.decimals}f}" for end in ends),
        values=tuple(f"{end - found.base:+.{figure.decimals}f}" for end in ends),
        classes=tuple(classes[:REASONS_NAMED]),
    )
    labels = [
        graphics.Tag(f"best: {figure.text(e.value or 0.0)}", e.pose.position, MARK, strong=True)
        for e in found.best()
    ]
    return graphics.LayerShape(faces=faces, labels=tuple(labels), legend=legend)


def region_patch(found: "advice.FreeRegion", sensors: "Sequence[pe.Sensor]") -> graphics.LayerShape:
    """Return a free region with its outline, its tightest direction at the sensor, and a legend.
    `sensors` are those of the scene: where they have moved, the legend says so."""
    patch = found.patch
    row = found.row
    unit = f" {row.unit}".rstrip()
    lost = f"loses at most {row.number(found.allowed)}{unit} of {row.name}"
    classes = [(INSIDE, f"{found.area:.2f} of {found.mount_area:.2f} m²")]
    if found.typical_error:
        classes.append((INSIDE, f"standard error {row.number(found.typical_error)}{unit}"))
    moved = {(s.name, s.pose) for s in sensors} != {(s.name, s.pose) for s in found.rig}
    state = " (before the last change)" if moved else " (coarse)" if found.is_coarse else ""
    legend = graphics.ColorKey(f"{found.sensor} {lost}{state}", classes=tuple(classes))
    labels = []
    if (least := found.tightest) is not None:
        at = found.rig[found.sensor].pose.position
        labels.append(graphics.Tag(least.text, at, MARK, strong=True))
    return graphics.LayerShape(
        faces=graphics.Primitives.of(offset_surface(patch), INSIDE),
        lines=graphics.Primitives.of(rim(patch), graphics.with_alpha(INSIDE, 1.0)),
        labels=tuple(labels),
        legend=legend,
    )


def _state(found: "jobs.PlaceMap", sensors: "Sequence[pe.Sensor]") -> str:
    """Return how far the places are, how sure they are, or that they are of before a change."""
    if {(s.name, s.pose) for s in sensors} != {(s.name, s.pose) for s in found.rig}:
        return " (before the last change)"
    if len(found.places) < found.count:
        return f" ({len(found.places):,} of {found.count:,} places)"
    return f", ± {found.error:.{found.row.figure.decimals}f}" if found.error else ""
