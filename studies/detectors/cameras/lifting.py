"""Where the cells of the ground are in a rig's pictures, by the known poses of the cameras.

A detector takes the features of a cell from there, at a few heights above the ground (the idea of
Simple-BEV, Harley et al., arXiv 2206.07959). What the own body hides is in no picture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pe_core.geometry import rotate, rotation_matrix
from pe_core.scene.rig import Sensor
from pe_core.sensors.camera.model import picture_rays

from ..batches import STRIDE
from ..placements import Placement, pose_of
from ..plan import DetectionRegion
from .placements import in_picture
from .plan import CameraPlan
from .rendering import FreePixels, Renderer

Floats = NDArray[np.float64]

HEIGHTS_M = (0.2, 0.8, 1.5)
"""Heights above the ground at which a cell takes features."""
VIEWS = 2
"""At most so many cameras give features of a point: those nearest to it."""
CELL_VALUES = 4
"""Values of a cell's geometry: seen or not, direction from the nearest camera (2), distance."""
FAR_M = 40.0
"""Distance at which that value is 1."""
NEAR_M = 4.0
"""Nearer ground is as this one for a pixel's value."""


@dataclass(frozen=True, slots=True)
class Lifting:
    """Where the cells of the ground are in the pictures of a rig."""

    pixels: NDArray[np.int32]
    """Flat indices of coarse pixels over (camera, column, row); their total number for none.

    (X * Y, heights, VIEWS), as the weights of the views: 1 in all, or 0 where there is none.
    """
    shares: NDArray[np.float32]
    cells: NDArray[np.float32]
    """Geometry of the cells, (X, Y, CELL_VALUES)."""
    nearness: NDArray[np.float32]
    """Of coarse pixels (S, W, H, 1): `NEAR_M` over the distance to flat ground; 0 in the sky."""

    @classmethod
    def of(cls, plan: CameraPlan, placement: Placement) -> Lifting:
        """Return that of a placement; a coarse pixel is `STRIDE` by `STRIDE` pixels."""
        cameras = Renderer(plan, placement).cameras
        shape = plan.model.width // STRIDE, plan.model.height // STRIDE
        ground = _cell_centers(plan.study.region)
        points = np.stack([np.insert(ground, 2, z, axis=-1) for z in HEIGHTS_M], axis=1)
        views = [
            _view(plan, pose_of(values).rpy, camera, points, shape)
            for values, camera in zip(placement.poses, cameras, strict=True)
        ]
        total = len(cameras) * shape[0] * shape[1]
        pixels = np.stack(
            [np.where(v < 0, total, k * shape[0] * shape[1] + v) for k, v in enumerate(views)], -1
        )
        away = np.stack([np.hypot(*(points - c.origin)[..., :2].T).T for c in cameras], axis=-1)
        nearest = np.argsort(np.where(pixels < total, away, np.inf), axis=-1, kind="stable")
        pixels = np.take_along_axis(pixels, nearest[..., :VIEWS], axis=-1)
        is_seen = pixels < total
        shares = is_seen / np.maximum(is_seen.sum(axis=-1, keepdims=True), 1)
        origins = np.array([c.origin for c in cameras])[nearest[:, 0, 0], :2]
        cells = _cell_values(ground - origins, is_seen.any(axis=(1, 2)))
        nx, ny = (n // STRIDE for n in plan.study.region.shape)
        return cls(
            pixels.astype(np.int32),
            shares.astype(np.float32),
            cells.reshape(nx, ny, CELL_VALUES).astype(np.float32),
            np.stack([_nearness(s, shape) for s in placement.rig(plan.model)]),
        )


def _cell_centers(region: DetectionRegion) -> Floats:
    """Return the centres (X * Y, 2) of the cells of the detector's output [m]."""
    side = STRIDE * region.cell_m
    nx, ny = (n // STRIDE for n in region.shape)
    x, y = np.meshgrid(np.arange(nx) + 0.5, np.arange(ny) + 0.5, indexing="ij")
    return np.column_stack([x.ravel() * side - region.x_m, y.ravel() * side - region.y_m])


def _view(
    plan: CameraPlan,
    rpy: tuple[float, float, float],
    camera: FreePixels,
    points: Floats,
    shape: tuple[int, int],
) -> NDArray[np.int64]:
    """Return the coarse pixels (...) of points (..., 3) in one picture; -1 for none."""
    offsets = rotate(rotation_matrix(*rpy).T, (points - camera.origin).reshape(-1, 3))
    columns, rows, inside = in_picture(plan.model, offsets)
    column, row = (np.where(inside, w, 0.0).astype(np.int64) for w in (columns, rows))
    inside &= camera.free[column, row]
    coarse = (column // STRIDE) * shape[1] + row // STRIDE
    return np.where(inside, coarse, -1).reshape(points.shape[:-1])


def _cell_values(offsets: Floats, is_seen: NDArray[np.bool_]) -> Floats:
    """Return the geometry (N, CELL_VALUES) of cells from their offsets (N, 2) to a camera [m]."""
    distance = np.hypot(offsets[:, 0], offsets[:, 1])
    directions = offsets / np.maximum(distance, 1e-9)[:, None]
    values = np.column_stack([np.ones(len(offsets)), directions, distance / FAR_M])
    return np.where(is_seen[:, None], values, 0.0)


def _nearness(sensor: Sensor, shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return the value (W, H, 1) of coarse pixels that says how near the ground is."""
    down = -picture_rays(sensor, shape[0] * shape[1])[:, 2].reshape(*shape, 1)
    nearness = NEAR_M * down / sensor.pose.position[2]
    return np.clip(nearness, 0.0, 1.0).astype(np.float32)
