"""The ground as coloured cells: maps of what is seen, and samples of a requirement's zone."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats
from pe_core.scene import PerceptionSpace
from pe_core.scoring import GroundMap
from pe_core.scoring.requirements import Verdict
from pe_core.scoring.sight import GroundSight

from .colors import CIVIDIS, COUNTS, DIFFERENCE_ON_DARK, VIRIDIS, Rgba, Scale, on_scale
from .primitives import ColorKey, GroundSheet, LayerShape

BADLY_SEEN = "badly seen"  # The dark end of colours that begin above what nobody sees
ENTROPY = "ENTROPY"
COVERAGE = "COVERAGE"
SENSORS = "SENSORS"
BEST_NATS = -10.976
UNSEEN_NATS = 16.651
"""H of a place that is seen as well as can be, and of one that nobody sees: equations 4, 5, 8."""
COUNT_NAMES = ("nobody", "1 sensor", "2 sensors", "3 or more")
SWATCHES = 13
AS_SCORED = "as scored"
PERCENT_LEFT_OUT = 2.0
"""Share of the places, at each end, that a fitted range of colours leaves out [%]."""
STEPS = {ENTROPY: 0.5, COVERAGE: 0.05}  # Fitted ranges end at multiples of these [nats; share]
NARROWEST = {ENTROPY: 2.0, COVERAGE: 0.1}  # A narrower range would show grain
ROUNDING = 1e-9
ALIKE_ALPHA = 0.08
DIFFERENCE_GAIN = 2.0
"""How much of a place that is alike is seen, and how much stronger than a map differences are."""
FADE_M = 8.0
"""Width of the margin in which the sheet fades out, where its edge is no edge of anything."""
SPOT_M = 0.3  # Size at which samples of paths and single spots are painted at least


def swatches_of(scale: Scale) -> tuple[Rgba, ...]:
    """Return colours of a scale from its low end to its high one."""
    row = on_scale(np.linspace(0.0, 1.0, SWATCHES), scale)
    return tuple((float(r), float(g), float(b), 1.0) for r, g, b in row)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity of a ground map: its scale of colours from `low`, dark, to `high`, bright. Bright
    is good; `ticks` are the words for the ends. `shares`: values are shares, 0 to 1."""

    title: str
    scale: Scale
    low: float
    high: float
    ticks: tuple[str, ...]
    shares: bool = False

    def within(self, low: float, high: float) -> Quantity:
        """Return the quantity with its colours spread from `low` to `high` alone."""
        dark = self.ticks[0] if low == self.low else BADLY_SEEN
        return replace(self, low=low, high=high, ticks=(dark, *self.ticks[1:]))

    @property
    def values(self) -> tuple[str, ...]:
        """The values at the ends and in the middle, as texts."""
        unit = "" if self.shares else " nats"
        ends = (self.low, (self.low + self.high) / 2.0, self.high)
        return tuple(f"{self.text(value)}{unit}" for value in ends)

    def text(self, value: float) -> str:
        """Return a value as a legend has it: "1.5", or "85 %"."""
        text = f"{100.0 * value:.0f} %" if self.shares else f"{value:.1f}"
        return text.replace("-", "\N{MINUS SIGN}")

    def colors(self, values: Floats) -> NDArray[np.float32]:
        """(..., 3) colours of values (...)."""
        return on_scale((values - self.low) / (self.high - self.low), self.scale)

    @property
    def swatches(self) -> tuple[Rgba, ...]:
        """Colours from the low end to the high one."""
        return swatches_of(self.scale)


QUANTITIES = {
    ENTROPY: Quantity("Entropy", VIRIDIS, UNSEEN_NATS, BEST_NATS, ticks=("unseen", "well seen")),
    COVERAGE: Quantity(
        "Coverage", CIVIDIS, low=0.0, high=1.0, ticks=("unseen", "all seen"), shares=True
    ),
}


