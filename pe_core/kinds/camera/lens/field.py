"""The field of a lens in a picture: how far it can be inverted, and where its border runs."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ....errors import InputError
from .lens import Lens, Own

Floats = NDArray[np.float64]

RINGS, SPOKES = 1100, 32
"""Directions at which a lens is tried: so many angles from the axis, each so often round it."""
ROOM_PX = 1e-6
"""A corner this far beyond the edge of the field is on it."""


def reaching(lens: Own, name: str, width: int, height: int) -> Own:
    """Return the lens with the edge of its field set for a picture of that size.

    Raises
    ------
    InputError
        When it cannot be inverted in all of the picture, or up to its own field of view.
    """
    folds = fold_angle(lens)
    wanted = lens.edge
    if folds >= wanted:
        return lens
    inner = lens.within(folds)
    if lens.fov is None and _holds(inner, width, height):
        return inner
    found = f"it folds {math.degrees(folds):.2f} deg from the axis, {_radius_px(inner):.0f} px"
    most = f"or fov_deg of at most {math.floor(math.degrees(2.0 * folds) * 10.0) / 10.0:g}"
    what = "a lens that can be inverted in all of the picture"
    raise InputError(name, "distortion", f"{what}, {most}", f"{found} from the centre")


def fold_angle(lens: Lens) -> float:
    """Angle from the axis up to which a lens can be inverted [rad]; its edge, or where it folds.

    Pixels a steradian are radius times slope, over the sine of the angle: both of them grow, or
    none. What a shift adds to that has the other sign on the opposite spoke.
    """
    theta = np.linspace(0.0, lens.edge, RINGS + 1)[1:]
    with np.errstate(all="ignore"):
        spokes = SPOKES if lens.shifts else 1
        grows = np.all(lens.density(*_rings(theta, spokes)) > 0.0, axis=1)
        grows &= lens.radius(theta) > 0.0
    bad = np.flatnonzero(~grows)
    if not len(bad):
        return lens.edge
    return float(theta[bad[0] - 1]) if bad[0] else 0.0


def edge_circle(lens: Lens, spokes: int = SPOKES) -> tuple[Floats, Floats]:
    """Image (right, down) [px] of directions round the edge of a lens's field, (spokes,) each."""
    depth, left, up = _rings(np.array([lens.edge]), spokes)
    right, down = lens.project(depth, left, up)
    return right[0], down[0]


def field_outline(lens: Lens, width: int, height: int, places: int) -> Floats:
    """(N, 3) unit directions, forward, left, up, round what a picture shows, clockwise as seen.

    So many places along each side of the picture; where it shows nothing, the edge of the field.
    """
    share = np.arange(places) / places
    none, all_ = np.zeros(places), np.ones(places)
    right = np.concatenate([share, all_, 1.0 - share, none]) * width
    down = np.concatenate([none, share, all_, 1.0 - share]) * height
    found = lens.unproject(right, down)
    x, y = (right - lens.cx) / lens.fx, (down - lens.cy) / lens.fy
    away = np.maximum(np.hypot(x, y), 1e-12)
    sine = math.sin(lens.edge)
    edge = np.stack([np.full(len(x), math.cos(lens.edge)), -sine * x / away, -sine * y / away], 1)
    return np.where(np.isnan(found[:, :1]), edge, found)


def _rings(theta: Floats, spokes: int = SPOKES) -> tuple[Floats, Floats, Floats]:
    """Directions at angles from the axis, (R, spokes) each."""
    turn = np.linspace(0.0, 2.0 * math.pi, spokes, endpoint=False)
    flat = np.sin(theta)[:, None]
    depth = np.broadcast_to(np.cos(theta)[:, None], (len(theta), spokes))
    return depth, flat * np.cos(turn), flat * np.sin(turn)


def _holds(lens: Lens, width: int, height: int) -> bool:
    """Whether the whole picture lies within the edge of the field."""
    right, down = edge_circle(lens, 720)
    turn = np.arctan2(down - lens.cy, right - lens.cx)
    away = np.hypot(down - lens.cy, right - lens.cx)
    for x, y in ((0, 0), (width, 0), (width, height), (0, height)):
        corner = math.atan2(y - lens.cy, x - lens.cx)
        reach = np.interp(corner, *_by_turn(turn, away), period=2.0 * math.pi)
        if math.hypot(y - lens.cy, x - lens.cx) > reach + ROOM_PX:
            return False
    return True


def _by_turn(turn: Floats, away: Floats) -> tuple[Floats, Floats]:
    order = np.argsort(turn)
    return turn[order], away[order]


def _radius_px(lens: Lens) -> float:
    right, down = edge_circle(lens)
    return float(np.min(np.hypot(right - lens.cx, down - lens.cy)))
