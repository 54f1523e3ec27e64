"""How each kind of sensor goes through the exchange model: one table, a row a kind. A kind without
a row goes by its table in a study, in the formats that have room for it."""

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from pe_core import catalog
from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError
from pe_core.base.values import degrees_in_file
from pe_core.scene.rig import Rig, SensorModel
from pe_core.sensors import KINDS
from pe_core.sensors.camera import Camera
from pe_core.sensors.camera.lens import fold_angle
from pe_core.sensors.lidar import Lidar
from pe_core.sensors.lidar.model import FULL_CIRCLE
from pe_core.sensors.radar import Radar, RadarMode
from pe_core.sensors.ultrasonic import Ultrasonic

from .foreign_values import MAX_BEAMS
from .lens_pictures import ALIKE_PX, Picture, Size
from .portable import EVEN_RAD, Emitters, FieldOfView, PortableRig, PortableSensor, Scan

CAMERA = Camera.kind
LIDAR = Lidar.kind
RADAR = Radar.kind
ULTRASONIC = Ultrasonic.kind
NO_EXTENT_RAD = 1e-9  # A scan with a smaller horizontal field of view does not rotate [rad]
OFF_STEP = 0.01  # Of an azimuth step: what is nearer to a whole number of steps than this is one
OFF_CENTER = 0.06
"""Of a picture's side, how far from the middle the principal point of a usual size may be:
nuScenes' own cameras have it 0.046 below."""
RANGES = {"min_range": 0.0, "max_range": math.inf}
"""Ranges of a model, and the values that no file states [m]."""

RadarScan = tuple[str, float, float, float, Mapping[str, float]]
"""Name, range [m], half azimuth and half elevation [deg], and resolutions, of a radar's scan."""
RESOLUTIONS = {
    "rangeResM": "range_resolution",
    "boreAzResDeg": "azimuth_resolution",
    "boreElResDeg": "elevation_resolution",
}
"""Fields of a radar's mode by the name that NVIDIA's schema has for a resolution."""
OwnModel = tuple[SensorModel, str]
"""A model made of a file's figures, and a message on it (may be empty)."""


@dataclass(frozen=True, slots=True)
class PortableKind:
    """How the exchange model expresses the sensors of a kind. `figures` returns the fields of
    `PortableSensor` that describe a model. `model` returns the model of a sensor's figures, by the
    usual image size of the format; None without figures of the kind. `stand_in` is the catalogue
    name of the model that stands in where a file names none."""

    figures: Callable[[Any], Mapping[str, Any]]
    model: Callable[[PortableSensor, Size | None], OwnModel | None]
    stand_in: str | None = None


def portable_kind(name: str | None) -> PortableKind:
    """Return the row of a kind."""
    return PORTABLE_KINDS.get(name or "", OTHER)


def stand_in_of(kind: str) -> str | None:
    """Return the catalogue name of the model that stands in for an unknown one of a kind. It is the
    first of the catalogue where the kind has no row; None if there is none."""
    stand_in = portable_kind(kind).stand_in
    return stand_in or next(iter(catalog.names(kind)), None)


def has_model(sensor: PortableSensor) -> bool:
    """Whether a sensor's kind is known, and the file or the catalogue has a model for it."""
    kind = sensor.kind or ""
    return kind in KINDS and (sensor.has_figures or stand_in_of(kind) is not None)


def portable_sensors(rig: Rig) -> PortableRig:
    """Return the sensors of a rig, in the ground frame."""
    sensors = []
    for sensor in rig:
        figures = dict(portable_kind(sensor.kind).figures(sensor.model))
        for key, default in RANGES.items():
            if (value := getattr(sensor.model, key, default)) != default:
                figures[key] = value
        sensors.append(
            PortableSensor(
                sensor.name,
                sensor.pose,
                sensor.kind,
                sensor.model.name,
                fusion=sensor.fusion,
                **figures,
            )
        )
    return tuple(sensors)


