"""Several studies: their pictures side by side, and maps of where each is better than the first."""

from __future__ import annotations

import numpy as np

from ..engine import sight
from ..markup import Markup, escaped
from ..pictures.ground_maps import difference_map
from ..pictures.named_still import named_still
from ..pictures.svg import STYLE, figure, grid
from ..reviewed import Reviewed
from ..section import Section

STEP_M = 1.0
ENDS = ("8 nats better", "8 nats worse")


def differing(each: tuple[Reviewed, ...]) -> Section:
    """Return pictures and differences; nothing of a single study."""
    if len(each) < 2:
        return Section("differences", "Where they differ", "")
    inside = f"{grid(map(_still, each))}{_maps(each)}"
    return Section("differences", "Where they differ", inside, styles=(STYLE,))


def _still(one: Reviewed) -> Markup:
    """Return the study's picture, with its name."""
    alt = f"Sensors of {one.name} on its vehicle"
    picture = one.once("still", lambda: named_still(one.shown_vehicle[0], one.rig, alt))
    return Markup(f'<div><p class="whose whose-{one.key}">{escaped(one.name)}</p>{picture}</div>')


def _maps(each: tuple[Reviewed, ...]) -> str:
    """Maps of each study's entropy less the first one's, where both have the same ground."""
    first, *others = each
    seen = _seen(first)
    drawn = []
    for other in others:
        found = _seen(other)
        if not _same_ground(seen, found):
            continue
        alt = f"Map of where {other.name} has less entropy than {first.name}, and where more"
        words = f"<b>{escaped(other.name)}</b> beside <b>{escaped(first.name)}</b>: blue is better"
        drawing = difference_map(seen, found, other.vehicle, alt, ENDS)
        drawn.append(figure(drawing, Markup(f"{words}, orange worse.")))
    if not drawn:
        return "<p>Their spaces differ, so no maps of differences are drawn.</p>"
    title = "<h3>Entropy, place by place</h3>"
    return f"{title}<p>From above: ahead is to the right, left is up.</p>{grid(drawn)}"


def _seen(one: Reviewed) -> sight.GroundSight:
    return one.once("ground", lambda: one.sight.ground(one.rig, step=STEP_M))


def _same_ground(a: sight.GroundSight, b: sight.GroundSight) -> bool:
    return np.array_equal(a.x, b.x) and np.array_equal(a.y, b.y)
