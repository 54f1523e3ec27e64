"""`Kind`, the interface of a kind of sensor, and the registry of kinds.

A kind defines its measurement m, its intrinsics, and how these are read, written and described.
Fast kernels are optional: without them every voxel is measured by the definition. A kind also has
AP curves of whole objects, converted from its curve of voxels by the sizes of the classes.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.errors import InputError, shown
from ..geometry.grids import PerceptionSpace
from ..geometry.poses import dot
from ..metric.entropy import ApCurve
from ..scene.objects import Objects
from ..scene.rig import Sensor, SensorModel
from ..scene.vehicle import Vehicle
from .body_parts import BodyParts
from .field_of_view import EgoMask, ViewPatch
from .ground_kernel import DefinedGround, GroundKernel, GroundView
from .kernels import DefinedGrid, DefinedSample, GridKernel, SampleKernel, Voxels
from .object_kernel import DefinedObjects, ObjectKernel, ObjectView
from .ray_fan_view import FieldPicture
from .weather import Weather

BoxSize = tuple[float, float, float]
ClassCurves = Mapping[str, Mapping[str, ApCurve]]
"""By kind, then by class."""

PAPER_VOXEL_M = 0.1
"""Side of the voxels of the paper's curves [m]."""
SIZES: dict[str, BoxSize] = {
    "car": (4.6, 1.9, 1.7),
    "pedestrian": (0.8, 0.7, 1.75),
    "cyclist": (1.76, 0.65, 1.74),
    "truck": (7.5, 2.55, 3.0),
    "cone": (0.4, 0.4, 0.9),
}
"""Length, width, height [m] of the classes: the means of the road prior."""


def derived_object_curve(curve: ApCurve, size: BoxSize, side: float = PAPER_VOXEL_M) -> ApCurve:
    """Return the AP curve of a whole object from that of its voxels.

    The mean silhouette, over all horizontal directions, of a box of length l, width w and height h
    is 2 (l + w) h / pi, that of a cube of side s is 4 s^2 / pi. An object gets their ratio k times
    the beams or pixels of a voxel at its position: AP = a ln(m / k) + b, k = (l + w) h / (2 s^2).
    """
    length, width, height = size
    times = (length + width) * height / (2.0 * side * side)
    return ApCurve(curve.a, curve.b - curve.a * math.log(times))


def derived_object_curves(curve: ApCurve) -> dict[str, ApCurve]:
    """Return the AP curves of the classes of the road, from that of voxels."""
    return {name: derived_object_curve(curve, size) for name, size in SIZES.items()}


OUT_OF_VIEW, OUT_OF_RANGE, BETWEEN_BEAMS = "out of view", "out of range", "between beams"
"""Reasons why a sensor does not see a location although nothing occludes it."""