def with_ranges(model: SensorModel, sensor: PortableSensor) -> SensorModel:
    """Return a model with the minimum and maximum range of the file, if it states them."""
    if not is_dataclass(model):
        return model
    stated = {key: getattr(sensor, key) for key in RANGES.keys() & {f.name for f in fields(model)}}
    new = {k: v for k, v in stated.items() if v is not None and v != getattr(model, k)}
    return replace(model, **new) if new else model


def picture_of(model: object) -> Picture | None:
    """Return a camera's intrinsics; None for a model that is no camera."""
    if not isinstance(model, Camera):
        return None
    return Picture(model.projection, (model.width, model.height))


def camera_of(name: str, p: Picture, usual: Size | None = None) -> tuple[Camera, str]:
    """Return the camera model of intrinsics, and a message on assumptions (may be empty).
    Intrinsics without an image size get the usual size of the format, if the principal point is
    near its middle, or else the size whose middle is the principal point. If the lens folds inside
    the image, the field of view is limited to the part before the fold, to 0.1 degrees."""
    if p.size is None:
        doubled = [2.0 * middle for middle in p.center]
        size = (round(doubled[0]), round(doubled[1]))
        reason = "has its middle there"
        is_centred = max(abs(a - b) for a, b in zip(doubled, size, strict=True)) < ALIKE_PX
        if usual is not None and not is_centred:  # calibrations do not have half pixels by chance
            offsets = [abs(a / b - 1.0) / 2.0 for a, b in zip(doubled, usual, strict=True)]
            if max(offsets) < OFF_CENTER:
                size = usual
                reason = "is usual there"
        model, _ = camera_of(name, replace(p, size=size))
        return model, f"{name}: no size in the file; {size[0]} x {size[1]} px {reason}"
    if p.is_plain:
        return Camera(name, *p.size, 2.0 * math.atan(p.size[0] / (2.0 * p.fx))), ""
    try:
        return Camera(name, *p.size, lens=p.lens), ""
    except InputError:
        if p.lens.fov is not None:
            raise
    fov_deg = max(math.floor(math.degrees(2.0 * fold_angle(p.lens)) * 10.0) / 10.0, 0.1)
    unfolded = replace(p.lens, fov=math.radians(fov_deg))
    half = math.degrees(unfolded.fov or 0.0) / 2.0
    line = f"{name}: its lens folds inside the picture; what is farther than {half:g} deg from the "
    return Camera(name, *p.size, lens=unfolded), f"{line}axis is left out"


def lidar_of(name: str, scan: Scan) -> Lidar:
    """Return the LiDAR model of a scan, from its listed beams or else with even channels."""
    if scan.directions is not None:
        return _listed(name, scan, scan.directions)
    if scan.compute_emitters is not None:
        emitters = scan.compute_emitters()
        return Lidar(
            name,
            emitters.elevations,
            emitters.ticks,
            scan.max_range,
            azimuth_offsets=emitters.azimuths,
            min_range=scan.min_range,
        )
    elevations = np.linspace(scan.low, scan.high, scan.channels)
    low, high = scan.fov
    if high - low < NO_EXTENT_RAD:  # it does not rotate: all of its channels have one azimuth
        level = np.cos(elevations)
        beams = [level * math.cos(low), level * math.sin(low), np.sin(elevations)]
        return _listed(name, scan, np.stack(beams, axis=1))
    if scan.ends is not None and scan.azimuths > 1:
        return _lidar_between(name, scan, scan.ends, elevations)
    share = min((high - low) / (2.0 * math.pi), 1.0)
    steps = max(round(scan.azimuths / share), 1)
    return Lidar(
        name, elevations, steps, scan.max_range, horizontal_fov=scan.fov, min_range=scan.min_range
    )


def _listed(name: str, scan: Scan, directions: Floats) -> Lidar:
    return Lidar.from_directions(name, directions, scan.max_range, scan.min_range)


