"""Expected detections by a radar, integrated ray by ray in decibels; it shares no code.

A window of directions round each object is divided into a fine raster; rays that meet the box, by
the separating planes of its six sides, carry equal solid angles but for the cosine of elevation.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import pe_core as pe

RCS_DBSM = {"car": 7.0, "pedestrian": -11.1, "truck": 15.0}
RASTER = 90
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def expected_detections(
    table: Mapping[str, Any], pose: pe.Pose, objects: pe.Objects, triangles: Floats | None = None
) -> Floats:
    """Return m (N,) of objects for a radar's table as a file has it."""
    rotation = np.asarray(pose.ground_from_sensor)
    eye = np.asarray(pose.position)
    found = []
    for center, size, yaw, label in zip(
        objects.centers, objects.sizes, objects.yaws, objects.labels, strict=True
    ):
        name = objects.class_names[label]
        box = _Box(center, size, yaw, RCS_DBSM[name])
        m = sum(_of_mode(mode, rotation, eye, box, triangles=triangles) for mode in table["mode"])
        found.append(min(m, table.get("list_length", math.inf)))
    return np.array(found)


class _Box(NamedTuple):
    """An object: centre and size (3,) [m], yaw [rad], radar cross section [dBsm]."""

    center: Floats
    size: Floats
    yaw: float
    rcs: float


def _of_mode(
    mode: Mapping[str, Any], rotation: Floats, eye: Floats, box: _Box, triangles: Floats | None
) -> float:
    offset = box.center - eye
    rays, solid, enter = _rays_on(offset, box)
    if not len(rays):
        return 0.0
    cells = _cells(mode, offset, box)
    local = rays @ rotation
    azimuth = np.degrees(np.arctan2(local[:, 1], local[:, 0]))
    elevation = np.degrees(np.arcsin(local[:, 2]))
    angles = np.array(mode["azimuth_deg"], float)
    ups = np.array(mode["elevation_deg"], float)
    ranges = np.broadcast_to(np.array(mode["range_m"], float), angles.shape)
    scales = np.broadcast_to(np.array(mode.get("elevation_scale", 1.0), float), ups.shape)
    reach = np.interp(azimuth, angles, ranges) * np.interp(elevation, ups, scales)
    inside = (azimuth >= angles[0]) & (azimuth <= angles[-1])
    inside &= (elevation >= ups[0]) & (elevation <= ups[-1])
    inside &= enter >= mode.get("min_range_m", 0.0)
    inside &= enter <= mode.get("max_range_m", ranges.max())
    wanted = 10 * math.log10(math.log(1e-6) / math.log(0.9) - 1)
    snr_db = wanted + box.rcs - 10 * math.log10(cells) - 10.0 + 40 * np.log10(reach / enter)
    pd = 1e-6 ** (1 / (1 + 10 ** (snr_db / 10)))
    pd[(pd < 0.1) | ~inside] = 0.0
    if triangles is not None:
        pd[_blocked(eye, rays, enter, np.asarray(triangles))] = 0.0
    return cells * float((solid * pd).sum() / solid.sum())


def _rays_on(offset: Floats, box: _Box) -> tuple[Floats, Floats, Floats]:
    """Rays of a raster that meet the box, their solid angles, and where they enter it."""
    size = box.size
    c = math.cos(box.yaw)
    s = math.sin(box.yaw)
    axes = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]])
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) / 2 * size
    corners = corners @ axes + offset
    middle = math.atan2(offset[1], offset[0])
    turn = np.arctan2(corners[:, 1], corners[:, 0]) - middle
    turn = (turn + math.pi) % (2 * math.pi) - math.pi
    up = np.arcsin(corners[:, 2] / np.linalg.norm(corners, axis=1))
    pad = 0.1 * (up.max() - up.min())
    step = (np.arange(RASTER) + 0.5) / RASTER
    azimuth = middle + turn.min() + (turn.max() - turn.min()) * step
    low = up.min() - pad
    high = up.max() + pad
    elevation = low + (high - low) * step
    a, e = (w.ravel() for w in np.meshgrid(azimuth, elevation))
    rays = np.column_stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    speed = rays @ axes.T
    start = axes @ offset
    with np.errstate(divide="ignore"):
        sides = np.stack([(start - size / 2) / speed, (start + size / 2) / speed])
    enter = sides.min(axis=0).max(axis=1)
    leave = sides.max(axis=0).min(axis=1)
    met = (enter < leave) & (enter > 0)
    return rays[met], np.cos(e)[met], enter[met]


def _cells(mode: Mapping[str, Any], offset: Floats, box: _Box) -> float:
    """Cells from the box's mean chord and width, found by lines across it seen from above."""
    size = box.size
    far = float(np.linalg.norm(offset))
    bearing = math.atan2(offset[1], offset[0]) - box.yaw
    ahead = np.array([math.cos(bearing), math.sin(bearing)])
    aside = np.array([-math.sin(bearing), math.cos(bearing)])
    corners = np.array([[i, j] for i in (-1, 1) for j in (-1, 1)]) / 2 * size[:2]
    across = corners @ aside
    lines = across.min() + (np.arange(4001) + 0.5) / 4001 * np.ptp(across)
    starts = lines[:, None] * aside
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = np.stack([(-size[:2] / 2 - starts) / ahead, (size[:2] / 2 - starts) / ahead])
    chord = np.maximum(sides.max(axis=0).min(axis=1) - sides.min(axis=0).max(axis=1), 0.0)
    cells = max(1.0, float(chord.mean()) / mode["range_resolution_m"])
    cells *= max(1.0, float(np.ptp(across)) / far / math.radians(mode["azimuth_resolution_deg"]))
    return cells * max(1.0, float(size[2]) / far / math.radians(mode["elevation_resolution_deg"]))


def _blocked(eye: Floats, rays: Floats, enter: Floats, triangles: Floats) -> Flags:
    """Whether a triangle is before the box, by determinants, triangle by triangle."""
    blocked = np.zeros(len(rays), bool)
    for a, b, c in triangles:
        one = b - a
        two = c - a
        start = eye - a
        cross = np.cross(rays, two)
        det = cross @ one
        with np.errstate(divide="ignore", invalid="ignore"):
            u = cross @ start / det
            normal = np.cross(start, one)
            v = rays @ normal / det
            t = two @ normal / det
        blocked |= (det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-6) & (t < enter)
    return blocked
