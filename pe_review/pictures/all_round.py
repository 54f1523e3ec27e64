"""What a LiDAR sees all round: a row a channel, a column an azimuth, people and cars ahead."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, kinds, pe
from ..figures import change
from .company import Companion, company
from .marked import MarkedPicture

Floats = NDArray[np.float64]

WIDE, LEAST_HIGH, MOST_ROW = 720, 144, 12
"""Pixels of a full circle, of the rows together at least, and of a row at most."""
SIDES = {"behind": -180.0, "right": -90.0, "ahead": 0.0, "left": 90.0, "behind ": 180.0}
"""Of a circle, and where they are [deg]; behind is at both ends."""
VIEW_RAD = math.radians(80.0)
"""Half the view that people and cars are spread over."""


def lidar_picture(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> MarkedPicture:
    """Return a LiDAR's ranges all round, people and cars of known size before it.

    Parameters
    ----------
    sensor : Sensor
        A LiDAR.
    vehicle : Vehicle or None
    """
    lidar = sensor.model
    assert isinstance(lidar, kinds.Lidar)
    half = min(VIEW_RAD, (lidar.horizontal_fov[1] - lidar.horizontal_fov[0]) / 2.0)
    others = company(sensor, half, vehicle)
    picture = kinds.range_picture(sensor, vehicle, _together(others))
    columns = _columns(picture)
    high = _row_pixels(len(picture.elevations))
    rows = np.repeat(np.arange(len(picture.elevations)), high)
    colors = graphics.range_colors(picture, lidar.max_range)[np.ix_(rows, columns)]
    png = graphics.png_bytes(graphics.as_bytes(colors))
    marks = _marks(picture, others, columns, high)
    edges = _around(picture, len(columns)), _up(picture, len(rows))
    return MarkedPicture(png, len(columns), len(rows), marks, *edges)


def _together(others: list[Companion]) -> pe.Vehicle | None:
    """All of them as one body, a part each."""
    if not others:
        return None
    each = [other.body.body.triangles for other in others]
    parts = np.repeat(np.arange(len(each)), [len(triangles) for triangles in each])
    return pe.Vehicle(np.concatenate(each), parts, [f"thing {k}" for k in range(len(each))])


def _columns(picture: kinds.RangePicture) -> NDArray[np.int64]:
    """(W,) the azimuth that each pixel shows: the nearest one, or one that meets something."""
    if len(picture.azimuths) == 1:
        return np.zeros(1, np.int64)
    near = graphics.even_angles(picture.azimuths, WIDE / 360.0)
    ends = np.append(near[1:], len(picture.azimuths))
    met = (picture.things >= 0).any(axis=0)
    for at in np.flatnonzero(ends > near + 1):
        between = np.flatnonzero(met[near[at] : ends[at]])
        if len(between):
            near[at] += between[0]
    return near


def _row_pixels(channels: int) -> int:
    return int(np.clip(math.ceil(LEAST_HIGH / channels), 1, MOST_ROW))


def _marks(
    picture: kinds.RangePicture, others: list[Companion], columns: NDArray[np.int64], high: int
) -> tuple[tuple[float, float, str], ...]:
    """Distances above what beams meet; who is met by none is not marked."""
    found = []
    shown = picture.things[:, columns]
    for number, each in enumerate(others):
        rows, across = np.nonzero(shown == number)
        if len(rows):
            found.append((float(np.median(across)) + 0.5, float(rows.min() * high), each.label))
    return tuple(found)


def _around(picture: kinds.RangePicture, wide: int) -> tuple[tuple[float, str], ...]:
    """Where sides are, along a picture so wide."""
    high, low = np.degrees(picture.azimuths[[0, -1]]).tolist()
    if high <= low:
        return ()
    places = {words: (high - at) / (high - low) * wide for words, at in SIDES.items()}
    return tuple((round(x, 1), words) for words, x in places.items() if -1.0 < x < wide + 1.0)


def _up(picture: kinds.RangePicture, high: int) -> tuple[tuple[float, str], ...]:
    """Elevations of the uppermost and the lowest channel."""
    top, bottom = np.degrees(picture.elevations[[0, -1]]).tolist()
    texts = ((0.0, f"{change(top, 0)}°"), (float(high), f"{change(bottom, 0)}°"))
    return texts if len(picture.elevations) > 1 else texts[:1]
