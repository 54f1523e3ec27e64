"""Points of a rig in a scene: first hits of all beams, with noise; and their counts in voxels.

Beams are cast by the engine's own first hits. Which beams the vehicle's own body blocks does not
depend on the scene, so it is computed once for a placement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pe_core.geometry import rotate
from pe_core.geometry.ray_traversal import TriangleTree
from pe_core.geometry.raycast import VisibleTriangles
from pe_core.sensors.lidar import Lidar

from .placements import Placement, vehicle
from .plan import SPLITS, DetectionRegion, StudyPlan
from .scenes import NOBODY, Scene, scene

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
SceneSource = Callable[[StudyPlan, str, str, str, int], Scene]
"""Returns a scene, as `scene` does, from plan, vehicle, split, world and number."""

LAYERS_M = (-0.4, 0.15, 0.35, 0.6, 0.9, 1.3, 1.8, 2.6, 4.2)
"""Edges of the voxels' layers [m]."""
MAX_COUNT = 255
MAX_POINTS = 12_288
"""Points of a scene that the detector *points* takes; of more, some are drawn at random."""
GROUND_M = 0.15
"""Points up to this height are taken last: most of them are of the ground."""
NOISE = 7
"""Makes the seed of the noise another one than that of the scene."""


@dataclass(frozen=True, slots=True)
class Points:
    """Points of a scene in the ground frame: positions (N, 3) with noise [m].

    `beams` (K,) end on each object that is to be found, before points are dropped.
    """

    positions: Floats
    beams: Ints


@dataclass(frozen=True, slots=True)
class RegionObjects:
    """The objects of a scene in the region: centres (K, 2) [m], classes, beams that end on each."""

    centers: NDArray[np.float32]
    labels: NDArray[np.uint8]
    beams: NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class RegionVoxels(RegionObjects):
    """Points of a scene counted in voxels: the input of the detector *grid*.

    `cells` (N,) are flat indices of voxels with points, over (x, y, layer); `layers` may be of
    several frames.
    """

    cells: NDArray[np.int32]
    counts: NDArray[np.uint8]
    layers: int = len(LAYERS_M) - 1


@dataclass(frozen=True, slots=True)
class Cloud(RegionObjects):
    """The input of the detector *points*: (N, 3), those above the ground first."""

    points: NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class RegionPictures(RegionObjects):
    """The input of the detector of cameras: pictures (S, W, H, 3). Beams are pixels."""

    pictures: NDArray[np.uint8]


def region_objects(
    content: Scene, beams: Ints, region: DetectionRegion
) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.int32]]:
    """Return centres, classes and beams of the objects in the region; beams (K,) are of all."""
    inside = np.abs(content.centers) <= (region.x_m, region.y_m)
    which = np.flatnonzero(inside.all(axis=1))
    return (
        content.centers[which].astype(np.float32),
        content.labels[which].astype(np.uint8),
        beams[which].astype(np.int32),
    )


def beams_on_objects(content: Scene, face: Ints) -> Ints:
    """Return the number of beams that end on each object (K,), from their triangles (B,)."""
    owners = content.owners[face[face >= 0]]
    return np.bincount(owners[owners >= 0], minlength=len(content.labels))


def first_hits(
    tree: TriangleTree, flat: bool, origin: Floats, directions: Floats
) -> tuple[Floats, Ints]:
    """Return distance (B,) [m], inf for a miss, and triangle (B,), -1 for flat ground and misses.

    `flat` says whether there is flat ground at z = 0; directions (B, 3) are of length 1.
    """
    hits = VisibleTriangles(tree, origin).first_hit(directions)
    distance, face = hits.distance, hits.face
    if flat:
        down = directions[:, 2]
        with np.errstate(divide="ignore"):
            to_ground = np.where(down < 0.0, -origin[2] / down, np.inf)
        face = np.where(to_ground < distance, NOBODY, face)
        distance = np.minimum(distance, to_ground)
    return distance, face


