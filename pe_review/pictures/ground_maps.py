"""Maps of the ground from above: entropy, coverage, how many sensors and kinds see a place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, pe, sight
from ..markup import Markup
from .plan import PlanDrawing
from .svg import Canvas, hexadecimal

Floats = NDArray[np.float64]

RINGS = (10.0, 40.0)
"""Where the zones near, middle and far meet [m]."""
KEY_HIGH, KEY_WIDE = 34.0, 210.0
WORSE, SAME, BETTER = graphics.DIFFERENCE
MOST_CHANGE = 8.0
"""End of the scale of differences [nats]."""


@dataclass(frozen=True)
class MapLayer:
    """What a map shows of a `GroundSight`: a title, values (NX, NY), and their colours.

    `scale` runs from the left end of its key to the right; `ticks` stand below it, or names below
    swatches of their own where there are `classes`.
    """

    title: str
    about: str
    values: Callable[[sight.GroundSight], NDArray]
    colors: Callable[[NDArray], NDArray]
    ticks: tuple[str, ...] = ()
    scale: tuple[tuple[float, ...], ...] = ()
    classes: tuple[str, ...] = ()


def _shaded(name: str) -> Callable[[NDArray], NDArray]:
    return graphics.QUANTITIES[name].colors


def _counted(values: NDArray) -> NDArray:
    return np.array(graphics.COUNTS)[np.clip(values, 0, 3).astype(np.int64)]


ENTROPY = MapLayer(
    "Entropy",
    "nats, averaged over height as the score is; lower is better",
    lambda seen: seen.entropy,
    _shaded(graphics.ENTROPY),
    ("16.7 unseen", "\N{MINUS SIGN}11.0 best"),
    tuple(graphics.QUANTITIES[graphics.ENTROPY].swatches),
)
COVERAGE = MapLayer(
    "Coverage",
    "how much of a place some sensor sees, over its height",
    lambda seen: seen.coverage,
    _shaded(graphics.COVERAGE),
    graphics.QUANTITIES[graphics.COVERAGE].ticks,
    tuple(graphics.QUANTITIES[graphics.COVERAGE].swatches),
)
SENSORS = MapLayer(
    "Sensors that see a place",
    "any of it, at any height",
    lambda seen: seen.sensors,
    _counted,
    classes=("none", "1", "2", "3 or more"),
    scale=graphics.COUNTS,
)
KINDS = MapLayer(
    "Kinds of sensors that do",
    "two kinds fail in different ways",
    lambda seen: seen.kinds,
    _counted,
    classes=("none", "1", "2", "3 or more"),
    scale=graphics.COUNTS,
)
LAYERS = (ENTROPY, COVERAGE, SENSORS, KINDS)


def ground_map(
    seen: sight.GroundSight, layer: MapLayer, vehicle: pe.Vehicle | None, alt: str
) -> Markup:
    """Return a map as SVG: the same colours mean the same values on every one of its kind."""
    values = np.asarray(layer.values(seen), float)
    known = np.isfinite(values) & (seen.sensors >= 0)
    colors = np.asarray(layer.colors(np.where(known, values, 0.0)), float)
    return _drawn(seen, colors, known, layer, vehicle, alt)


def difference_map(
    first: sight.GroundSight,
    second: sight.GroundSight,
    vehicle: pe.Vehicle | None,
    alt: str,
    ends: tuple[str, str],
) -> Markup:
    """Return a map of where the second of two rigs has less entropy (blue), where more (orange).

    `ends` are the words at the ends of its key. Both maps are of the same places.
    """
    change = np.clip((second.entropy - first.entropy) / MOST_CHANGE, -1.0, 1.0)
    known = np.isfinite(change)
    share = 0.5 + 0.5 * np.where(known, change, 0.0)
    scale = (BETTER, SAME, WORSE)
    colors = np.asarray(graphics.on_scale(share, scale), float)
    row = tuple(tuple(c) for c in graphics.on_scale(np.linspace(0.0, 1.0, 13), scale).tolist())
    layer = MapLayer("", "", lambda s: s.entropy, lambda v: v, ends, row)
    return _drawn(second, colors, known, layer, vehicle, alt)


def _drawn(
    seen: sight.GroundSight,
    colors: Floats,
    known: NDArray[np.bool_],
    layer: MapLayer,
    vehicle: pe.Vehicle | None,
    alt: str,
) -> Markup:
    half = seen.step / 2.0
    bounds = tuple((float(w[0]) - half, float(w[-1]) + half) for w in (seen.x, seen.y))
    plan = PlanDrawing((bounds[0], bounds[1]), alt, KEY_HIGH)
    rgba = np.concatenate([colors[..., :3], known[..., None]], axis=-1)
    plan.cells(graphics.png_bytes(graphics.as_bytes(rgba.transpose(1, 0, 2)[::-1])))
    for radius in RINGS:
        plan.ring(radius, f"{radius:g} m")
    plan.vehicle(vehicle)
    plan.frame()
    draw_key(plan.canvas, layer, plan.left, plan.bottom + 30.0)
    return plan.canvas.svg()


def draw_key(canvas: Canvas, layer: MapLayer, left: float, top: float) -> None:
    """Draw what colours mean."""
    wide = KEY_WIDE / len(layer.scale)
    if layer.classes:
        at = left
        for color, name in zip(layer.scale, layer.classes, strict=True):
            canvas.add("rect", x=at, y=top, width=11.0, height=11.0, fill=hexadecimal(color))
            canvas.text(at + 16.0, top + 10.0, name)
            at += 34.0 + 7.5 * len(name)
        return
    for k, color in enumerate(layer.scale):
        size = {"width": wide + 0.4, "height": 9.0}
        canvas.add("rect", x=left + k * wide, y=top, fill=hexadecimal(color), **size)
    anchors = ("start", "middle", "end") if len(layer.ticks) == 3 else ("start", "end")
    for k, (tick, anchor) in enumerate(zip(layer.ticks, anchors, strict=True)):
        place = left + KEY_WIDE * k / (len(layer.ticks) - 1)
        canvas.text(place, top + 23.0, tick, text_anchor=anchor)
