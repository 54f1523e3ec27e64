"""Scenes in motion: frames one after another, and their points in the frame of the last one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats

from ..batches import LAYERS
from ..casting import Caster, RegionVoxels, region_objects, voxel_counts
from ..placements import Placement, vehicle
from ..plan import SPLITS, StudyPlan
from ..scenes import Scene, Things, assembled, standing
from .plan import FramesPlan

MOTION = 11
"""Makes the seed of the motion another one than that of the scene."""


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

    def __init__(self, plan: FramesPlan) -> None:
        self._plan, rule = plan, plan.motion
        self.times = [(k + 1 - rule.count) / rule.rate_hz for k in range(rule.count)]
        self.moving = lru_cache(maxsize=1)(self._moving)

    def __call__(
        self, study: StudyPlan, vehicle_name: str, split: str, world: str, number: int
    ) -> Scene:
        """Return a frame by its number; study and world do not matter."""
        scene, k = divmod(number, len(self.times))
        return self.moving(vehicle_name, split, scene).at(self.times[k])

    def _moving(self, vehicle_name: str, split: str, number: int) -> MovingScene:
        """Return a scene by its number, without what would meet the vehicle in some frame."""
        study, rule = self._plan.study, self._plan.motion
        seed = [study.seed, study.vehicles.index(vehicle_name), SPLITS.index(split), number]
        rng = np.random.default_rng(seed)
        objects, distractors = standing(study, vehicle_name, split, number, rng)
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
        what = objects.subset(free), distractors.subset(kept)
        return MovingScene(*what, velocities[free], own_speed)

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

    def __init__(self, plan: FramesPlan, placement: Placement) -> None:
        self._plan, self._scenes = plan, MovingScenes(plan)
        self._vehicle = placement.vehicle
        self._caster = Caster(plan.study, placement, "", self._scenes)

    def voxels(self, split: str, number: int) -> tuple[RegionVoxels, RegionVoxels]:
        """Return the voxels of a scene's last frame, and those of all its frames.

        The latter have two channels for each layer: counts of the last frame, and of all earlier
        ones. Both are in the vehicle's frame of the last one: own motion is known exactly.
        """
        region, times = self._plan.study.region, self._scenes.times
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