def _lidar_between(name: str, scan: Scan, ends: tuple[float, float], elevations: Floats) -> Lidar:
    """Return the LiDAR of a scan with azimuths at both ends and evenly between. It has the steps of
    a full circle if these fit, else its beams are listed. A scan of a whole turn has the azimuth
    at its seam once."""
    low, high = ends
    nominal = (high - low) / (scan.azimuths - 1)
    steps = round(2.0 * math.pi / nominal)
    if abs(2.0 * math.pi / nominal - steps) > OFF_STEP and scan.beam_count <= MAX_BEAMS:
        azimuths = np.tile(np.linspace(low, high, scan.azimuths), len(elevations))
        up = np.repeat(elevations, scan.azimuths)
        level = np.cos(up)
        beams = [level * np.cos(azimuths), level * np.sin(azimuths), np.sin(up)]
        return _listed(name, scan, np.stack(beams, axis=1))
    step = 2.0 * math.pi / steps
    first = round(low / step)
    offset = low - first * step
    offset = 0.0 if abs(offset) <= OFF_STEP * step else offset
    fov = (first * step, (first + scan.azimuths - 1) * step)
    if scan.azimuths >= steps:
        fov = FULL_CIRCLE
    return Lidar(
        name,
        elevations,
        steps,
        scan.max_range,
        azimuth_offsets=np.full(len(elevations), offset),
        horizontal_fov=fov,
        min_range=scan.min_range,
    )


