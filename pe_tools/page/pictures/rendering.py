"""Rendering: cast rays through the pixels, and shade faces flat by their slope to a lamp beside the
eye. The 3-D view beside the picture has the light and the shadows."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pe_core.base.arrays import Floats

from ... import graphics
from .painted_mesh import unit
from .ray_scene import GROUND, NOTHING, SKY, RayCamera, RayHits, RayScene

LAMP = np.array([0.3, -0.2, 1.3])
"""Direction to the lamp relative to the ray back to the eye, in the ground frame: from above."""
AMBIENT = 0.35  # Share of the light on a face that looks away from the lamp
OUTSIDE_LENS = (0.11, 0.115, 0.125)  # Colour outside the image circle of a lens; sRGB
SUBPIXELS = ((-0.33, -0.17), (0.0, 0.33), (0.33, -0.17))
"""Rays of a pixel, from its middle [px]: their mean smooths the edges."""


@dataclass(frozen=True, eq=False)
class Environment:
    """Ground and sky around the solids; colours (N, 3) are linear. `ground` takes points (N, 3) of
    the ground, the rays (N, 3) that meet it, and the width (N,) of a pixel there [m]; `sky` takes
    directions (N, 3)."""

    ground: Callable[[Floats, Floats, Floats], Floats]
    sky: Callable[[Floats], Floats]


def render(camera: RayCamera, scene: RayScene, environment: Environment) -> Floats:
    """(H, W, 3) sRGB, 0 to 1: the picture of a scene."""
    down, right = np.mgrid[: camera.height, : camera.width] + 0.5
    total = np.zeros((camera.height * camera.width, 3))
    for across, below in SUBPIXELS:
        rays = camera.rays_through(right.ravel() + across, down.ravel() + below)
        total += shade(scene.first_hits(camera, rays), environment, camera.pixel_rad)
    return (total / len(SUBPIXELS)).reshape(camera.height, camera.width, 3)


def shade(hits: RayHits, environment: Environment, pixel_rad: float) -> Floats:
    """(N, 3) sRGB colours of first hits."""
    color = np.zeros((len(hits.surface), 3))
    at = np.flatnonzero(hits.surface == SKY)
    color[at] = environment.sky(hits.directions[at])
    at = np.flatnonzero(hits.surface == GROUND)
    slope = np.maximum(-hits.directions[at, 2], 1e-3)
    width = hits.distance[at] * pixel_rad / slope
    color[at] = environment.ground(hits.points[at], hits.directions[at], width)
    at = np.flatnonzero(hits.surface > GROUND)
    color[at] = hits.color[at] * _light(hits.normals[at], hits.directions[at])[:, None]
    srgb = graphics.srgb_of_linear(np.clip(color, 0.0, 1.0))
    srgb[hits.surface == NOTHING] = OUTSIDE_LENS
    return srgb


def _light(normals: Floats, rays: Floats) -> Floats:
    """(N,) light on faces with unit normals (N, 3), from the lamp beside the eye."""
    slope = np.maximum((unit(LAMP - rays) * normals).sum(axis=1), 0.0)
    return np.asarray(AMBIENT + (1.0 - AMBIENT) * slope)
