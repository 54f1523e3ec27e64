"""What single sensors see: ranges of a LiDAR, pixels that the body hides, fields of radars."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pe_core.base.arrays import Floats
from pe_core.scene import Sensor, Vehicle
from pe_core.sensors import FieldPicture, Radar, RangePicture, Ultrasonic, kind_of

from .colors import VIRIDIS, Palette, Scale, on_scale, with_alpha
from .primitives import Primitives, polyline

NEAREST_M = 0.5  # All that is nearer has the brightest colour
NO_ECHO = (0.16, 0.16, 0.17)
BODY_NEAR = (1.0, 0.62, 0.20)
BODY_FAR = (0.72, 0.28, 0.0)
"""Vermillion, as occluded beams are drawn: nearer parts are lighter."""
BODY_SILENT = (0.42, 0.17, 0.0)
"""Colour of a beam that the body blocks so near that there is no echo."""
BODY_FAR_M = 5.0
RANGES: Scale = VIRIDIS[::-2]  # From near to far
RAYS = 240  # Places of the picture that are looked along: enough to see where the body begins
ARC_POINTS = 33  # Azimuths of an arc; one of them is the middle
FACE_ALPHA = 0.10
EDGE_ALPHA = 0.55
"""How strong a field's area, and the arcs above and below it, are beside its middle arc."""
# Detections at the ends of the colour scale, which is logarithmic
LEAST_M = 0.1
MOST_M = 30.0


def range_colors(picture: RangePicture, far_m: float) -> NDArray[np.float32]:
    """(C, A, 3) sRGB of a LiDAR's beams; the scale is logarithmic, up to `far_m`."""
    heard = np.isfinite(picture.distance)
    distance = np.where(heard, np.maximum(picture.distance, NEAREST_M), far_m)
    far = max(far_m, 2.0 * NEAREST_M)
    share = np.log(np.maximum(distance, NEAREST_M) / NEAREST_M) / math.log(far / NEAREST_M)
    colors = on_scale(share, RANGES)
    colors[~heard] = NO_ECHO
    colors[picture.occluded & ~heard] = BODY_SILENT
    own = picture.occluded & heard
    colors[own] = on_scale(distance[own] / BODY_FAR_M, (BODY_NEAR, BODY_FAR))
    return colors


def even_angles(angles: NDArray[np.float64], pixels_per_deg: float) -> NDArray[np.int64]:
    """(P,) index of the beam nearest to each pixel of an axis; `angles` [rad] are descending."""
    degrees = np.degrees(angles)
    high = float(degrees[0])
    low = float(degrees[-1])
    count = max(1, round((high - low) * pixels_per_deg))
    places = high - (np.arange(count) + 0.5) * (high - low) / count
    between = (degrees[1:] + degrees[:-1]) / 2.0
    return np.searchsorted(-between, -places)


def hidden_lines(sensor: Sensor, vehicle: Vehicle | None, color: ArrayLike) -> Primitives:
    """Return lines from a sensor to its own vehicle, along at most `RAYS` over its field of view.
    Cameras see through the vehicle's glass, radars through its covers; None gives no lines."""
    body = None if vehicle is None else kind_of(sensor).opaque(vehicle)
    if body is None:
        return Primitives.empty()
    rays = kind_of(sensor).rays(sensor, RAYS)
    through_glass = sensor.model.sees_through_glass
    distance = body.first_hit(sensor.pose.position, rays, through_glass).distance
    met = np.isfinite(distance)
    start = np.broadcast_to(sensor.pose.position, (int(met.sum()), 3))
    ends = start + rays[met] * distance[met, None]
    return Primitives.of(np.stack([start, ends], axis=1), color)


class Lobe(NamedTuple):
    """One mode of a sensor: arcs of directions (3, N, 3), sensor frame, lowest first, and their
    ranges (3, N) [m], without a limit by the drawing."""

    directions: Floats
    ranges: Floats


