"""What a kind of sensor is: one row of the table of kinds.

A kind has to say its definition of m, and how its sensors are written and told. Its kernels are a
matter of speed: without any, every voxel is measured by the definition.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from ..errors import InputError
from ..metric.entropy import ApCurve
from ..scene.geometry import dot
from ..scene.objects import Objects
from ..scene.sensors import Sensor, SensorModel
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from .defined import DefinedGrid, DefinedSample
from .ego_mask import EgoMask
from .ground_kernel import DefinedGround, GroundKernel, GroundView
from .kernels import Floats, GridKernel, SampleKernel, Voxels
from .object_kernel import DefinedObjects, ObjectKernel, ObjectView
from .view_patch import ViewPatch

OUT_OF_VIEW, OUT_OF_RANGE, BETWEEN_BEAMS = "out of view", "out of range", "between beams"
"""Why a sensor misses a place that nothing hides."""


class Kind(ABC):
    """A kind of sensor.

    Attributes
    ----------
    name : str
        As studies, the catalogue and ``[ap.NAME]`` have it.
    label, plural : str
        What people call one of them, and several.
    unit : str
        What a measurement counts.
    model : type
        Class of its intrinsics; its `kind` is the name.
    curve : ApCurve
        Eq. 4 of its detector, unless a study has another.
    keys : frozenset of str
        Keys of a sensor's table, but for those that every kind has.
    object_curves : mapping of str to ApCurve
        Eq. 4 of whole objects by class, m counted on the object, unless a study has another; a
        class that is not in it cannot be found.
    counts_points : bool
        Whether what it counts on an object are points on it.
    has_top : bool
        Whether it matters which side of a sensor is up, as it does for a picture.
    loss : str
        What the vehicle does to it: "12 % of its *beams stopped*".
    """

    name: str
    label: str
    plural: str
    unit: str
    model: type[SensorModel]
    curve: ApCurve
    keys: frozenset[str]
    object_curves: Mapping[str, ApCurve] = MappingProxyType({})
    counts_points: bool = False
    has_top: bool = False
    loss: str = "beams stopped"

    @abstractmethod
    def measure(
        self, sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None
    ) -> Floats:
        """m of cubes with centres (V, 3) [m] and that side [m], as it is defined: (V,)."""

    def measure_objects(
        self, sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
    ) -> Floats:
        """m of objects, as it is defined: (N,); with `traffic` those of a scene hide each other.

        Raises
        ------
        InputError
            When the kind measures voxels alone, as it does by default.
        """
        expected = "a kind of sensor that measures objects"
        raise InputError(sensor.name, "kind", expected, repr(self.name))

    @abstractmethod
    def read(self, name: str, table: Mapping[str, Any], folder: Path) -> SensorModel:
        """Build a sensor's intrinsics from its table; files it names are relative to `folder`."""

    @abstractmethod
    def write(self, model: Any) -> dict[str, Any]:
        """Return the table that `read` turns into this sensor again, without its kind."""

    @abstractmethod
    def words(self, model: Any) -> list[str]:
        """Figures of a sensor for people, a line each."""

    def brief(self, model: Any) -> str:
        """Figures of a sensor in a few words, for lists; the first of `words` by default."""
        return next((" ".join(line.split()) for line in self.words(model)), "")

    def plot(self, model: Any) -> list[str]:
        """Lines of a small picture of a sensor in text; none by default."""
        return []

    def rays(self, sensor: Sensor, most: int) -> Floats:
        """Return a fair sample of where a sensor looks: at most so many (R, 3) unit directions.

        Ground frame. None by default: it is then not told what the vehicle stops.
        """
        return np.empty((0, 3))

    def rays_to(self, sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats]:
        """Return the rays of a sensor that decide whether something hides a cube from it.

        Directions (R, 3), ground frame, and how far (R,) each has to come [m]. By default the one
        to the cube's centre.
        """
        offset = center - np.asarray(sensor.pose.position)
        distance = float(np.sqrt(dot(offset, offset)))
        return offset[None] / (distance or 1.0), np.array([distance])

    def missed(self, sensor: Sensor, center: Floats, side: float) -> str:
        """Say why a sensor that nothing is in the way of does not measure a cube (3,) [m]."""
        return OUT_OF_VIEW

    def view(self, model: Any, step: float) -> ViewPatch | None:
        """Return where a sensor looks, in triangles of about `step` [rad]; none by default."""
        return None

    def ego_mask(self, sensor: Sensor, vehicle: Vehicle | None) -> EgoMask | None:
        """Return what of the sensor's own picture its vehicle takes; None by default: not told."""
        return None

    def on_grid(self, space: PerceptionSpace, vehicle: Vehicle | None, enough: int) -> GridKernel:
        """Return what measures sensors on all voxels of a space.

        `enough` is the whole number from which on m is saturated: more changes nothing.
        """
        return DefinedGrid(self.measure, space, vehicle)

    def on_sample(self, voxels: Voxels, vehicle: Vehicle | None, enough: int) -> SampleKernel:
        """Return what measures sensors on some voxels; `enough` as on the grid."""
        return DefinedSample(self.measure, voxels, vehicle)

    def on_ground(self, view: GroundView) -> GroundKernel:
        """Return what tells which ground a sensor sees of what stands there."""
        return DefinedGround(self.measure, view)

    def on_objects(self, view: ObjectView) -> ObjectKernel:
        """Return what measures sensors on some objects."""
        return DefinedObjects(self.measure_objects, view)
