"""The LiDAR's kernels for voxels, all of a space or a sample of them, and for visible ground.

`LidarGrid` casts all beams and sweeps them through the grid (`grid_sweep`). `LidarSample` looks
beams up by direction and casts only those whose end matters (`voxel_beams`, `beams`).

`LidarGround` marks squares of the ground that beams pass at a low height: a beam meets a post of
height h where it is between the ground and h. Seen from above that is
a straight segment, which ends earlier where the vehicle or the range ends the beam. The squares
that hold points of the segment are marked: both of its ends, and points between.
"""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints
from ...geometry.bins import blocks, count_up
from ...geometry.grids import GroundGrid, PerceptionSpace
from ...metric.fusion import MAX_TABLE, VisibleRows
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..kernels import (
    BLOCK_PLANES,
    GridKernel,
    GroundKernel,
    GroundView,
    Measured,
    Occlusion,
    Planes,
    SampleKernel,
    VisibleGround,
    Voxels,
    block_voxels,
)
from .beams import BeamCache, BeamField, CastBeams, LazyEnds, beam_field
from .definition import cube_crossing, position_in_voxels, with_returns
from .grid_sweep import BeamGrid
from .lattice import lattice_of
from .model import ALL, ROAD, lidar_of
from .voxel_beams import CUBE_RADIUS, PlacedLidar, VoxelPoints, count_pairs, count_voxel_beams

BEAM_BYTES = 100  # Memory of a cast beam, measured: its direction, its end and its hit
MIN_RANGE_BLOCK = 64
"""Voxels tested together; all beams may pass a voxel next to the sensor."""
SPACING_M = 0.05
MAX_SPACING_M = 0.15
"""Distance between the points of a segment; larger if there were more than MAX_POINTS points."""
MAX_POINTS = 2_000_000
POINT_BLOCK = 1 << 14  # Points that are computed together: they stay in the cache
DIRECTION_BINS = 1e11
"""Segments whose directions agree to one part in this many lie on one ray."""
MIN_LENGTH = 1e-9  # Replaces the horizontal length 0 of a vertical beam
MAX_LENGTH_M = 1e6  # No segment is longer


def compact(
    counts: NDArray[np.uint16], saturation_count: int, pool: Executor | None = None
) -> NDArray:
    """Copy counts, clipped into one byte if `saturation_count` fits: entropies stay the same."""
    fits_byte = saturation_count <= np.iinfo(np.uint8).max
    copy = np.empty(counts.shape, np.uint8 if fits_byte else counts.dtype)

    def clip(planes: slice) -> None:
        for i in range(planes.start, planes.stop):
            copy[i] = np.minimum(counts[i], saturation_count) if fits_byte else counts[i]

    list((pool.map if pool else map)(clip, blocks(len(counts), BLOCK_PLANES)))
    return copy


class LidarGrid(GridKernel):
    """Counts beams through all voxels of a space; from `saturation_count` on not exactly."""

    def __init__(
        self, space: PerceptionSpace, vehicle: Vehicle | None, saturation_count: int
    ) -> None:
        self._space = space
        self._vehicle = vehicle
        self._saturation_count = saturation_count

    @cached_property
    def _grid(self) -> BeamGrid:
        return BeamGrid(self._space)  # reused: the first writes to new memory are slow

    def prepare(self, sensor: Sensor) -> tuple[Sensor, BeamField]:
        """Cast the beams."""
        return sensor, beam_field(sensor, self._vehicle)

    def occlusion(self, prepared: tuple[Sensor, BeamField]) -> Occlusion:
        """Count the beams that the vehicle occludes."""
        return prepared[1].occlusion()

    def memory_bytes(
        self, groups: Sequence[Sequence[Sensor]], space: PerceptionSpace, workers: int
    ) -> int:
        """Return the memory needed, about: grid, kept counts, beams and threads [bytes]."""
        beams = sum(len(lidar_of(s).directions) for group in groups for s in group)
        kept = space.size * len(groups) if len(groups) > 1 else 0
        threads = workers * block_voxels(space) * len(groups)
        return 2 * space.size + kept + beams * BEAM_BYTES + threads

    def planes(
        self, groups: Sequence[Sequence[tuple[Sensor, BeamField]]], pool: Executor
    ) -> list[Planes]:
        """Count each group's beams on the whole grid at once; keep several groups compact."""
        if any(lidar_of(sensor).returns == ROAD for group in groups for sensor, _ in group):
            return super().planes([[self._counted(one) for one in g] for g in groups], pool)
        planes: list[Planes] = []
        for group in groups:
            self._grid.clear()
            for sensor, field in group:
                min_range = lidar_of(sensor).min_range
                self._grid.add(sensor.pose.position, field.directions, field.ends, min_range)
            counts: NDArray = self._grid.counts
            if len(groups) > 1:
                counts = compact(counts, self._saturation_count, pool)
            planes.append(counts.__getitem__)
        return planes

    def _counted(self, prepared: tuple[Sensor, BeamField]) -> tuple[Sensor, NDArray]:
        """Count one sensor's beams on the whole grid."""
        sensor, field = prepared
        self._grid.clear()
        min_range = lidar_of(sensor).min_range
        self._grid.add(sensor.pose.position, field.directions, field.ends, min_range)
        return sensor, self._grid.counts.copy()

    def rows(self, prepared: tuple[Sensor, NDArray], planes: slice) -> VisibleRows:
        """Return the expected points of a sensor whose beams are counted."""
        sensor, counts = prepared
        x, y, z = (self._space.centers(axis) for axis in range(3))
        centers = np.stack(np.meshgrid(x[planes], y, z, indexing="ij"), axis=-1)
        m = with_returns(sensor, counts[planes].astype(float), centers)
        return VisibleRows(slice(0, m.shape[1]), m)


