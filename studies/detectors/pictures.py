"""Pictures of the study's scenes, by the engine's own rays: one ray a pixel, simple shading.

Each object and distractor has a colour of its own, drawn for the scene, so that no class has a
colour. Light is that of a sun and of the sky; there are no shadows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pe_core.base import Flags, Floats, Ints, Singles
from pe_core.geometry import rotate, rotation_matrix
from pe_core.geometry.ray_traversal import TriangleTree
from pe_core.scene.rig import Sensor
from pe_core.sensors.camera import Camera
from pe_core.sensors.camera.model import picture_rays

from .batches import STRIDE
from .casting import RegionPictures, beams_on_objects, first_hits, region_objects
from .placements import Placement, camera_model, in_picture, pose_of, vehicle
from .plan import PLAIN, SPLITS, Plan, shape_of
from .scenes import Scene, scene

LOOK = 11
NOISE = 12
"""Make the seeds of colours and of noise other ones than that of the scene."""
SUN_DEG = (20.0, 70.0)
"""Elevation of the sun."""
COLORS = (0.05, 0.95)
"""Red, green and blue of a surface."""
GROUND = (0.25, 0.6)
TINT = 0.03
"""Brightness of the ground, and the deviation of its red, green and blue."""
SKY = ((0.4, 0.8), (0.5, 0.9), (0.6, 1.0))
WAVES = 4
WAVE_M = (1.5, 20.0)
"""Waves of brightness on the ground, and their lengths."""
BODY = 0.15
"""Brightness of the own vehicle."""
WHITE = 255.0
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
class SceneColors:
    """What a scene looks like: colours of the triangles (F, 3) in its light, of ground and sky.

    `waves` (K, 2) are wave vectors of the brightness of the ground [rad/m], with their phases.
    """

    triangles: Floats
    ground: Floats
    sky: Floats
    waves: Floats
    phases: Floats
    contrast: float

    @classmethod
    def of(cls, content: Scene, rule: Plan, rng: np.random.Generator) -> SceneColors:
        """Return the colours of a scene, drawn at random."""
        elevation = np.radians(rng.uniform(*SUN_DEG))
        azimuth = rng.uniform(0.0, 2.0 * np.pi)
        flat = np.cos(elevation)
        sun = np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])
        first, second = (content.triangles[:, k] - content.triangles[:, 0] for k in (1, 2))
        normals = np.cross(first, second)
        normals /= np.maximum(np.sqrt((normals**2).sum(axis=1, keepdims=True)), 1e-12)
        light = rule.ambient + (1.0 - rule.ambient) * np.maximum(normals @ sun, 0.0)
        solids = rng.uniform(*COLORS, (int(content.solids.max(initial=-1)) + 1, 3))
        lengths = rng.uniform(*WAVE_M, WAVES)
        turns = rng.uniform(0.0, np.pi, WAVES)
        waves = np.stack([np.cos(turns), np.sin(turns)], axis=1) * (2.0 * np.pi / lengths)[:, None]
        ground = rng.uniform(*GROUND) + rng.normal(0.0, TINT, 3)
        return cls(
            solids[content.solids] * light[:, None],
            ground * (rule.ambient + (1.0 - rule.ambient) * sun[2]),
            np.array([rng.uniform(*bounds) for bounds in SKY]),
            waves,
            phases=rng.uniform(0.0, 2.0 * np.pi, WAVES),
            contrast=rule.ground_contrast,
        )

    def seen(self, points: Floats, face: Ints) -> Floats:
        """Return the colours (B, 3) of hits: points (B, 3), inf for the sky, and triangles (B,)."""
        colors = np.tile(self.sky, (len(face), 1))
        met = np.flatnonzero(face >= 0)
        colors[met] = self.triangles[face[met]]
        on_ground = np.flatnonzero((face < 0) & np.isfinite(points[:, 0]))
        phases = points[on_ground, :2] @ self.waves.T + self.phases
        pattern = 1.0 + self.contrast * np.sin(phases).sum(axis=1)
        colors[on_ground] = self.ground * pattern[:, None]
        return colors


class FreePixels:
    """The pixels of one camera, and which of them the own body does not hide: `free` (W, H).

    `directions` (N, 3) are those of the free pixels, ground frame.
    """

    def __init__(self, plan: Plan, placement: Placement, number: int) -> None:
        model = camera_model(plan.cameras.rig)
        sensor = placement.rig(model).sensors[number]
        width = model.width
        height = model.height
        rays = picture_rays(sensor, width * height)
        self.origin = np.array(sensor.pose.position)
        hits = vehicle(placement.vehicle).first_hit(sensor.pose.position, rays, True)
        free = np.isinf(hits.distance)
        self.directions = rays[free]
        self.free = free.reshape(width, height)


class Renderer:
    """Renders scenes as a placement's cameras see them."""

    def __init__(self, plan: Plan, placement: Placement) -> None:
        self._plan = plan
        self._placement = placement
        self.cameras = [FreePixels(plan, placement, k) for k in range(len(placement.poses))]

    def pictures(self, split: str, number: int) -> RegionPictures:
        """Return the pictures of a scene."""
        study = self._plan
        rule = self._plan.cameras.pictures
        content = scene(study, self._placement.vehicle, split, PLAIN, number=number)
        seed = [study.seed, SPLITS.index(split), number]
        colors = SceneColors.of(content, rule, np.random.default_rng([*seed, LOOK]))
        tree = TriangleTree(content.triangles)
        beams = np.zeros(len(content.labels), np.int64)
        pictures = []
        for k, camera in enumerate(self.cameras):
            distance, face = first_hits(tree, content.flat, camera.origin, camera.directions)
            beams += beams_on_objects(content, face)
            points = camera.origin + distance[:, None] * camera.directions
            picture = np.full((*camera.free.shape, 3), BODY)
            picture[camera.free] = colors.seen(points, face)
            rng = np.random.default_rng([*seed, NOISE, k])
            noisy = picture + rng.normal(0.0, rule.noise, picture.shape)
            pictures.append(np.clip(np.rint(noisy * WHITE), 0.0, WHITE).astype(np.uint8))
        return RegionPictures(*region_objects(content, beams, study.region), np.stack(pictures))


