"""The radar as a kind: its row of the registry, its table in degrees, and its figures in text."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import Floats
from ...base.errors import InputError, require_keys, shown
from ...base.values import Number, degrees_in_file, listed
from ...metric.entropy import ApCurve
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..field_of_view import FieldPicture
from ..kind import OUT_OF_RANGE, OUT_OF_VIEW, PAPER_VOXEL_M, SIZES, Kind
from ..ray_fan import angles_of, field_picture_of
from ..weather import Weather, rain_db_per_km
from .definition import (
    RULES,
    SURE,
    TARGET,
    fan_of,
    field_of,
    measure_objects,
    seen_through,
    target_detections,
)
from .detection import read_reflectivity, write_reflectivity
from .model import Radar, RadarMode, radar_of

SLOPE = 0.152
"""a of the default curves: that of PointPillars on points of a LiDAR (Ma, Liu and Li, ICRA 2021).
No published AP by number of radar points was found."""
PUBLISHED_AP = {"car": 0.379, "pedestrian": 0.312, "cyclist": 0.657}
"""AP of PointPillars on five scans of View-of-Delft's radar."""
ANCHOR_M = 5.0
"""m at which the default curves have the published AP: a detection in each of the five scans."""
OFFSET = SLOPE * math.log(ANCHOR_M)
OBJECT_CURVES = {
    name: ApCurve(SLOPE, PUBLISHED_AP[like] - OFFSET)
    for name, like in {
        **{name: name for name in PUBLISHED_AP},
        "truck": "car",  # no figure of trucks and cones was found
        "cone": "pedestrian",
    }.items()
}
VOXELS_A_CAR = (SIZES[TARGET][0] + SIZES[TARGET][1]) * SIZES[TARGET][2] / (2.0 * PAPER_VOXEL_M**2)
CAR_CURVE = OBJECT_CURVES[TARGET]
VOXEL_CURVE = ApCurve(CAR_CURVE.a, CAR_CURVE.b + CAR_CURVE.a * math.log(VOXELS_A_CAR))
"""The curve of voxels whose AP is that of the reference car they are part of."""
OWN = (
    "reference_rcs_dbsm",
    "detection_probability",
    "false_alarm",
    "list_length",
    "cover_loss_db",
    "attenuation_db_km",
)
"""Keys that are fields of the model."""
MODE_FIELDS = {
    "name": "name",
    "azimuth_deg": "azimuths",
    "range_m": "ranges",
    "elevation_deg": "elevations",
    "min_range_m": "min_range",
    "max_range_m": "max_range",
    "elevation_scale": "scales",
    "range_resolution_m": "range_resolution",
    "bandwidth_mhz": "bandwidth_mhz",
    "azimuth_resolution_deg": "azimuth_resolution",
    "elevation_resolution_deg": "elevation_resolution",
}
"""Fields of a mode by key, in the order of a file."""
ASCENDING = ("azimuth_deg", "elevation_deg")  # Keys of lists of angles
KEYS = frozenset({"mode", "rcs_dbsm", *OWN})
DEGREES = Number(cap=1e6, unit="degrees", noun="angle")


def read(name: str, table: Mapping[str, Any], folder: Path) -> Radar:
    """Build a radar from its table; `mode` is a list of tables, one for each scan of a frame.
    `InputError` when a key is missing or unknown, or a figure is impossible."""
    modes = listed(table.get("mode"), 100)
    if not modes:
        raise InputError(name, "mode", "a list of tables, one a mode", shown(table.get("mode")))
    own = {key: table[key] for key in OWN if key in table}
    rcs = read_reflectivity(name, table.get("rcs_dbsm", {}))
    read_modes = [_mode(name, mode, number) for number, mode in enumerate(modes)]
    return Radar(name, read_modes, rcs=rcs, **own)


def _mode(name: str, table: Any, number: int) -> RadarMode:
    who = f"mode {number + 1}"
    if not isinstance(table, Mapping):
        raise InputError(name, who, "a table", shown(table))
    require_keys(name, f"{who}: ", table, MODE_FIELDS)
    values: dict[str, Any] = dict.fromkeys(("azimuths", "ranges", "elevations"))
    values |= {"name": who, "scales": 1.0}
    try:
        own = {MODE_FIELDS[key]: _in_radians(key, value) for key, value in table.items()}
        return RadarMode(**values | own)
    except InputError as error:  # name the radar as well
        raise error.within(name) from None


def _in_radians(key: str, value: Any) -> Any:
    """Return a value of a mode's key with its angles in radians; the model checks the others."""
    items = listed(value)
    if not key.endswith("_deg") or value is None or (key in ASCENDING and items is None):
        return value
    if key in ASCENDING:
        return [math.radians(DEGREES.checked("mode", key, item)) for item in items or ()]
    return math.radians(DEGREES.checked("mode", key, value))


def write(model: Radar) -> dict[str, Any]:
    """Return a radar's table."""
    default = Radar(model.name, model.modes)
    own = {key: getattr(model, key) for key in OWN}
    table = {k: v for k, v in own.items() if v is not None and v != getattr(default, k)}
    if model.rcs:
        table["rcs_dbsm"] = write_reflectivity(model.rcs)
    table["mode"] = [_mode_table(mode) for mode in model.modes]
    return table