def _ends(model: Lidar) -> tuple[float, float]:
    """Return the first and the last azimuth [rad]; of a full circle, those round the x axis."""
    azimuths = model.azimuth_steps
    first = int(azimuths[0])
    last = int(azimuths[-1])
    if len(azimuths) == model.azimuth_count:
        first = -(model.azimuth_count // 2)
        last = first + model.azimuth_count - 1
    common = _common_offset(model)
    return first * model.azimuth_step + common, last * model.azimuth_step + common


def _common_offset(model: Lidar) -> float:
    """Return the azimuth offset that all channels share [rad]; 0 if they differ."""
    offsets = model.azimuth_offsets
    return float(offsets[0]) if np.ptp(offsets) == 0.0 else 0.0


def _scan(model: Lidar) -> Scan:
    angles = sorted(model.elevations.tolist())
    step = (angles[-1] - angles[0]) / max(len(angles) - 1, 1)
    return Scan(
        len(angles),
        angles[0],
        angles[-1],
        len(model.azimuth_steps),
        fov=model.horizontal_fov,
        max_range=model.max_range,
        even=all(abs(b - a - step) < EVEN_RAD for a, b in pairwise(angles)),
        min_range=model.min_range,
        compute_beams=lambda: model.directions,
        offset_rad=float(np.abs(model.azimuth_offsets - _common_offset(model)).max()),
        ends=_ends(model),
        compute_emitters=lambda: emitters_of(model),
    )


def emitters_of(model: Lidar) -> Emitters:
    """Return a LiDAR as emitters. One that scans less than a whole turn has an emitter for each of
    its beams, which fire once."""
    steps = model.azimuth_steps
    if len(steps) == model.azimuth_count:
        return Emitters(model.azimuth_offsets, model.elevations, model.azimuth_count)
    azimuths = (model.azimuth_offsets[:, None] + steps * model.azimuth_step).ravel()
    around = np.array([math.remainder(a, 2.0 * math.pi) for a in azimuths.tolist()])
    return Emitters(around, np.repeat(model.elevations, len(steps)), ticks=1)


def _camera_model(sensor: PortableSensor, usual: Size | None) -> OwnModel | None:
    if sensor.picture is None:
        return None
    model, line = camera_of(sensor.name, sensor.picture, usual)
    return with_ranges(model, sensor), line


def _model_by_table(sensor: PortableSensor, _: Size | None) -> OwnModel | None:
    if not sensor.parameters:
        return None
    return model_of_table(sensor.model or sensor.name, sensor.parameters), ""


def model_of_table(name: str, parameters: str) -> Any:
    """Return the model of a table in a study, given as JSON; `parameters_of` is its inverse."""
    try:
        table = json.loads(parameters)
    except ValueError as error:
        raise InputError(name, "parameters", "a table of a model (JSON)", error) from None
    return catalog.from_table(name, table)


def _model_by_field(sensor: PortableSensor, _: Size | None) -> OwnModel | None:
    """Return the model of a sensor's table, or one with the file's field of view. It is a radar
    with a single mode, or an ultrasonic sensor with that cone."""
    if sensor.parameters or (seen := sensor.field) is None:
        return _model_by_table(sensor, None)
    name = sensor.model or sensor.name
    if sensor.kind == ULTRASONIC:
        return Ultrasonic(
            name,
            seen.max_range,
            seen.across[1] - seen.across[0],
            seen.up[1] - seen.up[0],
            min_range=seen.min_range,
        ), ""
    model = Radar(
        name,
        [
            RadarMode(
                "scan",
                np.array(seen.across),
                np.array([seen.max_range] * 2),
                np.array(seen.up),
                scales=np.ones(2),
                min_range=seen.min_range,
            )
        ],
    )
    return model, f"{sensor.name}: the file has no resolution and no RCS; 10 dBsm, one cell"


def _with_field(model: Radar | Ultrasonic) -> dict[str, Any]:
    seen = FieldOfView(*model.window, model.max_range, model.min_range)
    return {"parameters": parameters_of(model), "field": seen}


def parameters_of(model: SensorModel) -> str:
    """Return the table of a model as JSON, on one line."""
    return json.dumps(catalog.to_table(model), ensure_ascii=False, separators=(",", ":"))


def catalogued_emitters(name: str) -> Emitters | None:
    """Return the emitters of a catalogued LiDAR; None if the catalogue has none of that name."""
    model = catalog.load(name) if name in catalog.names(LIDAR) else None
    return emitters_of(model) if isinstance(model, Lidar) else None


def scans_of(parameters: str, name: str) -> list[RadarScan]:
    """Return the scans of a radar's table, one a mode, with symmetric fields: the wider side."""
    rows: list[RadarScan] = []
    for number, mode in enumerate(model_of_table(name, parameters).modes, 1):
        across, up = (
            degrees_in_file(max(abs(float(ends[0])), abs(float(ends[-1]))))
            for ends in (mode.azimuths, mode.elevations)
        )
        fine = {}
        for key, field in RESOLUTIONS.items():
            value = getattr(mode, field)
            if value is not None:
                fine[key] = value if key.endswith("M") else degrees_in_file(value)
        rows.append((f"s{number:03d}", float(mode.max_range), across, up, fine))
    return rows


def parameters_of_scans(name: str, scans: Iterable[RadarScan]) -> str:
    """Return the table of the radar with a mode for each scan, whose ranges are those of all its
    directions."""
    modes = []
    for scan, reach, across, up, resolution in scans:
        fine = {RESOLUTIONS[key]: value if key.endswith("M") else math.radians(value)
                for key, value in resolution.items()}  # fmt: skip
        modes.append(
            RadarMode(
                scan,
                np.radians([-across, across]),
                np.array([reach, reach]),
                np.radians([-up, up]),
                scales=np.ones(2),
                **fine,
            )
        )
    return parameters_of(Radar(name, modes))


def spans_of(parameters: str, name: str) -> tuple[float, float]:
    """Return the spans of azimuth and elevation [deg] of the table of an ultrasonic sensor."""
    (left, right), (low, high) = model_of_table(name, parameters).window
    return degrees_in_file(right - left), degrees_in_file(high - low)


PORTABLE_KINDS: dict[str, PortableKind] = {
    LIDAR: PortableKind(
        lambda model: {"scan": _scan(model)},
        lambda sensor, _: None if sensor.scan is None else (lidar_of(sensor.name, sensor.scan), ""),
        "Velodyne VLP-16 Puck",
    ),
    CAMERA: PortableKind(
        lambda model: {"picture": picture_of(model)}, _camera_model, "nuScenes front"
    ),
    RADAR: PortableKind(_with_field, _model_by_field, "Continental ARS408-21"),
    ULTRASONIC: PortableKind(_with_field, _model_by_field, "Bosch Ultrasonic 3.1"),
}  # Rows by kind; other kinds are expressed by `OTHER`
OTHER = PortableKind(
    lambda model: {"parameters": parameters_of(model)}, _model_by_table
)  # The row of a kind without one
