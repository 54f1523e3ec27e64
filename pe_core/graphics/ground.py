"""The ground map as a coloured sheet: entropy, coverage, or how many sensors see a place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene import PerceptionSpace
from ..scoring import GroundMap
from ..sight import GroundSight
from .colors import CIVIDIS, COUNTS, VIRIDIS, Rgba, Scale, on_scale
from .primitives import ColorKey, GroundSheet, LayerShape

Floats = NDArray[np.float64]

ENTROPY, COVERAGE, SENSORS = "ENTROPY", "COVERAGE", "SENSORS"
BEST_NATS, UNSEEN_NATS = -10.976, 16.651
"""H of a place that is seen as well as can be, and of one that nobody sees: equations 4, 5, 8."""
COUNT_NAMES = ("nobody", "1 sensor", "2 sensors", "3 or more")
SWATCHES = 13
AS_SCORED = "as scored"
FADE_M = 8.0
"""Width of the margin in which the sheet fades out, where its edge is no edge of anything."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """Something that a ground map shows: its scale of colours from `low` to `high`."""

    title: str
    scale: Scale
    low: float
    high: float
    ticks: tuple[str, ...]

    def colors(self, values: Floats) -> NDArray[np.float32]:
        """(..., 3) colours of values (...)."""
        return on_scale((values - self.low) / (self.high - self.low), self.scale)

    @property
    def swatches(self) -> tuple[Rgba, ...]:
        """Colours from the low end to the high one."""
        row = on_scale(np.linspace(0.0, 1.0, SWATCHES), self.scale)
        return tuple((float(r), float(g), float(b), 1.0) for r, g, b in row)


@dataclass(frozen=True, slots=True, eq=False)
class AsScored:
    """A score's ground map, with the names that a `GroundSight` has; nobody has counted sensors."""

    x: Floats
    y: Floats
    step: float
    entropy: Floats
    coverage: Floats
    sensors: NDArray[np.int64]
    height: float | None = None


QUANTITIES = {
    ENTROPY: Quantity(
        "Entropy, nats", VIRIDIS, UNSEEN_NATS, BEST_NATS, ("16.7 unseen", "−11 sure")
    ),
    COVERAGE: Quantity("Coverage", CIVIDIS, 0.0, 1.0, ("0 %", "50 %", "100 %")),
}


def ground_map(
    seen: GroundSight | AsScored,
    quantity: str,
    opacity: float,
    *,
    faded: bool = True,
    where: str | None = None,
) -> LayerShape:
    """Return a ground map and its legend; transparent where the vehicle is.

    `faded`: towards the edges of what was looked at; `where` is what the legend says of heights.
    """
    where = where or _where(seen.height)
    if quantity == SENSORS:
        known = seen.sensors >= 0
        rgb = np.array(COUNTS, np.float32)[np.clip(seen.sensors, 0, 3)]
        classes = tuple(((*c, 1.0), name) for c, name in zip(COUNTS, COUNT_NAMES, strict=True))
        legend = ColorKey(f"Seen by, {where}", classes=classes)
    else:
        kind = QUANTITIES[quantity]
        values = seen.entropy if quantity == ENTROPY else seen.coverage
        known = np.isfinite(values)
        rgb = kind.colors(np.where(known, values, kind.low))
        legend = ColorKey(f"{kind.title}, {where}", kind.swatches, kind.ticks)
    alpha = np.where(known, opacity, 0.0) * (_fading(seen) if faded else 1.0)
    image = np.concatenate([rgb, alpha[..., None].astype(np.float32)], axis=-1)
    return LayerShape(sheet=_sheet(seen, image.transpose(1, 0, 2)), legend=legend)


def as_scored(found: GroundMap, space: PerceptionSpace, step: float) -> AsScored:
    """Return the ground map of a score in squares of about `step` [m]."""
    columns = max(1, round(step / space.interval))
    coarse, side = found.coarser(columns), columns * space.interval
    x, y = (
        low + side * (np.arange(count) + 0.5)
        for (low, _), count in zip((space.x, space.y), coarse.mass.shape, strict=True)
    )
    nobody = np.where(np.isfinite(coarse.entropy), 0, -1)
    return AsScored(x, y, side, coarse.entropy, coarse.coverage, nobody)


def _sheet(seen: GroundSight | AsScored, image: NDArray[np.float32]) -> GroundSheet:
    half = seen.step / 2.0
    low = (float(seen.x[0]) - half, float(seen.y[0]) - half)
    high = (float(seen.x[-1]) + half, float(seen.y[-1]) + half)
    return GroundSheet(np.ascontiguousarray(image, np.float32), low, high).prepared()


def _fading(seen: GroundSight | AsScored) -> Floats:
    """(NX, NY) 0 at the edges, 1 from `FADE_M` on."""
    x, y = (np.minimum(v - v[0], v[-1] - v) + seen.step / 2.0 for v in (seen.x, seen.y))
    edge = np.clip(np.minimum(x[:, None], y[None]) / FADE_M, 0.0, 1.0)
    return edge * edge * (3.0 - 2.0 * edge)


def _where(height: float | None) -> str:
    return "all heights" if height is None else f"{height:g} m high"