class Kind(ABC):
    """A kind of sensor.

    Attributes
    ----------
    name : str
        Its name in studies, in the catalogue and in ``[ap.NAME]``.
    label, plural : str
        Name of one such sensor and of several, for users.
    unit : str
        Unit of m, in the plural.
    model : type
        Class of its intrinsics; its `kind` is the name.
    curve : ApCurve
        Eq. 4 of its detector, unless a study has another.
    keys : frozenset of str
        Keys of a sensor's table, without those that every kind has.
    object_curves : mapping of str to ApCurve
        Eq. 4 of whole objects by class, m counted on the object, unless a study has another. A
        class without a curve cannot be scored.
    counts_points : bool
        Whether m of an object is a number of points on it.
    point : float
        m that is one point to a requirement: below 1 where m is an expected number.
    shows_parts : bool
        Whether its rays end on bodies, so that it tells which part of one it sees: `measure_parts`.
    lowest_m : float
        A body on the ground that is lower is not seen by it, to a requirement [m].
    has_top : bool
        Whether it matters which side of the sensor is up, as for a picture.
    occlusion_text : str
        Text about its occlusion by the vehicle: "12 % of its *beams occluded*".
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
    point: float = 1.0
    shows_parts: bool = False
    lowest_m: float = 0.0
    has_top: bool = False
    occlusion_text: str = "beams occluded"
    weather_limits_range: bool = False
    """Whether weather changes `max_range` alone, beyond which m is 0."""

    @abstractmethod
    def measure(
        self, sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None
    ) -> Floats:
        """Return m (V,) of cubes with centres (V, 3) [m] and a side [m], by definition."""

    def measure_objects(
        self, sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
    ) -> Floats:
        """Return m (N,) of objects by definition; with `traffic` objects occlude each other.

        Raises
        ------
        InputError
            When the kind only measures voxels: the default.
        """
        expected = "a kind of sensor that measures objects"
        raise InputError(sensor.name, "kind", expected, repr(self.name))

    def measure_parts(self, sensor: Sensor, parts: BodyParts, vehicle: Vehicle | None) -> Floats:
        """Return m (N,) of the cells of bodies by definition.

        A point is counted in the cells that its ray meets in the band in which it surely ends.

        Raises
        ------
        InputError
            When no ray of the kind ends on bodies: the default.
        """
        raise InputError(sensor.name, "kind", "a kind whose rays end on bodies", repr(self.name))

    def cautious(self, model: Any) -> Any:
        """Return a sensor's intrinsics as requirements take them: the same object by default.

        What it knows of bodies is then what nearly all of them have, not what half of them have.
        """
        return model

    def image_widths(self, sensor: Sensor, objects: Objects) -> Floats:
        """Return the widths (N,) of objects' images [px]; `InputError` without pictures."""
        raise InputError(sensor.name, "kind", "a kind of sensor with pictures", repr(self.name))

    @abstractmethod
    def read(self, name: str, table: Mapping[str, Any], folder: Path) -> SensorModel:
        """Build a sensor's intrinsics from its table; files it names are relative to `folder`."""

    @abstractmethod
    def write(self, model: Any) -> dict[str, Any]:
        """Return the table that `read` turns into this sensor again, without its kind."""

    @abstractmethod
    def data_sheet(self, model: Any) -> list[str]:
        """Return the figures of a sensor for users, one line each."""

    def in_weather(self, model: Any, weather: Weather) -> Any:
        """Return a sensor's intrinsics as they are under a weather; unchanged by default."""
        return model

    def summary(self, model: Any) -> str:
        """Return the main figures of a sensor in one line; by default the first of `data_sheet`."""
        return next((" ".join(line.split()) for line in self.data_sheet(model)), "")

    def plot(self, model: Any) -> list[str]:
        """Return the lines of a small text plot of a sensor; none by default."""
        return []

    def rays(self, sensor: Sensor, max_rays: int) -> Floats:
        """Return at most `max_rays` unit directions (R, 3), evenly spread over the field of view.

        Ground frame. None by default: the share that the vehicle occludes is then unknown.
        """
        return np.empty((0, 3))

    def rays_to(self, sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats]:
        """Return the rays of a sensor that decide whether a cube is occluded.

        Directions (R, 3), ground frame, and lengths (R,) [m]. By default one ray to the centre.
        """
        offset = center - np.asarray(sensor.pose.position)
        distance = float(np.sqrt(dot(offset, offset)))
        return offset[None] / (distance or 1.0), np.array([distance])

    def missed(self, sensor: Sensor, center: Floats, side: float) -> str:
        """Say why a sensor does not see a cube, centre (3,) [m], that nothing occludes."""
        return OUT_OF_VIEW

    def view(self, model: Any, step: float) -> ViewPatch | None:
        """Return the field of view in triangles of about `step` [rad]; None by default."""
        return None

    def field_picture(self, sensor: Sensor, vehicle: Vehicle | None) -> FieldPicture | None:
        """Return what it detects by range and azimuth; None by default."""
        return None

    def covers_met(self, sensor: Sensor, vehicle: Vehicle) -> Mapping[str, tuple[float, float]]:
        """Return loss [dB] and share of the field of each cover it measures through; none here."""
        return {}

    def opaque(self, vehicle: Vehicle) -> Vehicle | None:
        """Return what blocks the rays of such sensors: all of the vehicle by default."""
        return vehicle

    def ego_mask(self, sensor: Sensor, vehicle: Vehicle | None) -> EgoMask | None:
        """Return which rays of the sensor end on its vehicle; None by default: unknown."""
        return None

    def on_grid(
        self, space: PerceptionSpace, vehicle: Vehicle | None, saturation_count: int
    ) -> GridKernel:
        """Return a kernel for all voxels of a space.

        `saturation_count` is the integer m from which AP is at its maximum.
        """
        return DefinedGrid(self.measure, space, vehicle)

    def on_sample(
        self, voxels: Voxels, vehicle: Vehicle | None, saturation_count: int
    ) -> SampleKernel:
        """Return a kernel for a sample of voxels."""
        return DefinedSample(self.measure, voxels, vehicle)

    def on_ground(self, view: GroundView) -> GroundKernel:
        """Return a kernel that marks squares of the ground."""
        return DefinedGround(self.measure, view)

    def on_objects(self, view: ObjectView) -> ObjectKernel:
        """Return a kernel for a set of objects."""
        return DefinedObjects(self.measure_objects, view)


_kinds: dict[str, Kind] = {}
KINDS: Mapping[str, Kind] = MappingProxyType(_kinds)
"""The registry: all kinds by name, in the order of registration: LiDAR, camera, others."""


def register(kind: Kind) -> None:
    """Add a kind to the registry: its sensors can then be studied, scored, searched and shown.

    Raises
    ------
    InputError
        When the name is taken, or the model class names another kind.
    """
    if kind.name in _kinds:
        raise InputError("kinds", "name", "a name used once", repr(kind.name))
    if getattr(kind.model, "kind", None) != kind.name:
        found = repr(getattr(kind.model, "kind", None))
        raise InputError(f"kind {kind.name!r}", "model.kind", repr(kind.name), found)
    _kinds[kind.name] = kind


def unregister(name: str) -> None:
    """Remove a kind from the registry, if there is one of that name."""
    _kinds.pop(name, None)


def kind_named(name: object, source: str, field: str = "kind") -> Kind:
    """Return the kind of a name; `source` and `field` are for the message.

    Raises
    ------
    InputError
        When there is no such kind.
    """
    kind = _kinds.get(name) if isinstance(name, str) else None
    if kind is None:
        raise InputError(source, field, f"one of {', '.join(_kinds)}", shown(name))
    return kind


def kind_of(sensor: Sensor | SensorModel) -> Kind:
    """Return the kind of a sensor, or of its model.

    Raises
    ------
    InputError
        When its kind is not registered.
    """
    return kind_named(getattr(sensor, "kind", None), sensor.name)