class LidarSample(SampleKernel):
    """Counts beams through sampled voxels; from `saturation_count` on not exactly."""

    def __init__(self, voxels: Voxels, vehicle: Vehicle | None, saturation_count: int) -> None:
        self._space = voxels.space
        self._vehicle = vehicle
        self._centers = voxels.centers
        self._saturation_count = saturation_count
        self._points = VoxelPoints(voxels.index)
        self.cache = BeamCache(vehicle)

    def measure(self, sensor: Sensor) -> Measured:
        """Count a LiDAR's beams."""
        beams = self.cache.cast(sensor)
        lidar = self._placed(beams)
        most = self._saturation_count if lidar_of(sensor).returns == ALL else MAX_TABLE
        counts = count_voxel_beams(self._points, lidar, most)
        counts = recount_min_range(self._points, lidar, counts, lidar_of(sensor).min_range)
        m = with_returns(sensor, counts, self._centers)
        return Measured(sensor, m, beams.ends)

    def occlusion(self, measured: Measured) -> Occlusion:
        """Count the beams that the vehicle occludes; exactly, whatever `measured` is."""
        ends = measured.kernel_data
        is_lazy = isinstance(ends, LazyEnds)
        field = ends.beam_field() if is_lazy else beam_field(measured.sensor, self._vehicle)
        return field.occlusion()

    def _placed(self, beams: CastBeams) -> PlacedLidar:
        side = self._space.interval
        sensor = beams.sensor
        return PlacedLidar(
            lattice_of(lidar_of(sensor)),
            position_in_voxels(sensor.pose.position, self._space.origin, side),
            sensor.pose.ground_from_sensor,
            beams.rotated,
            ends=beams.ends,
            side=side,
        )


def recount_min_range(
    voxels: VoxelPoints, lidar: PlacedLidar, counts: NDArray[np.signedinteger], min_range: float
) -> NDArray[np.signedinteger]:
    """Count again the voxels within the minimum range, beam by beam. They are few, so the fast
    kernels ignore the minimum range, and this corrects their `counts` (V,). Beams that leave a
    voxel, or end, nearer than `min_range` [m] do not count."""
    if min_range <= 0.0:
        return counts
    min_distance = min_range / lidar.side
    offsets = voxels.offsets(lidar.position)
    near = np.flatnonzero((offsets * offsets).sum(axis=1) < (min_distance + CUBE_RADIUS) ** 2)
    counts = counts.copy()
    for start in range(0, len(near), MIN_RANGE_BLOCK):
        block = near[start : start + MIN_RANGE_BLOCK]
        centers = offsets[block]
        voxel, beam = lidar.candidates(centers)
        directions = np.stack(list(lidar.beams.components(beam)), axis=1)
        _, leave = cube_crossing(centers[voxel], directions)
        kept = np.flatnonzero(leave >= min_distance)
        at = np.flatnonzero(lidar.ends.occludable[beam[kept]])
        beyond = np.ones(len(kept), bool)  # nor end nearer
        beyond[at] = lidar.ends.take(beam[kept[at]]) / lidar.side >= min_distance
        kept = kept[beyond]
        counts[block] = count_pairs(centers, lidar, voxel[kept], beam[kept])
    return counts


