"""Rendering: cast rays, shade paint and ground under sun and sky, antialias the edges. Rays cast
from a lamp far away show what the sun illuminates; everything else is in its shadow."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pe_core.base.arrays import Flags, Floats, Ints

from ... import graphics
from .painted_mesh import unit
from .ray_scene import GROUND, NOTHING, SKY, RayCamera, RayHits, RayScene

SUN, UPPER, LOWER = np.array([1.16, 1.11, 1.04]), np.array([0.50, 0.54, 0.60]), np.array([0.30] * 3)
"""Linear light of the sun, of the sky above and of the ground below."""
MIRRORED = 0.07  # Share of light that paint mirrors at normal incidence (Schlick's formula)
GLOSS = 220.0  # Exponent of the sun's highlight
KNEE = 0.75  # Linear light above this value is compressed, so that it approaches white
OUTSIDE_LENS = (0.11, 0.115, 0.125)  # Colour outside the image circle of a lens; sRGB

SUN_M = 1000.0  # Distance of the lamp that stands for the sun
SHADOW = 12.0  # Ground farther than this from every solid is in no shadow, in heights of the solid
SURFACE_OFFSET_M = 0.02  # Distance from a surface at which its light is evaluated
STANDS_M = 0.5  # A solid whose lowest point is higher takes no sky from the ground
SUBPIXELS = ((-0.375, -0.125), (-0.125, 0.375), (0.125, -0.375), (0.375, 0.125))
"""Rays within a pixel at an edge: no two in one row or column."""
EDGE_COSINE = 0.92  # Cosine of the angle between neighbouring normals below which there is an edge
EDGE_STEP = 0.06  # Relative step of neighbouring distances above which there is an edge


@dataclass(frozen=True, eq=False)
class Environment:
    """Ground, sky, sun and haze around the solids; colours (N, 3) are linear. `ground` takes points
    (N, 3) of the ground and the width (N,) of a pixel there [m], and returns colours; `sky` takes
    directions (N, 3), and returns colours; `sun` (3,) is the direction to the sun; `haze` takes
    points of the ground, and returns how far (N,) they fade into the sky, 0 to 1."""

    ground: Callable[[Floats, Floats], Floats]
    sky: Callable[[Floats], Floats]
    sun: Floats
    haze: Callable[[Floats], Floats]


def render(camera: RayCamera, scene: RayScene, environment: Environment) -> Floats:
    """(H, W, 3) sRGB, 0 to 1: the picture of a scene; pixels at edges are means of several rays."""
    shape = camera.height, camera.width
    hits = scene.first_hits(camera, camera.directions())
    sun = sunlight(scene, hits, environment.sun)
    colors = shade(hits, environment, sun, skylight(scene, hits), camera.pixel_rad)
    edges = np.flatnonzero(_edges(hits, sun, shape))
    row, column = np.divmod(edges, camera.width)
    total = np.zeros((len(edges), 3))
    for right, down in SUBPIXELS:
        rays = camera.rays_through(column + 0.5 + right, row + 0.5 + down)
        subpixel = scene.first_hits(camera, rays)
        light = sunlight(scene, subpixel, environment.sun), skylight(scene, subpixel)
        total += shade(subpixel, environment, *light, camera.pixel_rad)
    colors[edges] = total / len(SUBPIXELS)
    return colors.reshape(*shape, 3)


def sunlight(scene: RayScene, hits: RayHits, direction: Floats) -> Floats:
    """(N,) share of full light from a sun in a direction (3,): 0 in the shade."""
    sun = unit(direction) * SUN_M
    light = np.zeros(len(hits.surface))
    pixels = np.flatnonzero(hits.is_surface)
    points, normals = hits.points[pixels], hits.normals[pixels]
    slope = (unit(sun - points) * normals).sum(axis=1)
    facing = slope > 0.0
    pixels, points, slope = pixels[facing], points[facing], slope[facing]
    near = np.flatnonzero(_may_be_shaded(scene, hits, pixels))
    lit = np.ones(len(pixels), bool)
    lit[near] = scene.lit(sun, points[near] + SURFACE_OFFSET_M * normals[facing][near])
    light[pixels] = slope * lit
    return light


def skylight(scene: RayScene, hits: RayHits) -> Floats:
    """(N,) share of the sky that surfaces see: the ground beside a solid less."""
    sky, at = np.ones(len(hits.surface)), np.flatnonzero(hits.surface == GROUND)
    points = hits.points[at, :2]
    for low, high in (solid.mesh.bounds for solid in scene.solids):
        if low[2] < STANDS_M:
            away = np.maximum(np.maximum(low[:2] - points, points - high[:2]), 0.0)
            away = np.hypot(away[:, 0], away[:, 1])
            sky[at] *= 0.3 + 0.7 * away / np.hypot(away, 0.4 * float(high[2]))
    return sky


def _may_be_shaded(scene: RayScene, hits: RayHits, pixels: Ints) -> Flags:
    """Return which pixels show a solid, or ground as near to one as shadows are long."""
    near = hits.surface[pixels] > GROUND
    x, y = hits.points[pixels, 0], hits.points[pixels, 1]
    for low, high in (solid.mesh.bounds for solid in scene.solids):
        far = SHADOW * float(high[2])
        inside = (x > low[0] - far) & (x < high[0] + far) & (y > low[1] - far) & (y < high[1] + far)
        near |= inside & (hits.surface[pixels] == GROUND)
    return near


def _edges(hits: RayHits, sun: Floats, shape: tuple[int, int]) -> Flags:
    """(H * W,) whether a pixel has a neighbour of another surface, part, light or slope."""
    edges = np.zeros(shape, bool)
    grids = [values.reshape(shape) for values in (hits.surface, hits.part, sun > 0.0)]
    far = np.minimum(hits.distance, 1e6).reshape(shape)
    normals = hits.normals.reshape(*shape, 3)
    solid = (hits.surface > 0).reshape(shape)
    for axis in (0, 1):
        one, two = ((slice(None),) * axis + (side,) for side in (slice(None, -1), slice(1, None)))
        differs = np.zeros(grids[0][one].shape, bool)
        for grid in grids:
            differs |= grid[one] != grid[two]
        bent = np.einsum("...k,...k->...", normals[one], normals[two]) < EDGE_COSINE
        jump = np.abs(far[one] - far[two]) > EDGE_STEP * np.minimum(far[one], far[two])
        differs |= bent | (jump & solid[one] & solid[two])
        edges[one] |= differs
        edges[two] |= differs
    return edges.ravel()


def shade(
    hits: RayHits, environment: Environment, sun: Floats, sky: Floats, pixel_rad: float
) -> Floats:
    """(N, 3) sRGB colours of first hits; `sun` and `sky` (N,) are the light on them."""
    color = np.zeros((len(hits.surface), 3))
    at = np.flatnonzero(hits.surface == SKY)
    color[at] = environment.sky(hits.directions[at])
    at = np.flatnonzero(hits.surface == GROUND)
    color[at] = _ground(hits[at], environment, sun[at], sky[at], pixel_rad)
    at = np.flatnonzero(hits.is_solid)
    color[at] = _paint(hits[at], environment, sun[at], sky[at])
    # Values above `KNEE` approach white smoothly.
    room, over = 1.0 - KNEE, np.maximum(color - KNEE, 0.0)
    soft = np.where(over > 0.0, KNEE + room * (1.0 - np.exp(-over / room)), color)
    srgb = graphics.srgb_of_linear(np.clip(soft, 0.0, 1.0))
    srgb[hits.surface == NOTHING] = OUTSIDE_LENS
    return srgb


def _ground(
    hits: RayHits, environment: Environment, sun: Floats, sky: Floats, pixel_rad: float
) -> Floats:
    """Return colours of the ground: its own colour in full light, darker in the shade."""
    slope = np.maximum(-hits.directions[:, 2], 1e-3)
    ground = environment.ground(hits.points, hits.distance * pixel_rad / slope)
    full = float(unit(environment.sun)[2])
    light = 0.52 * np.clip(sun / full, 0.0, 1.0) + 0.48 * sky
    faded = environment.haze(hits.points)[:, None]
    return ground * light[:, None] * (1.0 - faded) + environment.sky(hits.directions) * faded


def _paint(hits: RayHits, environment: Environment, sun: Floats, sky: Floats) -> Floats:
    """Return colours of paint: diffuse light, and reflections of sky and sun."""
    normals, rays, shine = hits.normals, hits.directions, hits.color[:, 3]
    up = (0.5 + 0.5 * normals[:, 2])[:, None]
    around = (LOWER * (1.0 - up) + UPPER * up) * sky[:, None]
    scattered = hits.color[:, :3] * (around + SUN * sun[:, None])
    along = np.clip(-(rays * normals).sum(axis=1), 0.0, 1.0)
    mirrored = MIRRORED + (1.0 - MIRRORED) * (1.0 - along) ** 5
    back = rays + 2.0 * along[:, None] * normals
    bright = _mirrored_light(back[:, 2]) * (0.35 + 0.65 * sky)
    glint = np.maximum((back * unit(environment.sun)).sum(axis=1), 0.0) ** GLOSS
    glint = np.where(sun > 0.0, 1.6 * glint, 0.0)
    return scattered + ((mirrored * bright + glint * 0.5) * shine)[:, None] * UPPER / UPPER[1]


def _mirrored_light(up: Floats) -> Floats:
    """(N,) light from directions whose vertical component is `up`: bright horizon, dark ground."""
    sky = 1.0 - 0.45 * np.clip(up, 0.0, 1.0)
    ground = 0.22 + 0.5 * np.exp(5.0 * np.minimum(up, 0.0))
    part = np.clip(up / 0.06 + 0.5, 0.0, 1.0)
    return ground * (1.0 - part) + sky * part
