"""Annotations: axles, the queried location, and another variant's sensors; no scene, no GPU."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..engine import catalog, graphics
from .regions import box_edges

if TYPE_CHECKING:
    from ..engine import advice, pe


DEFAULT_HALF_WIDTH_M = 0.9
BEYOND_M = 0.15
"""Half an axle where there is no vehicle, and how far it extends beyond the body."""
AXIS_M = 0.6
AXES: tuple[graphics.Rgba, ...] = (
    (0.93, 0.3, 0.35, 1.0),
    (0.5, 0.8, 0.15, 1.0),
    (0.25, 0.55, 0.98, 1.0),
)
"""Blender's colours of x, y and z."""
AXLE_ALPHA = 0.55
GAP_M = 0.3
SHAFT_M = 0.9
HEAD_M = 0.6
HEAD_HALF_M = 0.35
"""Of the arrow ahead of a vehicle: distance from its bumper, length of shaft and head, and half the
head's width."""
ARROW = (1.0, 0.85, 0.3, 0.95)
SIDE_M = 0.1
POST_M = 0.6
"""A voxel alone would be too small to see: a post marks it."""
VISIBLE = graphics.with_alpha(graphics.VIEWPORT.free, 0.9)
OCCLUDED = graphics.with_alpha(graphics.VIEWPORT.occluded, 0.9)
MARK = (1.0, 1.0, 1.0, 0.95)
REASON_COLORS = {"sees": VISIBLE, "occluded": OCCLUDED}
"""By the reason that `advice.ask_place` gives."""
RING_M = 0.18
VIEW_M = 0.6
"""Radius of a ring, and length of a camera's view."""
GHOST_ALPHA = 0.5
LINK_ALPHA = 0.8
SAME_M = 1e-4
"""Sensors nearer to each other than this are at one place: there is no line between them."""
PALE = (0.85, 0.85, 0.9)
GHOST_PALETTE = replace(
    graphics.VIEWPORT, reach=graphics.with_alpha(PALE, 0.55), words=graphics.with_alpha(PALE, 0.75)
)
"""Colours of another variant's reach."""
GHOST_TITLE = "Other variant"
WOULD_FIX = "Would fix it"
"""Title of suggestions: these are drawn as bodies with their beams."""
BODY_COLOR = (1.0, 0.85, 0.3, 0.95)
BODY_M = 0.12
BEAMS_M = 2.0


def axles(reference: pe.Reference, half_width: float | None) -> graphics.LayerShape:
    """Return both axles as lines across, and axes on the ground under the middle of the rear one.
    `half_width` is the vehicle's [m]; lines go a little beyond it, and are drawn through the body.
    """
    half = BEYOND_M + (DEFAULT_HALF_WIDTH_M if half_width is None else half_width)
    x = reference.rear_axle_x
    z = reference.rear_axle_z
    lines = [_axle_line(x, z, half)]
    if reference.wheelbase is not None:
        lines.append(_axle_line(x + reference.wheelbase, z, half))
    origin = np.array([x, 0.0, 0.0])
    for color, axis in zip(AXES, np.eye(3), strict=True):
        lines.append(graphics.Primitives.of([origin, origin + AXIS_M * axis], color))
    label = graphics.Tag("rear axle", (x, -half, z), graphics.VIEWPORT.words)
    return graphics.LayerShape(through=graphics.Primitives.joined(lines), labels=(label,))


def _axle_line(x: float, z: float, half: float) -> graphics.Primitives:
    return graphics.Primitives.of(
        [(x, -half, z), (x, half, z)], graphics.with_alpha(graphics.VIEWPORT.words, AXLE_ALPHA)
    )


def front_arrow(vehicle: pe.Vehicle) -> graphics.LayerShape:
    """Return an arrow on the ground ahead of a vehicle, and the names of its two ends."""
    low, high = vehicle.bounds
    rear = float(low[0]) - GAP_M
    front = float(high[0]) + GAP_M
    y = float(low[1] + high[1]) / 2.0
    neck = front + SHAFT_M
    tip = front + SHAFT_M + HEAD_M
    head = [(neck, y - HEAD_HALF_M, 0.0), (neck, y + HEAD_HALF_M, 0.0), (tip, y, 0.0)]
    edges = [(front, y, 0.0), (neck, y, 0.0), *(head[k] for k in (0, 1, 1, 2, 2, 0))]
    labels = (
        graphics.Tag("front", (tip + GAP_M, y, 0.0), ARROW, strong=True),
        graphics.Tag("rear", (rear, y, 0.0), ARROW),
    )
    return graphics.LayerShape(
        faces=graphics.Primitives.of(head, ARROW),
        through=graphics.Primitives.of(edges, ARROW),
        labels=labels,
    )