class FreeBeams:
    """The beams of one LiDAR that its vehicle's body does not block: directions (B, 3)."""

    def __init__(self, placement: Placement, number: int) -> None:
        sensor = placement.rig().sensors[number]
        model = sensor.model
        assert isinstance(model, Lidar)
        self.origin = np.array(sensor.pose.position)
        directions = rotate(sensor.pose.ground_from_sensor, model.directions)
        hits = vehicle(placement.vehicle).first_hit(sensor.pose.position, directions)
        self.directions = directions[np.isinf(hits.distance)]
        self.min_range, self.max_range = model.min_range, model.max_range

    def first_hits(self, tree: TriangleTree, flat: bool) -> tuple[Floats, Ints]:
        """Return distance (B,) [m], inf for a miss, and triangle (B,), -1 for ground and misses."""
        distance, face = first_hits(tree, flat, self.origin, self.directions)
        in_range = (distance >= self.min_range) & (distance <= self.max_range)
        return np.where(in_range, distance, np.inf), np.where(in_range, face, NOBODY)


class Caster:
    """Casts the beams of a placement into scenes of a world, which `source` returns."""

    def __init__(
        self, plan: StudyPlan, placement: Placement, world: str, source: SceneSource = scene
    ) -> None:
        self._plan, self._placement, self._world = plan, placement, world
        self._source = source
        self._beams = [FreeBeams(placement, k) for k in range(len(placement.poses))]

    def voxels(self, split: str, number: int) -> RegionVoxels:
        """Return the voxels of a scene."""
        content, points = self.points(split, number)
        region = self._plan.region
        return RegionVoxels(
            *region_objects(content, points.beams, region), *voxel_counts(points.positions, region)
        )

    def cloud(self, split: str, number: int) -> Cloud:
        """Return the points of a scene in the region."""
        content, points = self.points(split, number)
        chosen = chosen_points(points.positions, self._plan.region, number)
        objects = region_objects(content, points.beams, self._plan.region)
        return Cloud(*objects, chosen.astype(np.float32))

    def points(self, split: str, number: int) -> tuple[Scene, Points]:
        """Return a scene, and the points of all LiDARs in it."""
        content = self._source(self._plan, self._placement.vehicle, split, self._world, number)
        tree = TriangleTree(content.triangles)
        rule = self._plan.scenes
        positions, beams = [], np.zeros(len(content.labels), np.int64)
        for k, lidar in enumerate(self._beams):
            rng = np.random.default_rng([self._plan.seed, NOISE, SPLITS.index(split), number, k])
            distance, face = lidar.first_hits(tree, content.flat)
            met = np.flatnonzero(np.isfinite(distance))
            beams += beams_on_objects(content, face[met])
            noisy = distance[met] + rng.normal(0.0, rule.range_noise_m, len(met))
            kept = rng.uniform(size=len(met)) >= rule.dropped
            directions = lidar.directions[met[kept]]
            positions.append(lidar.origin + noisy[kept, None] * directions)
        return content, Points(np.concatenate(positions), beams)


def voxel_counts(
    positions: Floats, region: DetectionRegion
) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
    """Return flat indices (N,) of voxels with points (P, 3), ascending, and counts (N,)."""
    x = np.floor((positions[:, 0] + region.x_m) / region.cell_m).astype(np.int64)
    y = np.floor((positions[:, 1] + region.y_m) / region.cell_m).astype(np.int64)
    layer = np.searchsorted(LAYERS_M, positions[:, 2], side="right") - 1
    nx, ny = region.shape
    layers = len(LAYERS_M) - 1
    inside = (x >= 0) & (x < nx) & (y >= 0) & (y < ny) & (layer >= 0) & (layer < layers)
    flat = ((x * ny + y) * layers + layer)[inside]
    counts = np.bincount(flat, minlength=nx * ny * layers)
    cells = np.flatnonzero(counts)
    return cells.astype(np.int32), np.minimum(counts[cells], MAX_COUNT).astype(np.uint8)


def chosen_points(positions: Floats, region: DetectionRegion, seed: int) -> Floats:
    """Return at most `MAX_POINTS` points in the region, (N, 3), those above the ground first."""
    x, y, z = positions.T
    inside = (np.abs(x) < region.x_m) & (np.abs(y) < region.y_m)
    inside &= (z >= LAYERS_M[0]) & (z < LAYERS_M[-1])
    points = positions[inside]
    shuffled = points[np.random.default_rng([seed, NOISE]).permutation(len(points))]
    return shuffled[np.argsort(shuffled[:, 2] <= GROUND_M, kind="stable")][:MAX_POINTS]