class LidarGround(GroundKernel):
    """Marks the squares below the low parts of beams."""

    def __init__(self, view: GroundView) -> None:
        self._view = view
        self.cache = BeamCache(view.vehicle)

    def mark(self, sensor: Sensor) -> VisibleGround:
        """Mark the squares of beams between the ground and the posts' height."""
        beams = self.cache.cast(sensor)
        components = beams.rotated.components(np.arange(lidar_of(sensor).beam_count))
        first, last = self._low_parts(sensor, components)
        low = np.flatnonzero(first <= last)
        occludable = low[beams.ends.occludable[low]]
        last[occludable] = np.minimum(last[occludable], beams.ends.take(occludable))
        low = low[first[low] <= last[low]]
        x, y, first, last = merged(*(w[low] for w in (*components[:2], first, last)))
        segments = GroundSegments.of(
            self._view.grid, sensor.pose.position, (x, y), first, last=last
        )
        grid = self._view.grid
        marked = np.zeros(grid.shape, bool)
        flat = marked.reshape(-1)
        finest = SPACING_M / grid.step
        spacing = np.clip(segments.length / MAX_POINTS, finest, MAX_SPACING_M / grid.step)
        pieces = segments.divided(float(spacing))
        if self._view.ring is not None:
            pieces = pieces.within(grid, self._view.ring)
        for squares in pieces.squares(grid.shape):
            flat[squares] = True
        flat[segments.ends(grid.shape)] = True
        return VisibleGround(sensor, marked)

    def _low_parts(self, sensor: Sensor, components: list[Floats]) -> tuple[Floats, Floats]:
        """Distances (B,) between which beams are low enough, above the grid and in range [m]."""
        lidar = lidar_of(sensor)
        grid = self._view.grid
        first = np.full(lidar.beam_count, lidar.min_range)
        last = np.full(lidar.beam_count, lidar.max_range)
        low = (*grid.origin, 0.0)
        high = (*grid.end, self._view.height)
        axes = zip(components, sensor.pose.position, low, high, strict=True)
        for component, origin, a, b in axes:
            t0 = (a - origin) / component
            t1 = (b - origin) / component
            np.maximum(first, np.minimum(t0, t1), out=first)
            np.minimum(last, np.maximum(t0, t1), out=last)
        return first, last


def merged(x: Floats, y: Floats, first: Floats, last: Floats) -> tuple[Floats, ...]:
    """Merge overlapping segments on one ray: channels of one azimuth of an upright LiDAR. Segments
    (L,) lie from `first` to `last` times a direction (x, y) from the sensor. Returns fewer such
    segments, along unit vectors."""
    length = np.maximum(np.sqrt(x * x + y * y), MIN_LENGTH)
    x = x / length
    y = y / length
    first = first * length
    last = last * length
    turned = y / (np.abs(x) + np.abs(y))  # rises with the azimuth where x > 0
    direction = np.round(np.where(x < 0.0, 2.0 - turned, turned) * DIRECTION_BINS)
    order = np.lexsort((first, direction))
    x, y, first, last, direction = (w[order] for w in (x, y, first, last, direction))
    # Each ray is moved beyond the last one, so that one running maximum serves all.
    shift = np.cumsum(np.diff(direction, prepend=direction[:1]) != 0.0) * MAX_LENGTH_M
    farthest = np.maximum.accumulate(last + shift)
    begins = np.ones(len(x), bool)
    begins[1:] = first[1:] + shift[1:] > farthest[:-1]
    begins = np.flatnonzero(begins)
    if not len(begins):
        return x, y, first, last
    return x[begins], y[begins], first[begins], np.maximum.reduceat(last, begins)


