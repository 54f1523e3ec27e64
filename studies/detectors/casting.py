"""Points of a rig in a scene or in frames: first hits, with noise; and their counts in voxels.

Beams are cast by the engine's own first hits. Which beams the vehicle's own body blocks does not
depend on the scene, so it is computed once for a placement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pe_core.base import Floats, Ints, Singles
from pe_core.geometry import rotate
from pe_core.geometry.ray_traversal import TriangleTree
from pe_core.geometry.raycast import VisibleTriangles
from pe_core.sensors.lidar import Lidar

from .placements import Placement, vehicle
from .plan import SPLITS, Plan, shape_of
from .scenes import NOBODY, Scene, Things, assembled, scene, standing

SceneSource = Callable[[Plan, str, str, str, int], Scene]
"""Returns a scene, as `scene` does, from plan, vehicle, split, world and number."""

LAYERS_M = (-0.4, 0.15, 0.35, 0.6, 0.9, 1.3, 1.8, 2.6, 4.2)
"""Edges of the voxels' layers [m]."""
LAYERS = len(LAYERS_M) - 1
MAX_COUNT = 255
MAX_POINTS = 12_288
"""Points of a scene that the detector *points* takes; of more, some are drawn at random."""
GROUND_M = 0.15
"""Points up to this height are taken last: most of them are of the ground."""
NOISE = 7
"""Makes the seed of the noise another one than that of the scene."""
MOTION = 11
"""Makes the seed of the motion another one than that of the scene."""


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

    centers: Singles
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
    layers: int = LAYERS


@dataclass(frozen=True, slots=True)
class Cloud(RegionObjects):
    """The input of the detector *points*: (N, 3), those above the ground first."""

    points: Singles


@dataclass(frozen=True, slots=True)
class RegionPictures(RegionObjects):
    """The input of the detector of cameras: pictures (S, W, H, 3). Beams are pixels."""

    pictures: NDArray[np.uint8]


def region_objects(
    content: Scene, beams: Ints, region: Plan
) -> tuple[Singles, NDArray[np.uint8], NDArray[np.int32]]:
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
    distance = hits.distance
    face = hits.face
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
        self.min_range = model.min_range
        self.max_range = model.max_range

    def first_hits(self, tree: TriangleTree, flat: bool) -> tuple[Floats, Ints]:
        """Return distance (B,) [m], inf for a miss, and triangle (B,), -1 for ground and misses."""
        distance, face = first_hits(tree, flat, self.origin, self.directions)
        in_range = (distance >= self.min_range) & (distance <= self.max_range)
        return np.where(in_range, distance, np.inf), np.where(in_range, face, NOBODY)


class Caster:
    """Casts the beams of a placement into scenes of a world, which `source` returns."""

    def __init__(
        self, plan: Plan, placement: Placement, world: str, source: SceneSource = scene
    ) -> None:
        self._plan = plan
        self._placement = placement
        self._world = world
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
        positions = []
        beams = np.zeros(len(content.labels), np.int64)
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


def voxel_counts(positions: Floats, region: Plan) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
    """Return flat indices (N,) of voxels with points (P, 3), ascending, and counts (N,)."""
    x = np.floor((positions[:, 0] + region.x_m) / region.cell_m).astype(np.int64)
    y = np.floor((positions[:, 1] + region.y_m) / region.cell_m).astype(np.int64)
    layer = np.searchsorted(LAYERS_M, positions[:, 2], side="right") - 1
    nx, ny = shape_of(region)
    inside = (x >= 0) & (x < nx) & (y >= 0) & (y < ny) & (layer >= 0) & (layer < LAYERS)
    flat = ((x * ny + y) * LAYERS + layer)[inside]
    counts = np.bincount(flat, minlength=nx * ny * LAYERS)
    cells = np.flatnonzero(counts)
    return cells.astype(np.int32), np.minimum(counts[cells], MAX_COUNT).astype(np.uint8)


def chosen_points(positions: Floats, region: Plan, seed: int) -> Floats:
    """Return at most `MAX_POINTS` points in the region, (N, 3), those above the ground first."""
    x, y, z = positions.T
    inside = (np.abs(x) < region.x_m) & (np.abs(y) < region.y_m)
    inside &= (z >= LAYERS_M[0]) & (z < LAYERS_M[-1])
    points = positions[inside]
    shuffled = points[np.random.default_rng([seed, NOISE]).permutation(len(points))]
    return shuffled[np.argsort(shuffled[:, 2] <= GROUND_M, kind="stable")][:MAX_POINTS]


@dataclass(frozen=True, slots=True)
class MovingScene:
    """A scene at its last frame, the velocities of its objects (N, 2), and the own speed [m/s]."""

    objects: Things
    distractors: Things
    velocities: Floats
    own_speed: float

    def at(self, time: float) -> Scene:
        """Return the scene at a time before the last frame [s], in the vehicle's frame then."""
        own = np.array([self.own_speed * time, 0.0])
        objects = _moved(self.objects, self.velocities * time - own)
        return assembled(objects, _moved(self.distractors, -own), None, [])


