"""The beams of a mounted LiDAR: rotated into the ground frame, cast against the vehicle, cached.

`beam_field` casts all beams at once. Kernels ask for less: `LazyEnds` casts the beams whose end
matters. `BeamCache` holds rotated beams and ends by the sensor's name until it turns or moves.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints
from ...base.notebook import ShortRepr
from ...geometry.poses import Pose
from ...geometry.raycast import Hits
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..field_of_view import count_by_part
from ..kernels import Occlusion
from .definition import beam_axes, beam_directions, without_zeros
from .lattice import lattice_of
from .model import lidar_of
from .occlusion import occlusion_candidates

Rpy = tuple[float, float, float]
FEW_BEAMS = 0.2
"""Up to this share of its beams a LiDAR has only those rotated that are asked for."""


@dataclass(frozen=True)
class BeamField(ShortRepr):
    """The beams of a mounted LiDAR, cast against a vehicle.

    `directions` (B, 3) are unit vectors in the ground frame; `ends` (B,) the distances at which the
    beams end, on the vehicle or at the maximum range [m].
    """

    directions: Floats
    ends: Floats
    _max_range: float
    _hits: Hits | None = None
    _vehicle: Vehicle | None = None

    @cached_property
    def occluded_by(self) -> NDArray[np.int64]:
        """(B,) index of the vehicle's part on which a beam ends within its range, -1 for none."""
        if self._hits is None or self._vehicle is None:
            return np.full(len(self.ends), -1)
        parts = np.asarray(self._vehicle.parts)[self._hits.face]
        return np.where(self._hits.distance < self._max_range, parts, -1)

    def occluded_count(self, part_names: Sequence[str]) -> dict[str, int]:
        """Return the number of beams that end on each part, the largest number first."""
        return count_by_part(self.occluded_by, part_names)

    def occlusion(self) -> Occlusion:
        """Count the beams, those that the vehicle occludes, and the latter by part."""
        by_part = {} if self._vehicle is None else self.occluded_count(self._vehicle.part_names)
        return Occlusion(len(self.ends), sum(by_part.values()), by_part)


def beam_field(sensor: Sensor, vehicle: Vehicle | None) -> BeamField:
    """Cast all beams of a LiDAR against a vehicle; None: every beam ends at its maximum range."""
    directions = beam_directions(sensor)
    max_range = lidar_of(sensor).max_range
    if vehicle is None:
        return BeamField(directions, np.full(len(directions), max_range), max_range)
    hits = vehicle.first_hit(sensor.pose.position, directions, sensor.model.sees_through_glass)
    ends = np.minimum(hits.distance, max_range)
    return BeamField(directions, ends, max_range, hits, _vehicle=vehicle)


@dataclass(frozen=True)
class RotatedBeams:
    """A LiDAR's beams at the orientation of `sensor`; valid for any position."""

    sensor: Sensor

    @property
    def directions(self) -> Floats:
        """(B, 3) unit directions, ground frame."""
        return np.stack(self._axes, axis=-1)

    @cached_property
    def _axes(self) -> list[Floats]:
        return beam_axes(self.sensor)

    @cached_property
    def _components(self) -> list[Floats]:
        return [without_zeros(w) for w in self._axes]

    def take(self, beams: Ints) -> Floats:
        """Return the unit directions (N, 3) of the beams with these indices (N,)."""
        if self._few(beams):
            return np.stack(beam_axes(self.sensor, beams), axis=-1)
        return np.stack([np.take(w, beams) for w in self._axes], axis=-1)

    def components(self, beams: Ints) -> list[Floats]:
        """Return the directions of beams (N,) as three arrays (N,), one an axis, without zeros.
        This is the form in which kernels divide by them (`definition.without_zeros`)."""
        if self._few(beams):
            return [without_zeros(w) for w in beam_axes(self.sensor, beams)]
        return [np.take(w, beams) for w in self._components]

    def _few(self, beams: Ints) -> bool:
        """Whether to rotate only these beams: fewer than take as long as to rotate all."""
        return len(beams) < FEW_BEAMS * lidar_of(self.sensor).beam_count


@dataclass(frozen=True)
class FixedEnds:
    """Ends (B,) of all beams [m], given beforehand."""

    ends: Floats

    @cached_property
    def max_range(self) -> float:
        """No beam ends farther away [m]."""
        return float(self.ends.max())

    @cached_property
    def occludable(self) -> Flags:
        """(B,) beams that end before the maximum range."""
        return self.ends < self.max_range

    @property
    def max_occlusion(self) -> float:
        """No `occludable` beam ends farther away [m]."""
        return float(self.ends.max(where=self.occludable, initial=0.0))

    def take(self, beams: Ints) -> Floats:
        """Return the ends (N,) of the beams with these indices (N,) [m]."""
        return self.ends[beams]


