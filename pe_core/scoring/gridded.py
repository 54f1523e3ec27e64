"""Scoring on every voxel of the grid."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import reduce
from operator import add
from threading import Lock
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from ..kinds.camera.grid import CameraPlanes
from ..kinds.camera.model import Camera
from ..kinds.lidar.beams import BeamField, beam_field
from ..kinds.lidar.grid import BeamGrid
from ..metric.entropy import H_BLIND
from ..metric.fusion import Fusion
from ..metric.planes import Group, PlaneFusion
from ..prior.prior import ClassDensity
from ..scene.sensors import Rig, Sensor
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from .score import GroundMap, PartScore, Score, SensorScore, rounded
from .subsets import Names, fused_early, parts_of
from .weights import outside_masses
from .zones import column_zones

Floats = NDArray[np.float64]
MeasuredPlanes = Callable[[slice], Group]
"""What sensors measure, with their kind, on a run of x-planes."""

BLOCK_PLANES = 32
"""x-planes a thread takes at a time; the exact areas of a camera are worked out together."""
PRODUCT_AT_ONCE = 1 << 18
"""Multiplications BLAS is given at a time: for more it wakes threads, which are ours already."""


class Sums(NamedTuple):
    """Entropy and coverage weighed by the prior, by class: each (C,)."""

    entropy: Floats
    coverage: Floats


class GridScorer:
    """Scores rigs on all voxels, in runs of x-planes; `workers` threads share them."""

    def __init__(
        self,
        space: PerceptionSpace,
        densities: list[ClassDensity],
        vehicle: Vehicle | None,
        fusion: Fusion,
        workers: int | None,
    ) -> None:
        self._space, self._vehicle, self._fusion = space, vehicle, fusion
        self._planes = PlaneFusion(fusion, space.shape[1:])
        self._workers = workers or os.cpu_count() or 1
        self._names = [d.name for d in densities]
        self._grounds = np.stack([d.ground for d in densities], axis=-1)  # (nx, ny, C)
        self._profiles = np.stack([d.profile for d in densities], axis=-1)  # (nz, C)
        self._tops = None if vehicle is None else vehicle.top(space)
        self._reached = np.isfinite(-np.inf if self._tops is None else self._tops.max(axis=1))
        self._masses = np.array(outside_masses(densities, space, self._tops))
        self._grid = BeamGrid(space)  # kept: a new one is slow to touch for the first time
        self._grid_is_free = Lock()

    def entropy(self, rig: Rig) -> float:
        """Perception entropy alone."""
        with self._grid_is_free, ThreadPoolExecutor(self._workers) as pool:
            ready = self._ready(rig, pool)
            groups = self._measured(list(rig.groups.values()), ready, pool)

            def work(planes: slice) -> Floats:
                fused = [[measure(planes) for measure in groups]]
                each = self._weighed(fused, planes, coverage=False)
                return np.sum([plane[0, 0].sum(axis=0) for plane in each], axis=0)

            return self._mean(np.sum(list(pool.map(work, self._blocks())), axis=0))

    def score(self, rig: Rig) -> Score:
        """Everything a grid score tells."""
        parts = parts_of(rig)
        with self._grid_is_free, ThreadPoolExecutor(self._workers) as pool:
            ready = self._ready(rig, pool)
            measured = self._measured([[s] for s in rig], ready, pool)

            def work(planes: slice) -> tuple[Floats, Floats]:
                values = {s.name: own(planes)[1] for s, own in zip(rig, measured, strict=True)}
                fused = [fused_early(rig, values, members) for members in parts]
                return self._reduced(fused, planes)

            blocks = list(pool.map(work, self._blocks()))
        sums = np.sum([by_part for by_part, _ in blocks], axis=0)
        by_part = {members: Sums(*own) for members, own in zip(parts, sums, strict=True)}
        columns = np.concatenate([columns for _, columns in blocks], axis=1)
        whole = by_part[parts[0]]
        return Score(
            self._mean(whole.entropy),
            self._mean(whole.coverage),
            0.0,
            self._classes(whole),
            self._zones(columns),
            {s.name: self._sensor(s, rig, by_part, ready[s.name]) for s in rig},
            self._space.size,
            _ground_map(columns),
        )

    def _ready(self, rig: Rig, pool: Executor) -> dict[str, BeamField | CameraPlanes]:
        """Every LiDAR's beams, cast, and every camera, ready to measure; by name."""
        return dict(zip((s.name for s in rig), pool.map(self._ready_sensor, rig), strict=True))

    def _ready_sensor(self, sensor: Sensor) -> BeamField | CameraPlanes:
        if sensor.kind == "lidar":
            return beam_field(sensor, self._vehicle)
        seen = None
        if self._vehicle is not None:
            seen = self._vehicle.seen_from(sensor.pose.position, through_glass=True)
        return CameraPlanes(cast(Camera, sensor.model), sensor.pose, self._space, seen)

    def _measured(
        self,
        groups: Sequence[Sequence[Sensor]],
        ready: Mapping[str, BeamField | CameraPlanes],
        pool: Executor,
    ) -> list[MeasuredPlanes]:
        """Sum the sensors of each group, which are of one kind.

        LiDARs are counted on the whole grid now, cameras when their planes are asked for.
        """
        only = sum(g[0].kind == "lidar" for g in groups) == 1  # several are kept small
        found = []
        for sensors in groups:
            ours = [ready[s.name] for s in sensors]
            if sensors[0].kind == "lidar":
                self._grid.clear()
                for sensor, field in zip(sensors, ours, strict=True):
                    beams = cast(BeamField, field)
                    self._grid.add(sensor.pose.position, beams.directions, beams.ends)
                counts = self._grid.counts
                found.append(_counts_of(counts if only else self._kept_small(counts, pool)))
            else:
                found.append(_pixels_of([cast(CameraPlanes, camera) for camera in ours]))
        return found

    def _kept_small(self, counts: NDArray[np.uint16], pool: Executor) -> NDArray:
        """Copy beam counts, into one byte where that is enough."""
        kept = np.empty(counts.shape, self._fusion.compact(counts[:1]).dtype)

        def work(planes: slice) -> None:
            for i in range(planes.start, planes.stop):
                kept[i] = self._fusion.compact(counts[i])

        list(pool.map(work, self._blocks()))
        return kept

    def _blocks(self) -> list[slice]:
        """Runs of x-planes."""
        nx = self._space.shape[0]
        return [slice(i, min(i + BLOCK_PLANES, nx)) for i in range(0, nx, BLOCK_PLANES)]

    def _weighed(
        self, parts: Sequence[Sequence[Group]], planes: slice, *, coverage: bool
    ) -> Iterator[Floats]:
        """Entropy of parts of a rig, and coverage if asked for, weighed by the prior, by plane.

        Summed over height: (P, 1 or 2, ny, C).
        """
        for i, ground in enumerate(self._grounds[planes]):
            outside = self._outside(planes.start + i)
            found = np.empty((len(parts), 1 + coverage, *ground.shape))
            for groups, sums in zip(parts, found, strict=True):
                self._over_height(self._planes.entropies(groups, i), outside, sums[0])
                if coverage:
                    seen = self._planes.seen(groups, i).astype(float)
                    self._over_height(seen, outside, sums[1])
            found *= ground
            yield found

    def _reduced(self, parts: Sequence[Sequence[Group]], planes: slice) -> tuple[Floats, Floats]:
        """Sums by class of every part of the rig (P, 2, C); and of the whole rig by column.

        The columns (3, n, ny) are entropy and coverage weighed by the prior, and the prior itself.
        """
        by_class = np.zeros((len(parts), 2, len(self._names)))
        columns = np.empty((3, planes.stop - planes.start, self._grounds.shape[1]))
        for i, weighed in enumerate(self._weighed(parts, planes, coverage=True)):
            by_class += weighed.sum(axis=2)
            columns[:2, i] = weighed[0].sum(axis=-1)
            columns[2, i] = self._mass(planes.start + i).sum(axis=-1)
        return by_class, columns

    def _mass(self, plane: int) -> Floats:
        """(ny, C) the prior in the columns of a plane."""
        outside, ground = self._outside(plane), self._grounds[plane]
        return ground if outside is None else ground * (outside @ self._profiles)

    def _outside(self, plane: int) -> Floats | None:
        """(ny, nz) 1 outside the vehicle's volume, 0 inside; None where it does not reach."""
        if self._tops is None or not self._reached[plane]:
            return None
        return (self._space.centers(2) >= self._tops[plane][:, None]).astype(float)

    def _over_height(self, values: Floats, outside: Floats | None, out: Floats) -> None:
        """Sum (ny, nz) values over height outside the vehicle, by each class's profile: (ny, C)."""
        if outside is not None:
            values = values * outside
        rows = max(1, PRODUCT_AT_ONCE // self._profiles.size)
        for start in range(0, len(values), rows):
            some = slice(start, start + rows)
            np.matmul(values[some], self._profiles, out=out[some])

    def _mean(self, by_class: Floats) -> float:
        return rounded(by_class.sum() / self._masses.sum())

    def _classes(self, whole: Sums) -> dict[str, PartScore]:
        shares = self._masses / self._masses.sum()
        rows = zip(self._names, whole.entropy, whole.coverage, self._masses, shares, strict=True)
        return {
            name: PartScore(rounded(h / mass), rounded(c / mass), rounded(share))
            for name, h, c, mass, share in rows
            if mass > 0.0
        }

    def _zones(self, columns: Floats) -> dict[str, PartScore]:
        total = columns[2].sum()
        found = {}
        for name, mask in column_zones(self._space).items():
            h, c, mass = (float(values[mask].sum()) for values in columns)
            if mass > 0.0:
                found[name] = PartScore(rounded(h / mass), rounded(c / mass), rounded(mass / total))
        return found

    def _sensor(
        self,
        sensor: Sensor,
        rig: Rig,
        by_part: Mapping[Names, Sums],
        ready: BeamField | CameraPlanes,
    ) -> SensorScore:
        names = tuple(s.name for s in rig)
        whole, alone = by_part[names], by_part[(sensor.name,)]
        others = by_part.get(tuple(n for n in names if n != sensor.name))
        failed = H_BLIND if others is None else self._mean(others.entropy)
        lost = rounded(failed - self._mean(whole.entropy))
        counts = self._beam_counts(ready)
        return SensorScore(self._mean(alone.entropy), self._mean(alone.coverage), lost, *counts)

    def _beam_counts(self, ready: BeamField | CameraPlanes) -> tuple[int, int, dict[str, int]]:
        """Beams, how many the vehicle stops, and by which parts; zeros for a camera."""
        if isinstance(ready, CameraPlanes):
            return 0, 0, {}
        return ready.counts(tuple(self._vehicle.part_names) if self._vehicle else ())


def _ground_map(columns: Floats) -> GroundMap:
    entropy, coverage, mass = columns
    safe = np.where(mass > 0.0, mass, np.nan)
    return GroundMap(entropy / safe, coverage / safe, mass)


def _counts_of(counts: NDArray) -> MeasuredPlanes:
    return lambda planes: ("lidar", counts[planes])


def _pixels_of(cameras: Sequence[CameraPlanes]) -> MeasuredPlanes:
    return lambda planes: ("camera", reduce(add, (camera.areas(planes) for camera in cameras)))