class MovingScenes:
    """The frames of moving scenes; calling it returns a frame, as `scenes.scene` does.

    Frame k of scene n has the number ``n * count + k``: so its noise is its own.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        rule = plan.frames.motion
        self.times = [(k + 1 - rule.count) / rule.rate_hz for k in range(rule.count)]
        self.moving = lru_cache(maxsize=1)(self._moving)

    def __call__(
        self, study: Plan, vehicle_name: str, split: str, world: str, number: int
    ) -> Scene:
        """Return a frame by its number; study and world do not matter."""
        scene, k = divmod(number, len(self.times))
        return self.moving(vehicle_name, split, scene).at(self.times[k])

    def _moving(self, vehicle_name: str, split: str, number: int) -> MovingScene:
        """Return a scene by its number, without what would meet the vehicle in some frame."""
        study = self._plan
        rule = self._plan.frames.motion
        seed = [study.seed, study.vehicles.index(vehicle_name), SPLITS.index(split), number]
        rng = np.random.default_rng(seed)
        objects, distractors = standing(study, vehicle_name, split, number, rng=rng)
        rng = np.random.default_rng([*seed, MOTION])
        own_speed = float(rng.uniform(*rule.own_speed))
        speeds = np.array([rule.speeds[name] for name in objects.names])
        speeds *= np.clip(rng.normal(1.0, rule.speed_spread, len(speeds)), 0.0, 2.0)
        shares = np.array([rule.moving[name] for name in objects.names])
        speeds *= rng.uniform(size=len(speeds)) < shares
        speeds *= np.where((objects.yaws == 0.0) & (objects.feet[:, 1] > rule.oncoming_y_m), -1, 1)
        along = np.stack([np.cos(objects.yaws), np.sin(objects.yaws)], axis=1)
        velocities = speeds[:, None] * along
        own = np.array([own_speed, 0.0])
        free = self._free(vehicle_name, objects, velocities - own)
        still = np.zeros((len(distractors.names), 2))
        kept = self._free(vehicle_name, distractors, still - own)
        return MovingScene(
            objects.subset(free), distractors.subset(kept), velocities[free], own_speed
        )

    def _free(self, vehicle_name: str, things: Things, relative: Floats) -> list[int]:
        """Return the things whose circle never meets the vehicle's rectangle."""
        low, high = (corner[:2] for corner in vehicle(vehicle_name).bounds)
        free = np.ones(len(things.names), bool)
        for time in self.times:
            at = things.feet[:, :2] + relative * time
            away = np.maximum(np.abs(at - (low + high) / 2.0) - (high - low) / 2.0, 0.0)
            free &= np.hypot(*away.T) > things.radii
        return [int(k) for k in np.flatnonzero(free)]


class FramesCaster:
    """Casts the beams of a placement into the frames of moving scenes."""

    def __init__(self, plan: Plan, placement: Placement) -> None:
        self._plan = plan
        self._scenes = MovingScenes(plan)
        self._vehicle = placement.vehicle
        self._caster = Caster(plan, placement, "", self._scenes)

    def voxels(self, split: str, number: int) -> tuple[RegionVoxels, RegionVoxels]:
        """Return the voxels of a scene's last frame, and those of all its frames.

        The latter have two channels for each layer: counts of the last frame, and of all earlier
        ones. Both are in the vehicle's frame of the last one: own motion is known exactly.
        """
        region = self._plan.region
        times = self._scenes.times
        frames = [self._caster.points(split, number * len(times) + k) for k in range(len(times))]
        content, last = frames[-1]
        speed = self._scenes.moving(self._vehicle, split, number).own_speed
        past = zip(frames[:-1], times[:-1], strict=True)
        shifted = [points.positions + np.array([speed * t, 0.0, 0.0]) for (_, points), t in past]
        earlier = np.concatenate(shifted)
        now, before = (voxel_counts(p, region) for p in (last.positions, earlier))
        beams = np.sum([points.beams for _, points in frames], axis=0)
        one = RegionVoxels(*region_objects(content, last.beams, region), *now)
        both = [_channels(cells, k) for k, (cells, _) in enumerate((now, before))]
        counts = np.concatenate([now[1], before[1]])
        objects = region_objects(content, beams, region)
        return one, RegionVoxels(*objects, np.concatenate(both), counts, 2 * LAYERS)


def _channels(cells: NDArray[np.int32], channel: int) -> NDArray[np.int32]:
    """Return flat indices of voxels as those of one of two channels."""
    place, layer = np.divmod(cells, LAYERS)
    return (place * (2 * LAYERS) + channel * LAYERS + layer).astype(np.int32)


def _moved(things: Things, by: Floats) -> Things:
    feet = things.feet.copy()
    feet[:, :2] += by
    return replace(things, feet=feet)