class LazyEnds:
    """Ends of a mounted LiDAR's beams; a beam is cast when its end is requested first. `beams` are
    those of the sensor, at its orientation; `max_range` is as of `FixedEnds`."""

    max_occlusion = np.inf  # not known before casting

    def __init__(self, sensor: Sensor, beams: RotatedBeams, vehicle: Vehicle) -> None:
        model = lidar_of(sensor)
        self._sensor = sensor
        self._beams = beams
        self._vehicle = vehicle
        self._mesh = vehicle.seen_from(sensor.pose.position, model.sees_through_glass)
        count = model.beam_count
        self._hits = Hits(np.full(count, np.inf), np.full(count, -1))
        self._uncast = np.ones(count, bool)
        self.max_range = model.max_range

    @cached_property
    def occludable(self) -> Flags:
        """(B,) beams that may end before the maximum range; no other beam does."""
        lattice = lattice_of(lidar_of(self._sensor))
        if lattice.slope_bounds is None:
            return np.ones(len(self._uncast), bool)
        axes = self._sensor.pose.ground_from_sensor
        flags = np.empty((len(lattice.channels), lattice.width), bool)
        flags[lattice.channels] = occlusion_candidates(self._mesh.seen, axes, lattice)
        return flags.reshape(-1)

    def take(self, beams: Ints) -> Floats:
        """Return the ends (N,) of the beams with these indices (N,) [m]; cast the new ones."""
        requested = np.zeros(len(self._uncast), bool)
        requested[beams] = True
        self._cast(np.flatnonzero(requested & self._uncast))
        return np.minimum(self._hits.distance[beams], self.max_range)

    def beam_field(self) -> BeamField:
        """Cast the remaining beams and return all."""
        self._cast(np.flatnonzero(self._uncast))
        ends = np.minimum(self._hits.distance, self.max_range)
        return BeamField(
            self._beams.directions, ends, self.max_range, self._hits, _vehicle=self._vehicle
        )

    def _cast(self, beams: Ints) -> None:
        hits = self._mesh.first_hit(self._beams.take(beams))
        self._hits.distance[beams] = hits.distance
        self._hits.face[beams] = hits.face
        self._uncast[beams] = False


BeamEnds = FixedEnds | LazyEnds


@dataclass(frozen=True, slots=True, weakref_slot=True)
class CastBeams:
    """The beams of a sensor at its orientation, and where they end."""

    sensor: Sensor
    rotated: RotatedBeams
    ends: BeamEnds


_all_cast: WeakValueDictionary[tuple[int, int, Pose], CastBeams] = WeakValueDictionary()
"""The beams of all caches by vehicle, model and pose, as long as a cache holds them: voxels and
requirements need many of the same ends. They hold vehicle and model, whose identities stay."""


class BeamCache:
    """Rotated and cast beams of the LiDARs on a vehicle; several kernels may share one cache.
    Ends are by the sensor's name, rotated beams by model and orientation, which sensors may share:
    those of the last rig."""

    def __init__(self, vehicle: Vehicle | None) -> None:
        self._vehicle = vehicle
        self._rotated: dict[tuple[int, Rpy], RotatedBeams] = {}
        self._cast: dict[str, CastBeams] = {}

    def rotated(self, sensor: Sensor) -> RotatedBeams:
        """Return a LiDAR's beams, cached for its model and orientation."""
        return self._rotated.setdefault(_orientation(sensor), RotatedBeams(sensor))

    def cast(self, sensor: Sensor) -> CastBeams:
        """Return where a LiDAR's beams end; the cached ends until the sensor moves."""
        cached = self._cast.get(sensor.name)
        if cached and sensor.measures_as(cached.sensor):
            return cached
        key = id(self._vehicle), id(sensor.model), sensor.pose
        cast = _all_cast.get(key) or self._made(sensor)
        _all_cast[key] = self._cast[sensor.name] = cast
        return cast

    def _made(self, sensor: Sensor) -> CastBeams:
        model = lidar_of(sensor)
        rotated = self.rotated(sensor)
        if self._vehicle is None:
            ends = FixedEnds(np.full(model.beam_count, model.max_range))
            return CastBeams(sensor, rotated, ends)
        return CastBeams(sensor, rotated, LazyEnds(sensor, rotated, self._vehicle))

    def keep_only(self, sensors: Collection[Sensor]) -> None:
        """Drop the entries of all other sensors."""
        names = {sensor.name for sensor in sensors}
        used = set(map(_orientation, sensors))
        self._rotated = {key: beams for key, beams in self._rotated.items() if key in used}
        self._cast = {name: beams for name, beams in self._cast.items() if name in names}


def _orientation(sensor: Sensor) -> tuple[int, Rpy]:
    """Return what rotated beams depend on; they hold the model, so its identity stays its own."""
    return id(sensor.model), sensor.pose.rpy
