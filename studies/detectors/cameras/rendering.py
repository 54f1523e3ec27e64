"""Pictures of the study's scenes, by the engine's own rays: one ray a pixel, simple shading.

Each object and distractor has a colour of its own, drawn for the scene, so that no class has a
colour. Light is that of a sun and of the sky; there are no shadows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pe_core.geometry.ray_traversal import TriangleTree
from pe_core.sensors.camera.model import picture_rays

from ..casting import RegionPictures, beams_on_objects, first_hits, region_objects
from ..placements import Placement, vehicle
from ..plan import PLAIN, SPLITS
from ..scenes import Scene, scene
from .plan import CameraPlan, PictureRule

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LOOK, NOISE = 11, 12
"""Make the seeds of colours and of noise other ones than that of the scene."""
SUN_DEG = (20.0, 70.0)
"""Elevation of the sun."""
COLORS = (0.05, 0.95)
"""Red, green and blue of a surface."""
GROUND, TINT = (0.25, 0.6), 0.03
"""Brightness of the ground, and the deviation of its red, green and blue."""
SKY = ((0.4, 0.8), (0.5, 0.9), (0.6, 1.0))
WAVES, WAVE_M = 4, (1.5, 20.0)
"""Waves of brightness on the ground, and their lengths."""
BODY = 0.15
"""Brightness of the own vehicle."""
WHITE = 255.0


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
    def of(cls, content: Scene, rule: PictureRule, rng: np.random.Generator) -> SceneColors:
        """Return the colours of a scene, drawn at random."""
        elevation, azimuth = np.radians(rng.uniform(*SUN_DEG)), rng.uniform(0.0, 2.0 * np.pi)
        flat = np.cos(elevation)
        sun = np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])
        first, second = (content.triangles[:, k] - content.triangles[:, 0] for k in (1, 2))
        normals = np.cross(first, second)
        normals /= np.maximum(np.sqrt((normals**2).sum(axis=1, keepdims=True)), 1e-12)
        light = rule.ambient + (1.0 - rule.ambient) * np.maximum(normals @ sun, 0.0)
        solids = rng.uniform(*COLORS, (int(content.solids.max(initial=-1)) + 1, 3))
        lengths, turns = rng.uniform(*WAVE_M, WAVES), rng.uniform(0.0, np.pi, WAVES)
        waves = np.stack([np.cos(turns), np.sin(turns)], axis=1) * (2.0 * np.pi / lengths)[:, None]
        ground = rng.uniform(*GROUND) + rng.normal(0.0, TINT, 3)
        return cls(
            solids[content.solids] * light[:, None],
            ground * (rule.ambient + (1.0 - rule.ambient) * sun[2]),
            np.array([rng.uniform(*bounds) for bounds in SKY]),
            waves,
            rng.uniform(0.0, 2.0 * np.pi, WAVES),
            rule.ground_contrast,
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

    def __init__(self, plan: CameraPlan, placement: Placement, number: int) -> None:
        sensor = placement.rig(plan.model).sensors[number]
        width, height = plan.model.width, plan.model.height
        rays = picture_rays(sensor, width * height)
        self.origin = np.array(sensor.pose.position)
        hits = vehicle(placement.vehicle).first_hit(sensor.pose.position, rays, True)
        free = np.isinf(hits.distance)
        self.directions, self.free = rays[free], free.reshape(width, height)


class Renderer:
    """Renders scenes as a placement's cameras see them."""

    def __init__(self, plan: CameraPlan, placement: Placement) -> None:
        self._plan, self._placement = plan, placement
        self.cameras = [FreePixels(plan, placement, k) for k in range(len(placement.poses))]

    def pictures(self, split: str, number: int) -> RegionPictures:
        """Return the pictures of a scene."""
        study, rule = self._plan.study, self._plan.pictures
        content = scene(study, self._placement.vehicle, split, PLAIN, number)
        seed = [study.seed, SPLITS.index(split), number]
        colors = SceneColors.of(content, rule, np.random.default_rng([*seed, LOOK]))
        tree, beams = TriangleTree(content.triangles), np.zeros(len(content.labels), np.int64)
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