def lobes_of(sensor: Sensor) -> list[Lobe]:
    """Return the lobes of a sensor, the longest first; the smaller ones lie over them."""
    model = sensor.model
    if isinstance(model, Ultrasonic):
        (left, right), (low, high) = model.window
        azimuths = np.linspace(left, right, ARC_POINTS)
        rise = high * np.sqrt(np.maximum(1.0 - (azimuths / right) ** 2, 0.0))
        elevations = np.stack([-rise, 0.0 * rise, rise])
        return [_lobe(azimuths, elevations, np.full(elevations.shape, model.max_range))]
    assert isinstance(model, Radar)
    lobes = []
    for mode in model.modes:
        even = np.linspace(mode.azimuths[0], mode.azimuths[-1], ARC_POINTS)
        azimuths = np.unique(np.concatenate([even, mode.azimuths]))
        low = float(mode.elevations[0])
        high = float(mode.elevations[-1])
        middle = float(mode.elevations[np.argmax(mode.scales)])
        middle = min(max(0.0, low), high) if mode.scales.max() == mode.scales.min() else middle
        elevations = np.repeat([[low], [middle], [high]], len(azimuths), axis=1)
        across = np.broadcast_to(azimuths, elevations.shape)
        reach = mode.reach(across.reshape(-1), elevations.reshape(-1)).reshape(across.shape)
        lobes.append(_lobe(azimuths, elevations, reach))
    return sorted(lobes, key=lambda lobe: -float(lobe.ranges.max()))


def _lobe(azimuths: Floats, elevations: Floats, ranges: Floats) -> Lobe:
    across = np.broadcast_to(azimuths, elevations.shape)
    flat = np.cos(elevations)
    vectors = [flat * np.cos(across), flat * np.sin(across), np.sin(elevations)]
    return Lobe(np.stack(vectors, axis=-1), ranges)


def _arcs(sensor: Sensor, lobe: Lobe, length_m: float) -> Floats:
    """(3, N, 3) points of a lobe's arcs, no farther than a length, ground frame [m]."""
    far = np.minimum(lobe.ranges, length_m)[..., None]
    return lobe.directions * far @ sensor.pose.ground_from_sensor.T + sensor.pose.position


def field_lines(sensor: Sensor, length_m: float, palette: Palette) -> Primitives:
    """The middle arc of each mode with its two edges, and fainter arcs above and below it."""
    strong = []
    faint = []
    place = np.asarray(sensor.pose.position, dtype=float)
    for lobe in lobes_of(sensor):
        low, middle, high = _arcs(sensor, lobe, length_m)
        strong.append(polyline(np.vstack([place, middle, place])))
        faint += [polyline(low), polyline(high)]
        faint += [np.stack([low[k], high[k]]) for k in (0, -1)]
    color = palette.other
    edges = with_alpha(color, color[3] * EDGE_ALPHA)
    return Primitives.joined(
        [Primitives.of(np.vstack(strong), color), Primitives.of(np.vstack(faint), edges)]
    )


def field_faces(sensor: Sensor, length_m: float, palette: Palette) -> Primitives:
    """The area of each mode between the sensor and its middle arc."""
    place = np.asarray(sensor.pose.position, dtype=float)
    parts = []
    for lobe in lobes_of(sensor):
        arc = _arcs(sensor, lobe, length_m)[1]
        start = np.broadcast_to(place, arc[1:].shape)
        parts.append(np.stack([start, arc[:-1], arc[1:]], axis=1).reshape(-1, 3))
    color = palette.other
    return Primitives.of(np.vstack(parts), with_alpha(color, color[3] * FACE_ALPHA))


def field_footprint(sensor: Sensor, far_m: float) -> Floats:
    """(N, 3) outline of the ground (z = 0) in the field of view, as far as `far_m` [m]. It is that
    of the longest mode. What the vehicle hides is not taken away."""
    lobe = lobes_of(sensor)[0]
    place = np.asarray(sensor.pose.position, dtype=float)
    outline = np.vstack([place, _arcs(sensor, lobe, far_m)[1]])
    outline[:, 2] = 0.0
    return outline


def field_colors(picture: FieldPicture) -> NDArray[np.float32]:
    """(R, A, 3) sRGB of what a sensor detects: many detections are bright. Where nothing is
    detected the picture is grey; where the vehicle hides the target, orange."""
    detected = picture.values > 0.0
    share = np.log(np.maximum(picture.values, LEAST_M) / LEAST_M) / np.log(MOST_M / LEAST_M)
    colors = on_scale(1.0 - share, RANGES)
    colors[~detected] = NO_ECHO
    colors[picture.hidden] = BODY_NEAR
    return colors
