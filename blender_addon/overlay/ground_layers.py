"""Layers on the ground: the ground map, blind ground and reach; no scene, no GPU."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..engine import Floats, graphics, pe, sight
from ..view.view_settings import WHOLE

if TYPE_CHECKING:
    from .layer_cache import LayerCache
    from .request import ViewRequest


COARSE_M = 1.5
FINE_M = 0.5
"""Side of the ground map's cells while something moves, and when idle."""
MAX_CELLS = 60_000
NOTHING_TO_COMPARE = "Difference: nothing to compare with yet"
BoxBounds = tuple[Floats, Floats]
HATCH_M = 0.35
HATCH_ALPHA = 0.45
MIN_ZONE_M = 0.3
"""A shorter zone is no more than a strip along the vehicle: it has no measure."""
SMOOTHED_POINTS = 9
"""Points of the running mean that is drawn of an outline: it follows cells of 5 cm."""
SIDES = {"front": (0, 1), "rear": (0, -1), "left": (1, 1), "right": (1, -1)}
"""By side: the axis that leads there, and its sign."""
TICK_M = 0.35  # Half the length of the bar across the end of a measure
REACH_AP = 0.5  # The average precision from which an object counts as detected
BEARINGS = 72
LABEL_COUNT = 8
"""At how many bearings the distance is written."""
MIN_LABEL_M = 1.0
CUT_ALPHA = 0.25


def ground_map(request: ViewRequest, cache: LayerCache) -> graphics.LayerShape:
    """Return the requested ground map with its legend."""
    view = request.view
    if shows_difference(request):
        return _difference(request, cache)
    scored = scored_map(request)
    where = None
    if scored is not None and request.space is not None:
        seen = graphics.as_scored(scored, request.space, FINE_M)
        where = graphics.AS_SCORED
    else:
        seen = _ground_sight(request, cache, pe.Rig([e.sensor for e in request.counted]))
    bounds = _bounds(request, cache, seen)
    return graphics.ground_map(
        seen, view.ground_quantity, view.ground_opacity, where=where, bounds=bounds
    )


def shows_difference(request: ViewRequest) -> bool:
    """Whether a difference map is shown; the number of sensors has no difference map."""
    view = request.view
    is_asked = view.ground_difference and not request.is_wiped
    return is_asked and view.ground_quantity != graphics.SENSORS


def scored_map(request: ViewRequest) -> pe.GroundMap | None:
    """Return the score's own map, if it is to be shown."""
    view = request.view
    averaged = view.ground_height_m is None and view.ground_quantity != graphics.SENSORS
    is_own = averaged and not request.is_wiped and not shows_difference(request)
    return request.scored if is_own else None


def compared_key(request: ViewRequest) -> Hashable:
    """Return a key of the compared rig; None without a difference map."""
    if not shows_difference(request):
        return None
    return request.compared_name, *(
        (s.name, id(s.model), s.pose, s.group) for s in request.compared
    )