@dataclass(frozen=True, slots=True)
class Lifting:
    """Where the cells of the ground are in the pictures of a rig."""

    pixels: NDArray[np.int32]
    """Flat indices of coarse pixels over (camera, column, row); their total number for none.

    (X * Y, heights, VIEWS), as the weights of the views: 1 in all, or 0 where there is none.
    """
    shares: Singles
    cells: Singles
    """Geometry of the cells, (X, Y, CELL_VALUES)."""
    nearness: Singles
    """Of coarse pixels (S, W, H, 1): `NEAR_M` over the distance to flat ground; 0 in the sky."""

    @classmethod
    def of(cls, plan: Plan, placement: Placement) -> Lifting:
        """Return that of a placement; a coarse pixel is `STRIDE` by `STRIDE` pixels."""
        cameras = Renderer(plan, placement).cameras
        model = camera_model(plan.cameras.rig)
        shape = model.width // STRIDE, model.height // STRIDE
        ground = _cell_centers(plan.region)
        points = np.stack([np.insert(ground, 2, z, axis=-1) for z in HEIGHTS_M], axis=1)
        views = [
            _view(model, pose_of(values).rpy, camera, points, shape=shape)
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
        nx, ny = (n // STRIDE for n in shape_of(plan.region))
        return cls(
            pixels.astype(np.int32),
            shares.astype(np.float32),
            cells.reshape(nx, ny, CELL_VALUES).astype(np.float32),
            np.stack([_nearness(s, shape) for s in placement.rig(model)]),
        )


def _cell_centers(region: Plan) -> Floats:
    """Return the centres (X * Y, 2) of the cells of the detector's output [m]."""
    side = STRIDE * region.cell_m
    nx, ny = (n // STRIDE for n in shape_of(region))
    x, y = np.meshgrid(np.arange(nx) + 0.5, np.arange(ny) + 0.5, indexing="ij")
    return np.column_stack([x.ravel() * side - region.x_m, y.ravel() * side - region.y_m])


def _view(
    model: Camera,
    rpy: tuple[float, float, float],
    camera: FreePixels,
    points: Floats,
    shape: tuple[int, int],
) -> Ints:
    """Return the coarse pixels (...) of points (..., 3) in one picture; -1 for none."""
    offsets = rotate(rotation_matrix(*rpy).T, (points - camera.origin).reshape(-1, 3))
    columns, rows, inside = in_picture(model, offsets)
    column, row = (np.where(inside, w, 0.0).astype(np.int64) for w in (columns, rows))
    inside &= camera.free[column, row]
    coarse = (column // STRIDE) * shape[1] + row // STRIDE
    return np.where(inside, coarse, -1).reshape(points.shape[:-1])


def _cell_values(offsets: Floats, is_seen: Flags) -> Floats:
    """Return the geometry (N, CELL_VALUES) of cells from their offsets (N, 2) to a camera [m]."""
    distance = np.hypot(offsets[:, 0], offsets[:, 1])
    directions = offsets / np.maximum(distance, 1e-9)[:, None]
    values = np.column_stack([np.ones(len(offsets)), directions, distance / FAR_M])
    return np.where(is_seen[:, None], values, 0.0)


def _nearness(sensor: Sensor, shape: tuple[int, int]) -> Singles:
    """Return the value (W, H, 1) of coarse pixels that says how near the ground is."""
    down = -picture_rays(sensor, shape[0] * shape[1])[:, 2].reshape(*shape, 1)
    nearness = NEAR_M * down / sensor.pose.position[2]
    return np.clip(nearness, 0.0, 1.0).astype(np.float32)