def location_mark(place: advice.AskedPlace, sensors: Sequence[pe.Sensor]) -> graphics.LayerShape:
    """Return a mark at a location, and a line to each sensor that sees it or is occluded."""
    center = np.array(place.center)
    answers = {each.name: each for each in place.sensors}
    post = np.array([center, center + np.array([0.0, 0.0, POST_M])])
    mark = np.vstack([box_edges(center - SIDE_M / 2.0, center + SIDE_M / 2.0), post])
    lines = [graphics.Primitives.of(mark, MARK)]
    for sensor in sensors:
        answer = answers.get(sensor.name)
        if answer is not None and answer.reason in REASON_COLORS:
            ends = np.array([sensor.pose.position, place.center])
            lines.append(graphics.Primitives.of(ends, REASON_COLORS[answer.reason]))
    seeing = sum(each.m > 0.0 for each in place.sensors)
    text = "in the vehicle" if place.in_vehicle else f"seen by {seeing}, AP {place.ap:.2f}"
    top = (float(center[0]), float(center[1]), float(center[2]) + POST_M)
    return graphics.LayerShape(
        through=graphics.Primitives.joined(lines),
        labels=(graphics.Tag(text, top, MARK, strong=True),),
    )


def ghost_sensors(
    others: Sequence[pe.Sensor],
    present: Sequence[pe.Sensor],
    name: str = "",
    title: str = GHOST_TITLE,
) -> graphics.LayerShape:
    """Return another variant's sensors, and lines to the present sensors of the same names. `name`
    is the other variant's, for the legend."""
    here = {sensor.name: sensor for sensor in present}
    lines = [_ghost_outline(sensor) for sensor in others]
    is_offer = title == WOULD_FIX
    faces = [_ghost_body(sensor) for sensor in others if is_offer]
    lines += [_ghost_beams(sensor) for sensor in others if is_offer]
    color = graphics.with_alpha(PALE, LINK_ALPHA)
    labels = []
    for other in others:
        place = other.pose.position
        ends = np.array([place, here[other.name].pose.position if other.name in here else place])
        is_moved = np.abs(ends[0] - ends[1]).max() >= SAME_M
        if is_moved:
            lines.append(graphics.Primitives.of(ends, color))
        if is_moved or other.name not in here:
            labels.append(graphics.Tag(other.name, place, color))
    legend = graphics.ColorKey(title, classes=((color, name or "another one"),)) if others else None
    return graphics.LayerShape(
        faces=graphics.Primitives.joined(faces),
        through=graphics.Primitives.joined(lines),
        labels=tuple(labels),
        legend=legend,
    )


def _ghost_body(sensor: pe.Sensor) -> graphics.Primitives:
    """Return the housing of a sensor as a body; a cube where it is not known."""
    housing = catalog.housing(sensor.model.name)
    size = np.full(3, BODY_M) if housing is None else np.array(housing.size)
    middle = np.zeros(3) if housing is None else -np.array(housing.optical_center)
    middle = middle + ([0.0, 0.0, size[2] / 2.0] if housing is not None else 0.0)
    corners = graphics.CORNERS * size + middle
    placed = corners @ sensor.pose.ground_from_sensor.T + np.array(sensor.pose.position)
    return graphics.Primitives.of(placed[np.array(graphics.FACES)].reshape(-1, 3), BODY_COLOR)


def _ghost_beams(sensor: pe.Sensor) -> graphics.Primitives:
    """Return the first metres of a sensor's beams, or its view."""
    return graphics.drawing_of(sensor.kind).lines(sensor, BEAMS_M, graphics.VIEWPORT)


def _ghost_outline(sensor: pe.Sensor) -> graphics.Primitives:
    """Return a camera's view, for others a ring, in one pale colour."""
    drawing = graphics.drawing_of(sensor.kind)
    palette = graphics.VIEWPORT
    if drawing.beams:
        drawn = graphics.ring_lines(sensor, RING_M, palette)
    else:
        drawn = drawing.lines(sensor, VIEW_M, palette)
    return graphics.Primitives.of(drawn.points, graphics.with_alpha(PALE, GHOST_ALPHA))
