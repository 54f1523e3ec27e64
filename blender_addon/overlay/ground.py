"""The ground map's layer: as scored or worked out, its colours' range, and the difference map."""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import TYPE_CHECKING

from ..engine import graphics, pe
from .wish import FIXED, WHOLE

if TYPE_CHECKING:
    from ..engine import sight
    from .tools import Tools
    from .wish import PictureWish

COARSE_M, FINE_M = 1.5, 0.5
"""Side of the ground map's places while something moves, and at rest."""
MOST_PLACES = 60_000
NOTHING_TO_COMPARE = "Difference: nothing to compare with yet"


def ground(wish: PictureWish, tools: Tools) -> graphics.LayerShape:
    """Return the ground map that is wished for, with its legend."""
    view = wish.view
    if shows_difference(wish):
        return _difference(wish, tools)
    scored = as_scored(wish)
    if scored is not None:
        seen = graphics.as_scored(scored, wish.space, FINE_M)
        where = graphics.AS_SCORED
    else:
        seen, where = _seen(wish, tools, pe.Rig([e.sensor for e in wish.counted])), None
    bounds = _bounds(wish, tools, seen)
    return graphics.ground_map(
        seen, view.ground_quantity, view.ground_opacity, where=where, bounds=bounds
    )


def shows_difference(wish: PictureWish) -> bool:
    """Whether differences are to be shown: how many sensors see a place has none."""
    return wish.view.ground_difference and wish.view.ground_quantity != graphics.SENSORS


def as_scored(wish: PictureWish) -> pe.GroundMap | None:
    """The score's own map, where that is what is to be shown."""
    view = wish.view
    averaged = view.ground_height is None and view.ground_quantity != graphics.SENSORS
    return wish.scored if averaged and not shows_difference(wish) else None


def compared_key(wish: PictureWish) -> Hashable:
    """What the difference map depends on besides the scene's own sensors; None without it."""
    if not shows_difference(wish):
        return None
    return wish.compared_name, *((s.name, id(s.model), s.pose, s.group) for s in wish.compared)


def step_of(space: pe.PerceptionSpace, *, moving: bool) -> float:
    """Side of the ground map's places: larger ones in a space that is larger than usual."""
    (x0, x1), (y0, y1) = space.x, space.y
    least, most = (COARSE_M, MOST_PLACES // 4) if moving else (FINE_M, MOST_PLACES)
    return max(least, math.sqrt((x1 - x0) * (y1 - y0) / most))


def _seen(wish: PictureWish, tools: Tools, rig: pe.Rig) -> sight.GroundSight:
    step = step_of(wish.space, moving=wish.moving)
    return tools.sight(wish).ground(rig, wish.view.ground_height, step, draft=wish.moving)


def _difference(wish: PictureWish, tools: Tools) -> graphics.LayerShape:
    """Both rigs on the same voxels and by the same rules: what is left is their difference."""
    if not wish.compared:
        return graphics.LayerShape(legend=graphics.ColorKey(NOTHING_TO_COMPARE))
    view = wish.view
    of = compared_key(wish), view.ground_height, wish.moving, wish.body_key, wish.prior_key
    before = tools.compared(of, lambda: _seen(wish, tools, pe.Rig(wish.compared)))
    seen = _seen(wish, tools, pe.Rig([each.sensor for each in wish.counted]))
    return graphics.difference_map(
        seen, before, view.ground_quantity, view.ground_opacity, name=wish.compared_name
    )


def _bounds(wish: PictureWish, tools: Tools, seen: sight.GroundSight) -> tuple[float, float] | None:
    """Values of the colours' ends. While something moves they stay: colours are to compare."""
    view = wish.view
    if view.ground_quantity == graphics.SENSORS or view.ground_range == WHOLE:
        return None
    if view.ground_range == FIXED:
        fixed = (
            view.entropy_range
            if view.ground_quantity == graphics.ENTROPY
            else (view.coverage_range[0], view.coverage_range[1])
        )
        return fixed if fixed[0] != fixed[1] else None
    of = view.ground_quantity, view.ground_height, wish.prior_key
    return tools.fitted(
        of, lambda: graphics.fitted_bounds(seen, view.ground_quantity), anew=not wish.moving
    )