def step_of(space: pe.PerceptionSpace, *, moving: bool) -> float:
    """Return the side of the ground map's cells [m]: larger in a very large space."""
    x0, x1 = space.x
    y0, y1 = space.y
    least, most = (COARSE_M, MAX_CELLS // 4) if moving else (FINE_M, MAX_CELLS)
    return max(least, math.sqrt((x1 - x0) * (y1 - y0) / most))


def _ground_sight(request: ViewRequest, cache: LayerCache, rig: pe.Rig) -> sight.GroundSight:
    assert request.space is not None  # the layer has no key without one
    step = step_of(request.space, moving=request.moving)
    return cache.sight(request).ground(rig, request.view.ground_height_m, step)


def _difference(request: ViewRequest, cache: LayerCache) -> graphics.LayerShape:
    """Return the difference map of both rigs, on the same voxels and by the same rules."""
    if not request.compared:
        return graphics.LayerShape(legend=graphics.ColorKey(NOTHING_TO_COMPARE))
    view = request.view
    of = (
        compared_key(request),
        view.ground_height_m,
        request.moving,
        request.body_key,
        request.prior_key,
    )
    before = cache.compared(of, lambda: _ground_sight(request, cache, pe.Rig(request.compared)))
    seen = _ground_sight(request, cache, pe.Rig([each.sensor for each in request.counted]))
    return graphics.difference_map(
        seen, before, view.ground_quantity, view.ground_opacity, name=request.compared_name
    )


def _bounds(
    request: ViewRequest, cache: LayerCache, seen: sight.GroundSight
) -> tuple[float, float] | None:
    """Return the values at the ends of the colours: kept while a sensor moves, and once scored."""
    view = request.view
    if view.ground_quantity == graphics.SENSORS or view.ground_range == WHOLE:
        return None
    of = view.ground_quantity, view.ground_height, request.prior_key, view.ground_fits
    return cache.fitted(
        of,
        lambda: graphics.fitted_bounds(seen, view.ground_quantity),
        anew=not request.moving and not request.is_wiped,  # both sides in the same colours
        scored=request.has_result,
    )


def blind_ground(
    found: sight.BlindGround,
    body: BoxBounds | None,
    height: float,
    palette: graphics.Palette = graphics.VIEWPORT,
) -> graphics.LayerShape:
    """Return outline, hatching and measures, on the ground. `body` are the vehicle's bounds;
    without one there is nothing to measure from."""
    color = palette.blind
    hatching = hatch(found.outlines, HATCH_M)
    thin = graphics.Primitives.of(
        _flat(hatching), graphics.with_alpha(color, color[3] * HATCH_ALPHA)
    )
    lines = [
        graphics.Primitives.of(graphics.polyline(_flat(smoothed(line))), color)
        for line in found.outlines
    ]
    labels: list[graphics.Tag] = []
    for side in SIDES:
        measure = None if body is None else _measure(found, body, side, palette)
        if measure is not None:
            lines.append(measure[0])
            labels.append(measure[1])
    title = f"Blind to what is {height:g} m tall" if height else "Blind to what lies flat"
    text = f"{sight.shown_end(found.area):.1f} m² within {found.within:g} m"
    legend = graphics.ColorKey(title, classes=((color, text),))
    return graphics.LayerShape(
        lines=graphics.Primitives.joined(lines), thin=thin, labels=tuple(labels), legend=legend
    )


def smoothed(line: Floats) -> Floats:
    """Return running means (N, 2) along a closed line (N, 2); a line of few points is unchanged."""
    if len(line) < 4 * SMOOTHED_POINTS:
        return line
    reach = SMOOTHED_POINTS // 2
    row = np.arange(len(line) - 1)[:, None] + np.arange(-reach, reach + 1)
    mean = line[:-1][row % (len(line) - 1)].mean(axis=1)
    return np.vstack([mean, mean[:1]])


def hatch(outlines: Sequence[Floats], spacing_m: float) -> Floats:
    """Return the ends (2 H, 2) of slanted lines inside closed outlines (N, 2), without holes."""
    closed = [line for line in outlines if len(line) > 2]
    if not closed:
        return np.empty((0, 2))
    start = np.concatenate([line[:-1] for line in closed])
    end = np.concatenate([line[1:] for line in closed])
    # Along a hatching line x - y stays the same: count where edges pass each of its values.
    first, last = ((p[:, 0] - p[:, 1]) / spacing_m for p in (start, end))
    low = np.ceil(np.minimum(first, last))
    high = np.ceil(np.maximum(first, last))
    count = (high - low).astype(np.int64)  # for the integers in [low, high)
    edge = np.repeat(np.arange(len(start)), count)
    value = low[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    part = ((value - first[edge]) / (last - first)[edge])[:, None]
    points = start[edge] + part * (end - start)[edge]
    order = np.lexsort((points[:, 0], value))  # an even number on each line: in, out, in, out
    return points[order]


def _measure(
    found: sight.BlindGround, body: BoxBounds, side: str, palette: graphics.Palette
) -> tuple[graphics.Primitives, graphics.Tag] | None:
    """Return a line from the vehicle to where blind ground begins or ends, with its length."""
    spot = found.nearest[side]
    zone = found.zone[side]
    if spot is None or (zone is not None and 0.0 < zone < MIN_ZONE_M):
        return None
    if zone is None:
        distance = found.within
        text = f"blind beyond {found.within:g} m out"
    elif zone:
        distance = zone
        text = f"blind to {sight.shown_end(zone):.1f} m out"
    else:
        distance = spot.distance
        text = f"blind from {sight.shown_start(spot.distance):.1f} m out"
    axis, sign = SIDES[side]
    end = np.zeros(3)
    end[axis] = body[1 if sign > 0 else 0][axis] + sign * distance
    end[1 - axis] = spot.point[1 - axis]
    return _measured(end, axis, sign, distance, color=palette.words), _label(
        end, text, palette.words
    )


def _measured(
    end: Floats, axis: int, sign: int, distance: float, color: graphics.Rgba
) -> graphics.Primitives:
    """Return a line of the measured length, with a bar across its end."""
    start = end.copy()
    across = np.zeros(3)
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


def reach_of_rig(
    found: sight.Reach, palette: graphics.Palette = graphics.VIEWPORT, name: str = ""
) -> graphics.LayerShape:
    """Return the rig's reach with metres at some bearings; `name` says which rig, of several."""
    color = palette.reach
    legend = graphics.ColorKey(_reach_title(found), classes=((color, name or "rig"),))
    return graphics.LayerShape(
        lines=reach_lines(found, found.distance, color),
        labels=tuple(_distance_labels(found, palette.words)),
        legend=legend,
    )


def reach_of_sensors(found: sight.Reach, colors: dict[str, graphics.Rgb]) -> graphics.LayerShape:
    """Return the reach of each sensor in its colour, by name."""
    lines = []
    classes = []
    for name, own in colors.items():
        color = (*own, 0.75)
        lines.append(reach_lines(found, found.per_sensor[name], color))
        classes.append((color, name))
    legend = graphics.ColorKey(_reach_title(found), classes=tuple(classes))
    return graphics.LayerShape(lines=graphics.Primitives.joined(lines), legend=legend)


def _reach_title(found: sight.Reach) -> str:
    """Return the legend's title: of single objects, or of the voxels of a class."""
    what = f"single {found.class_name}" if found.sector else found.class_name
    return f"{what[:1].upper()}{what[1:]} detected, AP ≥ {REACH_AP:g}"


def reach_lines(found: sight.Reach, distance: Floats, color: graphics.Rgba) -> graphics.Primitives:
    """Return a closed line on the ground; faint where the space ends before the reach."""
    line = sight.reach_line(found, distance)
    closed = np.append(np.arange(len(line.points)), 0)
    points = np.column_stack([line.points, np.zeros(len(line.points))])[closed]
    cut = line.at_least[closed]
    colors = np.tile(np.asarray(color, np.float32), (len(closed) - 1, 2, 1))
    colors[cut[:-1] & cut[1:], :, 3] *= CUT_ALPHA
    return graphics.Primitives.of(graphics.polyline(points), colors)


def rig_reach(
    look: sight.Sight,
    rig: pe.Rig,
    class_name: str,
    palette: graphics.Palette = graphics.VIEWPORT,
    name: str = "",
) -> graphics.LayerShape:
    """Return the reach of another variant's rig for a class."""
    return reach_of_rig(look.reach(rig, class_name, ap=REACH_AP, bearings=BEARINGS), palette, name)


def _distance_labels(found: sight.Reach, color: graphics.Rgba) -> Iterable[graphics.Tag]:
    step = max(1, len(found.bearings) // LABEL_COUNT)
    cut = sight.ends_with_space(found, found.distance)
    for at in range(0, len(found.bearings), step):
        metres = float(found.distance[at])
        angle = float(found.bearings[at])
        if metres >= MIN_LABEL_M:
            text = sight.reach_text(metres, bool(cut[at]))
            place = (metres * float(np.cos(angle)), metres * float(np.sin(angle)), 0.0)
            yield graphics.Tag(text, place, graphics.with_alpha(color, 1.0))
