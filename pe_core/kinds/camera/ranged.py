"""Voxels out of a camera's range: told by their centres."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import dot
from .model import Camera

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Mask = NDArray[np.bool_]


def is_ranged(camera: Camera) -> bool:
    """Whether a camera has a range at all."""
    return camera.min_range > 0.0 or camera.max_range < math.inf


def out_of_range(camera: Camera, offsets: Floats) -> Mask:
    """Whether centres (V, 3), from the camera [m], are nearer or farther than it sees."""
    return _beyond(camera, dot(offsets, offsets))


def cut_to_range(camera: Camera, area: Singles, axes: list[Floats], first: tuple[int, int]) -> None:
    """Set the areas (n, rows, nz) of voxels out of range to 0.

    `axes` are their places along each axis, `first` the first plane and row.
    """
    x, y, z = axes
    y = y[first[1] : first[1] + area.shape[1]]
    for plane, here in zip(area, x[first[0] :], strict=False):
        plane[_beyond(camera, (here * here + y * y)[:, None] + z * z)] = 0.0


def _beyond(camera: Camera, square: Floats) -> Mask:
    beyond: Mask = square > camera.max_range**2
    if camera.min_range > 0.0:
        beyond |= square < camera.min_range**2
    return beyond