def _mode_table(mode: RadarMode) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for key, field in MODE_FIELDS.items():
        value = getattr(mode, field)
        numbers = value.tolist() if isinstance(value, np.ndarray) else value
        if key in ASCENDING:
            table[key] = [degrees_in_file(angle) for angle in numbers]
        elif isinstance(numbers, list):  # one number in place of equal ones
            table[key] = numbers[0] if len(set(numbers)) == 1 else numbers
        elif value is not None:
            table[key] = degrees_in_file(value) if key.endswith("_deg") else value
    if table["elevation_scale"] == 1.0:
        del table["elevation_scale"]
    return table


def figures(model: Radar) -> list[str]:
    """Return the figures of each mode, and those of the radar, a line each."""
    lines = [f"{mode.name:<15} {_mode_text(mode)}" for mode in model.modes]
    rcs = model.reference_rcs_dbsm
    pd = model.detection_probability
    lines.append(f"reference       {rcs:g} dBsm at Pd {pd:g}, Pfa {model.false_alarm:g}")
    if model.list_length is not None:
        lines.append(f"list            {model.list_length} detections")
    if model.cover_loss_db:
        lines.append(f"cover           {model.cover_loss_db:g} dB one way")
    return lines


def _mode_text(mode: RadarMode) -> str:
    """Return the figures of a mode in one line."""
    left = math.degrees(mode.azimuths[0])
    right = math.degrees(mode.azimuths[-1])
    low = math.degrees(mode.elevations[0])
    high = math.degrees(mode.elevations[-1])
    cells = [] if mode.range_resolution is None else [f"{mode.range_resolution:g} m"]
    for angle in (mode.azimuth_resolution, mode.elevation_resolution):
        cells += [] if angle is None else [f"{math.degrees(angle):g} deg"]
    field = f"{left:g} to {right:g} x {low:g} to {high:g} deg"
    size = f", cells {' x '.join(cells)}" if cells else ""
    return f"{mode.min_range:g} to {mode.max_range:g} m, {field}{size}"


def summary(model: Radar) -> str:
    """Return the number of modes, the field of view across and up, and the range."""
    (left, right), (low, high) = model.window
    field = f"{math.degrees(right - left):.0f} x {math.degrees(high - low):.0f} deg"
    modes = f"{len(model.modes)} modes, " if len(model.modes) > 1 else ""
    return f"{modes}{field}, {model.max_range:g} m"


def in_weather(model: Radar, weather: Weather) -> Radar:
    """Add the attenuation of rain, ITU-R P.838-3; fog and snow leave the radar as it is."""
    rain = rain_db_per_km(weather.rain_mm_h)
    return replace(model, attenuation_db_km=model.attenuation_db_km + rain) if rain else model


def missed(sensor: Sensor, center: Floats, side: float) -> str:
    """Return one of: out of range, out of view."""
    offset = np.asarray(center)[None] - np.asarray(sensor.pose.position)
    reaches = [mode.reach(*angles_of(sensor, offset))[0] for mode in radar_of(sensor).modes]
    return OUT_OF_RANGE if max(reaches) > 0.0 else OUT_OF_VIEW


def covers_met(sensor: Sensor, vehicle: Vehicle) -> Mapping[str, tuple[float, float]]:
    """Return loss [dB] and share of the field of each cover that rays pass."""
    fan = fan_of(sensor, vehicle)
    inside = field_of(sensor, fan)
    shares = {name: float(met[inside].mean()) for name, met in fan.through.items()}
    return {name: (vehicle.covers[name], share) for name, share in shares.items() if share}


def field_picture(sensor: Sensor, vehicle: Vehicle | None) -> FieldPicture:
    """Return the expected detections of a reference car by range and azimuth."""
    radar = radar_of(sensor)
    fan = fan_of(sensor, vehicle)

    def measured(centers: Floats) -> tuple[Floats, Floats]:
        offsets = centers - np.asarray(sensor.pose.position)
        distance = np.sqrt((offsets * offsets).sum(axis=1))
        angles = angles_of(sensor, offsets)
        free, loss = seen_through(fan, angles, distance)
        m = target_detections(radar, angles, distance, loss)
        return np.where(free, m, 0.0), target_detections(radar, angles, distance, None)

    target = TARGET, SIZES[TARGET][2] / 2.0
    return field_picture_of(sensor, radar.window, radar.max_range, target, measured=measured)


RADAR = Kind(
    name="radar",
    label="Radar",
    plural="Radars",
    unit="detections",
    model=Radar,
    curve=VOXEL_CURVE,
    object_curves=OBJECT_CURVES,
    counts_points=True,
    point=SURE,
    # Its figure for what stands on the ground is that of a pedestrian: the cylinder of UN R158 and
    # FMVSS 111, which stands for a small child, is the lowest.
    lowest_m=0.8,
    keys=KEYS,
    occlusion_text="field occluded",
    measure_objects=measure_objects,
    read=read,
    write=write,
    in_weather=in_weather,
    cautious=lambda model: model if model.is_cautious else model.cautious,
    data_sheet=figures,
    summary=summary,
    missed=missed,
    covers_met=covers_met,
    field_picture=field_picture,
    **RULES.functions,
)
