"""The still with its sensors numbered in their colours, and the names below it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, pe
from ..markup import Markup, escaped
from .still import SIZE, still, usual_view
from .svg import Canvas, figure, hexadecimal
from .viewpoint import Viewpoint

Floats = NDArray[np.float64]

AWAY, RADIUS = 46.0, 15.0
"""How far a number stands above its sensor, and its disc's radius, in a picture of `SIZE`."""
APART = 34.0
ROUNDS = 40
HIDDEN_M = 0.12
"""A sensor this far behind the surface that is seen in its place is hidden by it."""


def named_still(
    vehicle: pe.Vehicle | None, rig: pe.Rig, alt: str, picture: bytes | None = None
) -> Markup:
    """Return a picture of a rig on its vehicle, its sensors numbered, as a figure.

    `picture` is its `still`, where that is there already.
    """
    view = usual_view(vehicle, rig)
    wide, high = map(float, SIZE)
    canvas = Canvas(wide, high, alt)
    canvas.picture(picture or still(vehicle, rig, SIZE, view), (0.0, 0.0, wide, high))
    places = np.array([sensor.pose.position for sensor in rig])
    ends = np.stack(view.project(places, *SIZE), axis=1)
    hidden = _hidden(vehicle, view, places)
    discs = spread(ends - [0.0, AWAY])
    for number, (end, disc) in enumerate(zip(ends, discs, strict=True)):
        _numbered(canvas, number, end, disc, bool(hidden[number]))
    return figure(canvas.svg(), key(rig))


def key(rig: pe.Rig) -> Markup:
    """Return the sensors' numbers, colours and names as a list."""
    each = "".join(
        '<li><span class="swatch" '
        f'style="background:{hexadecimal(graphics.sensor_color_on_paper(k))}"></span>'
        f"{k + 1} {escaped(sensor.name)} <small>({escaped(sensor.model.name)})</small></li>"
        for k, sensor in enumerate(rig)
    )
    return Markup(f'<ul class="key">{each}</ul>')


def spread(places: Floats) -> Floats:
    """(N, 2) places moved until none is nearer to another than `APART`, nor out of the picture."""
    moved = places.copy()
    for _ in range(ROUNDS):
        apart = moved[:, None] - moved[None]
        distance = np.sqrt((apart * apart).sum(axis=2))
        # Two at one place go different ways: to the sides, by their numbers.
        sides = np.sign(np.subtract.outer(np.arange(len(moved)), np.arange(len(moved))))
        apart[distance < 1e-6, 0] = sides[distance < 1e-6]
        push = np.maximum(APART - distance, 0.0) * (sides != 0)
        length = np.maximum(distance, 1.0)
        moved = moved + (apart / length[..., None] * push[..., None]).sum(axis=1) / 2.0
        moved = np.clip(moved, RADIUS + 2.0, np.array(SIZE) - RADIUS - 2.0)
    return moved


def _numbered(canvas: Canvas, number: int, end: Floats, disc: Floats, hidden: bool) -> None:
    """A disc with a number, and a line to its sensor: dashed to one behind the vehicle."""
    color = hexadecimal(graphics.sensor_color_on_paper(number))
    line = f"M{disc[0]:.1f} {disc[1]:.1f}L{end[0]:.1f} {end[1]:.1f}"
    dashes = "4 4" if hidden else "none"
    canvas.add("path", d=line, stroke="#1b1f24", stroke_width=1.5, stroke_dasharray=dashes)
    if hidden:
        canvas.add("circle", cx=end[0], cy=end[1], r=4.0, fill=color, stroke="#1b1f24")
    canvas.add("circle", cx=disc[0], cy=disc[1], r=RADIUS, fill=color, stroke="#1b1f24")
    canvas.text(disc[0], disc[1] + 6.0, str(number + 1), text_anchor="middle", css="number")


def _hidden(vehicle: pe.Vehicle | None, view: Viewpoint, places: Floats) -> NDArray[np.bool_]:
    """(N,) places before which the vehicle stands."""
    if vehicle is None:
        return np.zeros(len(places), bool)
    way = places - np.array(view.eye)
    distance = np.sqrt((way * way).sum(axis=1))
    hits = vehicle.first_hit_from(np.array(view.eye), way / distance[:, None])
    return np.asarray(hits.distance < distance - HIDDEN_M)
