"""How each kind of sensor is drawn, a row a kind, for the viewport and for the page. Cameras are
frustums, straight or bent by their lens. A kind without a row is drawn as a ring around the sensor,
with a tick in its forward direction."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.scene import Sensor
from pe_core.sensors.camera.model import camera_of

from .beams import BeamChoice, ChannelMode, cast, free_lines, shown_beams
from .colors import VIEWPORT, Palette, Rgba, with_alpha
from .primitives import Primitives, fan, polyline
from .sensor_images import field_faces, field_footprint, field_lines

PLACES = 16  # Along each side of the picture
MARK_SIDE = 0.06  # Half the width of the mark that says up, in lengths of the view
FACE_CORNERS = ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1))
EDGES = ((0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 5))
RING_POINTS = 48
TICK_SHARE = 0.35
"""Corners of a ring, and the length of its tick in units of its radius."""
MARK_GAP = 0.08
MARK_HEIGHT = 0.25
MARK_HALF_WIDTH = 0.2
"""The mark over a picture's upper edge, in units of half the picture's height."""
ROUND_POINTS = 180  # Corners of the circle that is as far as a footprint is drawn
FOOT_LINE = 0.55
FOOT_FACE = 0.9
"""How strong a footprint's edge and area are, beside the pyramid's edges and sides."""
FEW_BEAMS = BeamChoice(96, ChannelMode.FEW)  # Of a LiDAR that is drawn alone
Draw = Callable[[Sensor, float, Palette], Primitives]
"""Takes a sensor, the length of its view [m], and colours."""


def outline(sensor: Sensor, length_m: float) -> Floats:
    """(N, 3) points on the border of a camera's view at a distance, ground frame [m]."""
    rays = camera_of(sensor).outline(PLACES) @ sensor.pose.ground_from_sensor.T
    return rays * length_m + np.asarray(sensor.pose.position)


def frustum_points(sensor: Sensor, length_m: float) -> Floats:
    """(8, 3) pinhole, picture corners and up mark of a camera, ground frame [m]. Corners: upper
    left, upper right, lower right, lower left as the camera sees them, `length_m` from the pinhole.
    The mark's left, right and tip follow, above the upper edge."""
    side, up = _half_picture(sensor)
    base = up * (1.0 + MARK_GAP)
    tip = up * (1.0 + MARK_GAP + MARK_HEIGHT)
    mark = up * MARK_HALF_WIDTH
    across = [side, -side, -side, side, mark, -mark, 0.0]
    above = [up, up, -up, -up, base, base, tip]
    points = np.column_stack([np.ones(7), across, above])
    points *= length_m / np.sqrt(1.0 + side**2 + up**2)
    points = np.vstack([np.zeros(3), points])
    return points @ sensor.pose.ground_from_sensor.T + np.asarray(sensor.pose.position)