@dataclass(frozen=True, slots=True)
class GroundSegments:
    """Segments seen from above, (L,) each: start `x`, `y` and extent `dx`, `dy`. In squares of a
    grid, from its lowest corner."""

    x: Floats
    y: Floats
    dx: Floats
    dy: Floats

    @classmethod
    def of(
        cls,
        grid: GroundGrid,
        position: tuple[float, float, float],
        directions: tuple[Floats, Floats],
        first: Floats,
        last: Floats,
    ) -> "GroundSegments":
        """Return the segments from `first` to `last` (L,) [m] along directions from a position."""
        start = []
        extent = []
        for origin, low, direction in zip(position, grid.origin, directions, strict=False):
            start.append((origin - low + direction * first) / grid.step)
            extent.append(direction * (last - first) / grid.step)
        return cls(*start, *extent)

    @property
    def length(self) -> float:
        """Sum of the segments' lengths, in squares."""
        return float(np.sqrt(self.dx * self.dx + self.dy * self.dy).sum())

    def divided(self, spacing: float) -> "GroundPieces":
        """Divide each segment into equal pieces, at most `spacing` squares long."""
        count = np.ceil(np.sqrt(self.dx * self.dx + self.dy * self.dy) / spacing).astype(np.int64)
        count = np.maximum(count, 1)
        pieces = GroundSegments(self.x, self.y, self.dx / count, self.dy / count)
        return GroundPieces(pieces, np.zeros_like(count), count)

    def ends(self, shape: tuple[int, int]) -> Ints:
        """Return the flat index (L,) of the square that each segment ends in."""
        return flat_squares(self.x + self.dx, self.y + self.dy, shape)


@dataclass(frozen=True, slots=True)
class GroundPieces:
    """Equal pieces of segments: the `first` piece of each (L,), and those from `begin` to before
    `end` (L,), numbered from the segment's start."""

    first: GroundSegments
    begin: Ints
    end: Ints

    def within(self, grid: GroundGrid, ring: tuple[float, float]) -> "GroundPieces":
        """Return the pieces that may begin in a ring about the origin: inner and outer radius [m].
        Of a segment that crosses the ring's hole, those over the hole are among them."""
        inner, outer = (radius / grid.step for radius in ring)
        x = self.first.x + grid.origin[0] / grid.step
        y = self.first.y + grid.origin[1] / grid.step
        dx = self.first.dx
        dy = self.first.dy
        length2 = np.maximum(dx * dx + dy * dy, MIN_LENGTH)
        middle = -(x * dx + y * dy) / length2  # the piece nearest to the origin
        away2 = (x * dy - y * dx) ** 2 / length2
        begin = self.begin
        end = self.end
        to_rim = np.sqrt(np.maximum(outer * outer - away2, 0.0) / length2)
        begin = np.maximum(begin, np.floor(middle - to_rim).astype(np.int64) - 1)
        end = np.minimum(end, np.ceil(middle + to_rim).astype(np.int64) + 2)
        to_hole = np.sqrt(np.maximum(inner * inner - away2, 0.0) / length2)
        in_hole = (np.ceil(middle - to_hole) + 1.0, np.floor(middle + to_hole) - 1.0)
        starts_in = (in_hole[0] <= begin) & (in_hole[1] > begin)
        begin = np.where(starts_in, in_hole[1], begin).astype(np.int64)
        ends_in = (in_hole[1] >= end - 1) & (in_hole[0] < end)
        end = np.where(ends_in, in_hole[0], end).astype(np.int64)
        return GroundPieces(self.first, begin, np.maximum(end, begin))

    def squares(self, shape: tuple[int, int]) -> Iterator[Ints]:
        """Yield the flat indices of the squares that pieces begin in, in blocks."""
        counts = self.end - self.begin
        total = np.cumsum(counts)
        starts = np.searchsorted(total, np.arange(0, total[-1] if len(total) else 0, POINT_BLOCK))
        for low, high in pairwise([*np.unique(starts).tolist(), len(counts)]):
            block = slice(low, high)
            each = counts[block]
            number = count_up(each) + np.repeat(self.begin[block], each)
            x, dx, y, dy = (
                np.repeat(w[block], each)
                for w in (self.first.x, self.first.dx, self.first.y, self.first.dy)
            )
            yield flat_squares(x + number * dx, y + number * dy, shape)


def flat_squares(x: Floats, y: Floats, shape: tuple[int, int]) -> Ints:
    """Return the flat index (N,) of the squares at points (N,), in squares from a grid's corner."""
    i = np.minimum(x.astype(np.int32), shape[0] - 1)
    j = np.minimum(y.astype(np.int32), shape[1] - 1)
    return np.asarray(i * shape[1] + j)