def ground_map(
    seen: GroundSight,
    quantity: str,
    opacity: float,
    *,
    faded: bool = True,
    where: str | None = None,
    bounds: tuple[float, float] | None = None,
) -> LayerShape:
    """Return a ground map and its legend; transparent where the vehicle is. `quantity`: A key of
    `QUANTITIES`, or `SENSORS`. `faded`: whether the map fades out towards the edges of the
    evaluated area. `where`: text of the legend about heights. `bounds` (float, float): values of
    the dark and the bright end of the colours (`fitted_bounds`), the better one bright."""
    where = where or _where(seen.height)
    if quantity == SENSORS:
        is_known = seen.sensors >= 0
        rgb = np.array(COUNTS, np.float32)[np.clip(seen.sensors, 0, 3)]
        classes = tuple(((*c, 1.0), name) for c, name in zip(COUNTS, COUNT_NAMES, strict=True))
        legend = ColorKey(f"Seen by, {where}", classes=classes)
    else:
        kind = QUANTITIES[quantity] if bounds is None else QUANTITIES[quantity].within(*bounds)
        values = values_of(seen, quantity)
        is_known = np.isfinite(values)
        rgb = kind.colors(np.where(is_known, values, kind.low))
        legend = ColorKey(
            f"{kind.title}, {where}",
            kind.swatches,
            kind.ticks,
            bounds=(kind.low, kind.high),
            values=kind.values,
        )
    return _shape(seen, rgb, np.where(is_known, opacity, 0.0), faded, legend=legend)


def difference_map(
    seen: GroundSight, before: GroundSight, quantity: str, opacity: float, *, name: str = ""
) -> LayerShape:
    """Return a map of where one rig is better than another (blue), and where it is worse (orange).
    Differences are in nats, or in shares, by a key of `QUANTITIES`. Locations without a difference
    are nearly transparent. `name` is that of the compared rig, for the legend."""
    kind = QUANTITIES[quantity]
    sign = -1.0 if quantity == ENTROPY else 1.0
    better = sign * (values_of(seen, quantity) - values_of(before, quantity))
    is_known = np.isfinite(better)
    # The ends of the colours fit what is shown: most locations do not differ.
    step = STEPS[quantity]
    size = np.abs(better[is_known])
    size = size[size > step / 10.0]
    high = float(np.percentile(size, 95.0)) if len(size) else 0.0
    end = max(step, math.ceil(high / step - ROUNDING) * step)
    share = np.clip(np.where(is_known, better, 0.0) / end, -1.0, 1.0)
    rgb = on_scale(0.5 + 0.5 * share, DIFFERENCE_ON_DARK)
    strength = ALIKE_ALPHA + (1.0 - ALIKE_ALPHA) * np.abs(share)
    value = f"{kind.text(end)}{' nats' if quantity == ENTROPY else ''}"
    title = f"{kind.title} against {name or 'before'}, {_where(seen.height)}"
    swatches = swatches_of(DIFFERENCE_ON_DARK)
    legend = ColorKey(
        title, swatches, ("worse", "better"), classes=(), bounds=(-end, end), values=(value, value)
    )
    alpha = np.where(is_known, np.minimum(1.0, DIFFERENCE_GAIN * opacity) * strength, 0.0)
    return _shape(seen, rgb, alpha, faded=True, legend=legend)


def values_of(seen: GroundSight, quantity: str) -> Floats:
    """(NX, NY) values of a quantity (`QUANTITIES`)."""
    return seen.entropy if quantity == ENTROPY else seen.coverage