def frustum_lines(sensor: Sensor, length_m: float, palette: Palette = VIEWPORT) -> Primitives:
    """Edges of a camera's view: spokes, picture, and a small triangle above that marks up."""
    if camera_of(sensor).lens is None:
        points = frustum_points(sensor, length_m)[np.array(EDGES).ravel()]
        return Primitives.of(points, palette.camera)
    points = outline(sensor, length_m)
    place = np.asarray(sensor.pose.position)
    spokes = np.stack([np.broadcast_to(place, (4, 3)), points[::PLACES]], axis=1).reshape(-1, 3)
    closed = polyline(np.vstack([points, points[:1]]))
    lines = np.vstack([spokes, closed, _mark(sensor, points[PLACES // 2], length_m)])
    return Primitives.of(lines, palette.camera)


def _mark(sensor: Sensor, top: Floats, length_m: float) -> Floats:
    """(6, 3) ends of the lines of a small triangle over the middle of the upper edge."""
    axes = sensor.pose.ground_from_sensor
    up = axes[:, 2]
    left = axes[:, 1] * length_m * MARK_SIDE
    tip = top + up * length_m * MARK_SIDE * 2.0
    base = top + up * length_m * MARK_SIDE * 0.5
    corners = np.array([base + left, base - left, tip])
    return corners[[0, 1, 1, 2, 2, 0]]


def frustum_faces(sensor: Sensor, length_m: float, palette: Palette = VIEWPORT) -> Primitives:
    """Sides of a camera's view: triangles from the camera to its outline."""
    if camera_of(sensor).lens is None:
        points = frustum_points(sensor, length_m)[np.array(FACE_CORNERS).ravel()]
        return Primitives.of(points, palette.camera_face)
    points = outline(sensor, length_m)
    place = np.broadcast_to(np.asarray(sensor.pose.position), points.shape)
    sides = np.stack([place, points, np.roll(points, -1, axis=0)], axis=1)
    return Primitives.of(sides.reshape(-1, 3), palette.camera_face)


def footprint(sensor: Sensor, far_m: float) -> Floats:
    """(N, 3) convex outline of the ground (z = 0) that a camera looks at, as far as `far_m` [m].
    What the vehicle hides is not taken away. Without points when it looks at no ground."""
    place = np.asarray(sensor.pose.position)
    if place[2] <= 0.0:
        return np.empty((0, 3))
    if camera_of(sensor).lens is not None:
        return _bent_footprint(sensor, far_m)
    angles = np.linspace(0.0, 2.0 * np.pi, ROUND_POINTS, endpoint=False)
    outline = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(ROUND_POINTS)]) * far_m
    outline[:, :2] += place[:2]
    side, up = _half_picture(sensor)
    inward = np.array([[side, -1.0, 0.0], [side, 1.0, 0.0], [up, 0.0, -1.0], [up, 0.0, 1.0]])
    for normal in inward @ sensor.pose.ground_from_sensor.T:
        outline = _cut(outline, (outline - place) @ normal)
    return outline


def _bent_footprint(sensor: Sensor, far_m: float) -> Floats:
    """The footprint of a camera with a lens: where the rays of its outline meet the ground."""
    place = np.asarray(sensor.pose.position)
    rays = camera_of(sensor).outline(PLACES) @ sensor.pose.ground_from_sensor.T
    flat = np.maximum(np.hypot(rays[:, 0], rays[:, 1]), 1e-9)
    steep = place[2] / far_m
    down = np.maximum(-rays[:, 2] / flat, steep)
    if not (-rays[:, 2] / flat > steep).any():
        return np.empty((0, 3))
    points = np.zeros_like(rays)
    points[:, :2] = place[:2] + rays[:, :2] / flat[:, None] * (place[2] / down)[:, None]
    return points


def footprint_lines(outline: Floats, color: Rgba) -> Primitives:
    """The edge of a footprint."""
    if len(outline) < 3:
        return Primitives.empty()
    closed = np.vstack([outline, outline[:1]])
    return Primitives.of(polyline(closed), with_alpha(color, color[3] * FOOT_LINE))


def footprint_faces(outline: Floats, color: Rgba) -> Primitives:
    """The area of a footprint."""
    return Primitives.of(fan(outline), with_alpha(color, color[3] * FOOT_FACE))


def ring_lines(sensor: Sensor, radius_m: float, palette: Palette = VIEWPORT) -> Primitives:
    """Ring around a sensor in its x-y plane, and a tick in its forward direction."""
    angles = np.linspace(0.0, 2.0 * np.pi, RING_POINTS + 1)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    tick = np.array([[1.0, 0.0, 0.0], [1.0 + TICK_SHARE, 0.0, 0.0]])
    points = np.vstack([polyline(ring), tick]) * radius_m
    points = points @ sensor.pose.ground_from_sensor.T + np.asarray(sensor.pose.position)
    return Primitives.of(points, palette.other)


def _half_picture(sensor: Sensor) -> tuple[float, float]:
    """Half width and half height of the picture one metre ahead [m]."""
    camera = camera_of(sensor)
    side = float(np.tan(camera.hfov / 2.0))
    return side, side * camera.height / camera.width


def _cut(outline: Floats, inside: Floats) -> Floats:
    """Return the part of a convex outline (N, 3) where a linear function (N,) is positive.
    Sutherland and Hodgman, "Reentrant polygon clipping", 1974."""
    found = []
    for at in range(len(outline)):
        here = inside[at]
        after = inside[(at + 1) % len(outline)]
        if here >= 0.0:
            found.append(outline[at])
        if (here >= 0.0) != (after >= 0.0):
            part = here / (here - after)
            found.append(outline[at] + part * (outline[(at + 1) % len(outline)] - outline[at]))
    return np.array(found).reshape(-1, 3)


@dataclass(frozen=True, slots=True)
class Drawing:
    """How sensors of one kind are drawn. `lines` are two points each, `faces` translucent
    triangles. `beams` states whether sensors of the kind share the budget of beams. `footprint`
    returns the outline of the ground in the field of view, up to some metres."""

    lines: Draw
    faces: Draw = lambda *_: Primitives.empty()
    beams: bool = False
    footprint: Callable[[Sensor, float], Floats] | None = None


def _few_beams(sensor: Sensor, length_m: float, palette: Palette) -> Primitives:
    beams = shown_beams(cast(sensor, None), FEW_BEAMS)
    return free_lines(sensor, beams, length_m, np.tile(palette.free, (len(beams.ends), 1)))


FIELD = Drawing(field_lines, field_faces, footprint=field_footprint)


DRAWINGS = {
    "lidar": Drawing(_few_beams, beams=True),
    "camera": Drawing(frustum_lines, frustum_faces, footprint=footprint),
    "radar": FIELD,
    "ultrasonic": FIELD,
}


OTHER = Drawing(ring_lines)  # Drawing of a kind without a row


def drawing_of(kind: str) -> Drawing:
    """Return how sensors of a kind are drawn."""
    return DRAWINGS.get(kind, OTHER)


def beam_budget(sensors: list[Sensor], most: int) -> int:
    """Return the number of beams that each sensor with beams may show, at least one."""
    sharing = sum(drawing_of(sensor.kind).beams for sensor in sensors)
    return max(1, most // max(1, sharing))
