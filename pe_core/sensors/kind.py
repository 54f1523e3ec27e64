"""`Kind`, a kind of sensor as a row of functions, the registry of kinds, and m by definition.

A kind gives its measurement m, its intrinsics, and how these are read, written and described.
Fast kernels are optional: without them every voxel is measured by the definition. A kind also has
AP curves of whole objects, converted from its curve of voxels by the sizes of the classes.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.errors import InputError
from ..base.values import choice
from ..geometry.grids import PerceptionSpace
from ..geometry.poses import dot
from ..metric.entropy import ApCurve
from ..scene.objects import Objects
from ..scene.rig import Sensor, SensorModel
from ..scene.vehicle import Vehicle
from .boxes import BodyParts
from .field_of_view import FieldPicture, ViewPatch
from .kernels import (
    DefinedGrid,
    DefinedGround,
    DefinedObjects,
    DefinedSample,
    GridKernel,
    GroundKernel,
    GroundView,
    ObjectKernel,
    ObjectView,
    SampleKernel,
    Voxels,
)

BoxSize = tuple[float, float, float]
ClassCurves = Mapping[str, Mapping[str, ApCurve]]
"""By kind, then by class."""

PAPER_VOXEL_M = 0.1  # Side of the voxels of the paper's curves [m]
SIZES: dict[str, BoxSize] = {
    "car": (4.6, 1.9, 1.7),
    "pedestrian": (0.8, 0.7, 1.75),
    "cyclist": (1.76, 0.65, 1.74),
    "truck": (7.5, 2.55, 3.0),
    "cone": (0.4, 0.4, 0.9),
}
"""Length, width, height [m] of the classes: the means of the road prior."""
OUT_OF_VIEW = "out of view"
OUT_OF_RANGE = "out of range"
BETWEEN_BEAMS = "between beams"
"""Reasons why a sensor does not see a location although nothing occludes it."""


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


def _refuses(expected: str) -> Callable[..., NoReturn]:
    """Return a function of a sensor, and of whatever follows, that raises `InputError`."""

    def refuse(sensor: Sensor, *_: object) -> NoReturn:
        raise InputError(sensor.name, "kind", expected, repr(sensor.kind))

    return refuse


NO_OBJECTS = _refuses("a kind of sensor that measures objects")
NO_PARTS = _refuses("a kind whose rays end on bodies")


def ray_to_center(sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats]:
    """Return one ray, to the centre of a cube: its direction (1, 3) and its length (1,) [m]."""
    offset = center - np.asarray(sensor.pose.position)
    distance = float(np.sqrt(dot(offset, offset)))
    return offset[None] / (distance or 1.0), np.array([distance])


@dataclass(frozen=True, kw_only=True, eq=False)
class Kind:
    """A kind of sensor: its figures and its functions.

    `name`: Its name in studies, in the catalogue and in ``[ap.NAME]``.
    `label, plural`: Name of one such sensor and of several, for users.
    `unit`: Unit of m, in the plural.
    `model`: Class of its intrinsics; its `kind` is the name.
    `curve`: Eq. 4 of its detector, unless a study has another.
    `keys`: Keys of a sensor's table, without those that every kind has.
    `measure`: Of a sensor, centres (V, 3) [m] of cubes, their side [m] and the vehicle or None: m
        (V,) by definition.
    `read`: Of a name, a sensor's table, and the folder of files that it names: the intrinsics.
    `write`: Of intrinsics: the table that `read` turns into them again, without the kind.
    `data_sheet`: Of intrinsics: the figures for users, one line each.
    `summary`: The main figures in one line; by default the first of `data_sheet`.
    `plot`: Of intrinsics: the lines of a small text plot.
    `object_curves`: Eq. 4 of whole objects by class, m counted on the object, unless a study has
        another. A class without a curve cannot be scored.
    `measure_objects`: Of a sensor, objects, the vehicle and whether objects occlude each other: m
        (N,) of objects by definition.
    `measure_parts`: Of a sensor, `BodyParts` and the vehicle: m (N,) of the cells of bodies by
        definition. A point is counted in the cells that its ray meets in the band in which it
        surely ends.
    `counts_points`: Whether m of an object is a number of points on it.
    `point`: m that is one point to a requirement: below 1 where m is an expected number.
    `shows_parts`: Whether its rays end on bodies, so that it tells which part of one it sees:
        `measure_parts`.
    `lowest_m`: A body on the ground that is lower is not seen by it, to a requirement [m].
    `cautious`: Of intrinsics: as requirements take them, with what it knows of nearly all bodies,
        not of half of them.
    `in_weather`: Of intrinsics and a `Weather`: the intrinsics as they are under it.
    `stand_off_m`: From a surface to the origin of a sensor that is put on it, unless one says
        otherwise [m].
    `outward`: Of intrinsics: whether a sensor that is put on the vehicle looks away from its
        middle.
    `lowest_ray`: Of the others' intrinsics: how far below the horizon their lowest ray points while
        they stand upright [rad].
    `pixels_per_radian`: Of intrinsics: those in the middle of its picture; 0: it has none.
    `has_top`: Whether it matters which side of the sensor is up, as for a picture.
    `occlusion_text`: Text about its occlusion by the vehicle: "12 % of its *beams occluded*".
    `rays`: Of a sensor and a number: at most so many unit directions (R, 3), ground frame, evenly
        spread over the field of view. None: the share that the vehicle occludes is unknown.
    `rays_to`: Of a sensor, the centre (3,) and the side of a cube [m]: directions (R, 3), ground
        frame, and lengths (R,) [m] of the rays that decide whether it is occluded.
    `missed`: Of the same: why the sensor does not see the cube, which nothing occludes.
    `view`: Of intrinsics and a step [rad]: the field of view in triangles of about that size, or
        None.
    `field_picture`: Of a sensor and the vehicle: what it detects by range and azimuth, or None.
    `covers_met`: Of the same: loss [dB] and share of the field of each cover it measures through.
    `opaque`: Of the vehicle: what blocks the rays of such sensors, or None.
    `on_grid, on_sample`: Of a space or of `Voxels`, the vehicle, and the integer m from which AP is
        at its maximum: a kernel. By default it measures by definition, as do both others.
    `on_ground, on_objects`: Of a `GroundView` or an `ObjectView`: a kernel.
    """

    name: str
    label: str
    plural: str
    unit: str
    model: type[SensorModel]
    curve: ApCurve
    keys: frozenset[str]
    measure: Callable[[Sensor, Floats, float, Vehicle | None], Floats]
    read: Callable[[str, Mapping[str, Any], Path], SensorModel]
    write: Callable[[Any], dict[str, Any]]
    data_sheet: Callable[[Any], list[str]]
    summary: Callable[[Any], str] = None  # type: ignore[assignment]  # of the data sheet
    plot: Callable[[Any], list[str]] = lambda model: []
    object_curves: Mapping[str, ApCurve] = field(default_factory=dict)
    measure_objects: Callable[[Sensor, Objects, Vehicle | None, bool], Floats] = NO_OBJECTS
    measure_parts: Callable[[Sensor, BodyParts, Vehicle | None], Floats] = NO_PARTS
    counts_points: bool = False
    point: float = 1.0
    shows_parts: bool = False
    lowest_m: float = 0.0
    cautious: Callable[[Any], Any] = lambda model: model
    in_weather: Callable[[Any, Any], Any] = lambda model, weather: model
    stand_off_m: float = 0.05
    outward: Callable[[Any], bool] = lambda model: True
    lowest_ray: Callable[[Any], float] = lambda model: 0.0
    pixels_per_radian: Callable[[Any], float] = lambda model: 0.0
    has_top: bool = False
    occlusion_text: str = "beams occluded"
    rays: Callable[[Sensor, int], Floats] = lambda sensor, most: np.empty((0, 3))
    rays_to: Callable[[Sensor, Floats, float], tuple[Floats, Floats]] = ray_to_center
    missed: Callable[[Sensor, Floats, float], str] = lambda sensor, center, side: OUT_OF_VIEW
    view: Callable[[Any, float], ViewPatch | None] = lambda model, step: None
    field_picture: Callable[[Sensor, Vehicle | None], FieldPicture | None] = lambda *_: None
    covers_met: Callable[[Sensor, Vehicle], Mapping[str, tuple[float, float]]] = lambda *_: {}
    opaque: Callable[[Vehicle], Vehicle | None] = lambda vehicle: vehicle
    on_grid: Callable[[PerceptionSpace, Vehicle | None, int], GridKernel] = None  # type: ignore[assignment]
    on_sample: Callable[[Voxels, Vehicle | None, int], SampleKernel] = None  # type: ignore[assignment]
    on_ground: Callable[[GroundView], GroundKernel] = None  # type: ignore[assignment]
    on_objects: Callable[[ObjectView], ObjectKernel] = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        defaults: dict[str, Callable[..., Any]] = {
            "summary": lambda model: " ".join(next(iter(self.data_sheet(model)), "").split()),
            "on_grid": partial(DefinedGrid, self.measure),
            "on_sample": partial(DefinedSample, self.measure),
            "on_ground": partial(DefinedGround, self.measure),
            "on_objects": partial(DefinedObjects, self.measure_objects),
        }
        for key, function in defaults.items():
            if getattr(self, key) is None:
                object.__setattr__(self, key, function)


_kinds: dict[str, Kind] = {}
KINDS: Mapping[str, Kind] = MappingProxyType(_kinds)
"""The registry: all kinds by name, in the order of registration: LiDAR, camera, others."""


def register(kind: Kind) -> None:
    """Add a kind to the registry: its sensors can then be studied, scored, searched and shown.
    `InputError` when the name is taken, or the model class names another kind."""
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
    """Return the kind of a name; `source` and `field` are for the message. `InputError` when there
    is no such kind."""
    return _kinds[choice(source, field, name, _kinds)]


def kind_of(sensor: Sensor | SensorModel) -> Kind:
    """Return the kind of a sensor, or of its model. `InputError` when it is not registered."""
    return kind_named(getattr(sensor, "kind", None), sensor.name)


def measure(
    sensor: Sensor, centers: ArrayLike, side: float, vehicle: Vehicle | None = None
) -> Floats:
    """Return the measurement of each voxel by one sensor.

    LiDAR: the number of beams that pass through the cube. A beam has to enter the cube within the
    maximum range, and before the vehicle occludes it. A cube owns its lower faces: a beam exactly
    along a face belongs to the cube above it (`lidar.kind`).

    Camera: the area of the cube's image in pixels, clipped to the picture. It is 0 if a corner is
    behind the camera or in its plane, if the centre is out of range, or if the vehicle occludes
    the centre (`camera.kind`). Through a lens with distortion, the part inside the lens's
    field counts, also if a corner is behind the camera (`camera.kind`).

    `InputError` when the centres are not (V, 3) finite numbers.

    Parameters
    ----------
    centers : (V, 3) float
        Voxel centres, ground frame [m].
    side : float
        Side of the cubes [m].
    vehicle : Vehicle, optional
        Occludes the voxels behind it.

    Returns
    -------
    (V,) float
        Beams or pixels.
    """
    centers = np.asarray(centers, dtype=float)
    if centers.ndim != 2 or centers.shape[1] != 3 or not np.isfinite(centers).all():
        raise InputError("measure", "centers", "(V, 3) finite numbers", centers.shape)
    return kind_of(sensor).measure(sensor, centers, side, vehicle)


def measure_objects(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None = None, traffic: bool = False
) -> Floats:
    """Return the measurement of each object by one sensor.

    LiDAR: the number of beams whose first hit is the object, within the LiDAR's range. Camera: the
    area of the box's image in pixels, clipped to the picture, times the share of it that is not
    occluded (docs/metric.md).

    `InputError` when the kind of the sensor does not measure objects.

    Parameters
    ----------
    vehicle : Vehicle, optional
        Occludes the voxels behind it.
    traffic : bool
        Whether the objects of a scene occlude each other; otherwise each is measured alone.

    Returns
    -------
    (N,) float
        Beams or pixels.
    """
    return kind_of(sensor).measure_objects(sensor, objects, vehicle, traffic)