def fitted_bounds(seen: GroundSight, quantity: str) -> tuple[float, float]:
    """Return values for the dark and the bright end of the colours that fit what is shown.
    Percentiles of the map's places, rounded outwards; never narrower than `NARROWEST`."""
    values = values_of(seen, quantity)
    values = values[np.isfinite(values)]
    kind = QUANTITIES[quantity]
    if not len(values):
        return kind.low, kind.high
    step = STEPS[quantity]
    low, high = np.percentile(values, (PERCENT_LEFT_OUT, 100.0 - PERCENT_LEFT_OUT)).tolist()
    low = math.floor(low / step + ROUNDING) * step
    high = math.ceil(high / step - ROUNDING) * step
    lack = NARROWEST[quantity] - (high - low)
    if lack > 0.0:
        low = low - lack / 2.0
        high = high + lack / 2.0
    lower_limit, upper_limit = sorted((kind.low, kind.high))
    low = max(lower_limit, low)
    high = min(upper_limit, high)
    return (low, high) if kind.low < kind.high else (high, low)


def _shape(
    seen: GroundSight, rgb: NDArray[np.float32], alpha: Floats, faded: bool, legend: ColorKey
) -> LayerShape:
    """Return a sheet in these colours (NX, NY, 3), as opaque as `alpha` (NX, NY) says."""
    half = seen.step / 2.0
    if faded:
        x, y = (np.minimum(v - v[0], v[-1] - v) + half for v in (seen.x, seen.y))
        edge = np.clip(np.minimum(x[:, None], y[None]) / FADE_M, 0.0, 1.0)
        alpha = alpha * (edge * edge * (3.0 - 2.0 * edge))
    image = np.concatenate([rgb, alpha[..., None].astype(np.float32)], axis=-1)
    low = (float(seen.x[0]) - half, float(seen.y[0]) - half)
    high = (float(seen.x[-1]) + half, float(seen.y[-1]) + half)
    image = np.ascontiguousarray(image.transpose(1, 0, 2), np.float32)
    return LayerShape(sheet=GroundSheet(image, low, high).prepared(), legend=legend)


def as_scored(found: GroundMap, space: PerceptionSpace, step: float) -> GroundSight:
    """Return the ground map of a score in squares of about `step` [m], without any numbers."""
    columns = max(1, round(step / space.interval))
    coarse = found.coarser(columns)
    side = columns * space.interval
    x, y = (
        low + side * (np.arange(count) + 0.5)
        for (low, _), count in zip((space.x, space.y), coarse.mass.shape, strict=True)
    )
    nobody = np.where(np.isfinite(coarse.entropy), 0, -1)
    return GroundSight(
        x=x,
        y=y,
        step=side,
        height=None,
        entropy=coarse.entropy,
        coverage=coarse.coverage,
        sensors=nobody,
        kinds=nobody,
    )


def _where(height: float | None) -> str:
    return "all heights" if height is None else f"{height:g} m high"


def painted_samples(verdict: Verdict) -> tuple[Floats, Floats, float]:
    """Return the samples that pass (N, 2), those that fail (M, 2), and the size of one [m]. Of
    blind ground these are the squares of the zone that are seen and those that are blind."""
    samples = verdict.samples
    if verdict.ground is not None:
        cells = verdict.ground.cells
        blind = verdict.ground.blind
        mask = samples.mask
        places = np.stack(np.meshgrid(cells.x, cells.y, indexing="ij"), axis=-1)
        inside = np.ones(blind.shape, bool) if mask is None else mask
        return places[inside & ~blind], places[inside & blind], cells.step
    points = samples.points
    inside = samples.inside
    ok = verdict.passed
    step = samples.zone.zone.step
    if samples.zone.kind in ("path", "spots"):
        size = max(step, SPOT_M)
    else:
        # A preview has samples farther apart than the zone's step.
        gaps = np.diff(np.unique(points[inside, 0])) if inside.any() else np.zeros(0)
        gaps = gaps[gaps > step / 2.0]
        size = float(gaps.min()) if len(gaps) else step
        if samples.zone.zone.x is None:  # corners of its outline lie between the samples
            size = max(step, size)
    return points[inside & ok], points[inside & ~ok], size
