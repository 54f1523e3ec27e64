"""The running search in the 3D view: its curve in the lower left corner, and its best placement.

The curve is drawn clear of the toolbar and of the panel of the last operation, and above the live
score.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import bpy

from . import viewport
from .viewport import FAINT, INK, PLATE, SMALL, Rgba

if TYPE_CHECKING:
    from .engine import pe

MIN_SPAN = 0.01
"""The entropy's axis covers at least this [nats]: noise is not to look like progress."""
TITLE = 13.0
WIDTH, HEIGHT = 268.0, 148.0
"""Of the plate, in pixels of an interface at scale 1; so are all lengths below."""
PAD, LEFT, TOP, BOTTOM = 10.0, 36.0, 26.0, 18.0
"""Round the plate's inside, and what axes and title take of it."""
PLATE_NAME = "search"
LINE_PX, AXIS_PX, DOT_PX = 2.0, 1.0, 5.0
AXIS: Rgba = (0.55, 0.55, 0.55, 1.0)
LINE: Rgba = (0.45, 0.78, 0.96, 1.0)


@dataclass(frozen=True, slots=True)
class SearchProgress:
    """How far a search is.

    `points` are the placements that became the best, (evaluation, figure) each, the start first;
    the figure is the entropy [nats], or with `by_ap` the expected AP, of which more is better;
    `tried` placements were evaluated so far. `sensors` are the best placement; none while that is
    the start. `sampled`: entropies are of a sample, hence approximate.
    """

    points: tuple[tuple[int, float], ...]
    tried: int
    sensors: tuple[pe.Sensor, ...] = ()
    sampled: bool = True
    by_ap: bool = False


searches: dict[str, SearchProgress] = {}
"""Running searches by the scene's name."""


def note(scene: str, progress: SearchProgress) -> None:
    """Show the progress of a scene's search in its views."""
    searches[scene] = progress


def best(scene: str) -> tuple[pe.Sensor, ...]:
    """Return the sensors of the best placement so far; none while that is the start."""
    progress = searches.get(scene)
    return () if progress is None else progress.sensors


def drop(scene: str) -> None:
    """Show a scene's search no longer."""
    searches.pop(scene, None)


class SearchCurve(NamedTuple):
    """A staircase of the best figure from the start to now, as plain numbers and text.

    `points` go from (0, 1), the start, to the right; 1 is the upper end of the axis.
    """

    points: tuple[tuple[float, float], ...]
    low: str
    high: str
    last: str
    title: str
    aside: str


def curve_of(progress: SearchProgress) -> SearchCurve:
    """Return the curve of a search; every point is a placement that became the best."""
    entropies = [entropy for _, entropy in progress.points]
    high, best = max(entropies), entropies[-1]
    low = min(min(entropies), high - MIN_SPAN)
    last = max(progress.tried, progress.points[-1][0], 2)
    steps: list[tuple[float, float]] = []
    for tried, entropy in progress.points:
        across, up = (tried - 1) / (last - 1), (entropy - low) / (high - low)
        steps += [(across, steps[-1][1])] if steps else []
        steps.append((across, up))
    steps.append((1.0, steps[-1][1]))
    about = "\N{ALMOST EQUAL TO} " if progress.sampled else ""
    title, aside = f"Best so far {about}{best:.3f} nats", f"from {entropies[0]:.3f}"
    if progress.by_ap:
        title = f"Best AP so far {about}{best:.3f}"
    digits = 3 if progress.by_ap else 2
    low_text, high_text = (f"{value:.{digits}f}" for value in (low, high))
    placements = f"{last:,} placements"
    return SearchCurve(tuple(steps), low_text, high_text, placements, title, aside)


_handlers = viewport.DrawHandlers()


def register() -> None:
    """Start drawing."""
    _handlers.show((draw, "POST_PIXEL"))


def unregister() -> None:
    """Stop drawing, and drop all searches."""
    searches.clear()
    _handlers.hide()
    viewport.release_plate(PLATE_NAME)
    viewport.redraw_editors()


def draw() -> None:
    """Draw into the current 3D view; Blender calls this at each redraw."""
    context = bpy.context
    progress = searches.get(context.scene.name)
    box = None
    if progress is not None and viewport.is_lower_left(context):
        scale = viewport.ui_scale()
        left, bottom = _corner(context)
        draw_curve(curve_of(progress), left, bottom, scale)
        box = left, bottom, left + WIDTH * scale, bottom + HEIGHT * scale
    viewport.reserve_plate(context.region.as_pointer(), PLATE_NAME, box)


def draw_curve(curve: SearchCurve, left: float, bottom: float, scale: float) -> None:
    """Draw a curve on a dark plate with that lower left corner [px]."""
    right, top = left + WIDTH * scale, bottom + HEIGHT * scale
    pad, small, gap = PAD * scale, SMALL * scale, 5.0 * scale
    x, y = left + pad + LEFT * scale, bottom + pad + BOTTOM * scale
    width = WIDTH * scale - 2.0 * pad - LEFT * scale
    height = HEIGHT * scale - 2.0 * pad - (TOP + BOTTOM) * scale

    def at(across: float, up: float) -> tuple[float, float]:
        return x + across * width, y + up * height

    viewport.fill_box((left, bottom, right, top), PLATE)
    viewport.draw_line([at(0, 1), at(0, 0), at(1, 0)], AXIS, AXIS_PX * scale)
    viewport.draw_line([at(*point) for point in curve.points], LINE, LINE_PX * scale)
    end_x, end_y = at(*curve.points[-1])
    half = DOT_PX * scale / 2.0
    viewport.fill_box((end_x - half, end_y - half, end_x + half, end_y + half), LINE)
    head = top - pad - TITLE * scale
    viewport.draw_text(curve.title, left + pad, head, TITLE * scale, INK)
    for text, text_x, text_y, ends in (
        (curve.aside, right - pad, head, 1.0),
        (curve.high, x - gap, y + height - 0.7 * small, 1.0),
        (curve.low, x - gap, y, 1.0),
        ("1", x, y - small - gap, 0.0),
        (curve.last, x + width, y - small - gap, 1.0),
    ):
        viewport.draw_text(text, text_x, text_y, small, FAINT, left_of_x=ends)


def _corner(context: bpy.types.Context) -> tuple[float, float]:
    """Return the lower left corner of the plate in the region [px]."""
    region, scale = context.region.as_pointer(), viewport.ui_scale()
    left, bottom = viewport.beside_toolbar(context), viewport.above_hud(context)
    sides, gap = (left, left + WIDTH * scale), viewport.MARGIN * scale / 2.0
    viewport.reserve_plate(region, PLATE_NAME, None)
    return left, viewport.free_bottom(region, sides, bottom, gap)
