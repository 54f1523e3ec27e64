"""The radar as a kind of sensor: its row of the registry, and its figures in text."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import Floats
from ...metric.entropy import ApCurve
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..kind import OUT_OF_RANGE, OUT_OF_VIEW, PAPER_VOXEL_M, SIZES
from ..ray_fan import angles_of
from ..ray_fan_kind import FanKind
from ..ray_fan_view import FieldPicture, field_picture_of
from ..weather import Weather, rain_db_per_km
from . import sensor_table
from .definition import SURE, TARGET, fan_of, measure_objects, seen_through, target_detections
from .kernels import RULES, field_of
from .model import Radar, RadarMode, radar_of

SLOPE = 0.152
"""a of the default curves: that of PointPillars on points of a LiDAR (Ma, Liu and Li, ICRA 2021).
No published AP by number of radar points was found."""
PUBLISHED_AP = {"car": 0.379, "pedestrian": 0.312, "cyclist": 0.657}
"""AP of PointPillars on five scans of View-of-Delft's radar."""
ANCHOR_M = 5.0
"""m at which the default curves have the published AP: a detection in each of the five scans."""


def _object_curves() -> dict[str, ApCurve]:
    """Return the default curves of classes: the published AP at `ANCHOR_M`, with slope `SLOPE`.

    A truck gets the AP of cars, a cone that of pedestrians: no figure of theirs was found.
    """
    published = PUBLISHED_AP | {
        "truck": PUBLISHED_AP["car"],
        "cone": PUBLISHED_AP["pedestrian"],
    }
    offset = SLOPE * math.log(ANCHOR_M)
    return {name: ApCurve(SLOPE, ap - offset) for name, ap in published.items()}


def _voxel_curve(of_target: ApCurve) -> ApCurve:
    """Return the curve of voxels whose AP is that of the reference car they are part of."""
    length, width, height = SIZES[TARGET]
    times = (length + width) * height / (2.0 * PAPER_VOXEL_M**2)
    return ApCurve(of_target.a, of_target.b + of_target.a * math.log(times))


OBJECT_CURVES = _object_curves()


class RadarKind(FanKind):
    """Radars: m is the number of expected detections."""

    name, label, plural, unit = "radar", "Radar", "Radars", "detections"
    model = Radar
    curve = _voxel_curve(OBJECT_CURVES[TARGET])
    object_curves = OBJECT_CURVES
    counts_points = True
    point = SURE
    lowest_m = 0.8
    """Its figure for what stands on the ground is that of a pedestrian: the cylinder of UN R158 and
    FMVSS 111, which stands for a small child, is the lowest."""
    keys = sensor_table.KEYS
    rules = RULES
    occlusion_text = "field occluded"

    def measure_objects(
        self, sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
    ) -> Floats:
        """Measure the expected detections of each object."""
        return measure_objects(sensor, objects, vehicle, traffic)

    def read(self, name: str, table: Mapping[str, Any], folder: Path) -> Radar:
        """Build a radar from its table."""
        return sensor_table.read(name, table)

    def write(self, model: Radar) -> dict[str, Any]:
        """Return a radar's table."""
        return sensor_table.write(model)

    def in_weather(self, model: Radar, weather: Weather) -> Radar:
        """Add the attenuation of rain, ITU-R P.838-3; fog and snow leave it as it is."""
        rain = rain_db_per_km(weather.rain_mm_h)
        return replace(model, attenuation_db_km=model.attenuation_db_km + rain) if rain else model

    def cautious(self, model: Radar) -> Radar:
        """Return the radar with the RCS that 95 % of the bodies exceed."""
        return model if model.is_cautious else model.cautious

    def data_sheet(self, model: Radar) -> list[str]:
        """Return the figures of each mode, and those of the radar, a line each."""
        lines = [f"{mode.name:<15} {_mode_text(mode)}" for mode in model.modes]
        rcs, pd = model.reference_rcs_dbsm, model.detection_probability
        lines.append(f"reference       {rcs:g} dBsm at Pd {pd:g}, Pfa {model.false_alarm:g}")
        if model.list_length is not None:
            lines.append(f"list            {model.list_length} detections")
        if model.cover_loss_db:
            lines.append(f"cover           {model.cover_loss_db:g} dB one way")
        return lines

    def summary(self, model: Radar) -> str:
        """Return the number of modes, the field of view across and up, and the range."""
        (left, right), (low, high) = model.window
        field = f"{math.degrees(right - left):.0f} x {math.degrees(high - low):.0f} deg"
        modes = f"{len(model.modes)} modes, " if len(model.modes) > 1 else ""
        return f"{modes}{field}, {model.max_range:g} m"

    def missed(self, sensor: Sensor, center: Floats, side: float) -> str:
        """Return one of: out of range, out of view."""
        offset = np.asarray(center)[None] - np.asarray(sensor.pose.position)
        reaches = [mode.reach(*angles_of(sensor, offset))[0] for mode in radar_of(sensor).modes]
        return OUT_OF_RANGE if max(reaches) > 0.0 else OUT_OF_VIEW

    def covers_met(self, sensor: Sensor, vehicle: Vehicle) -> Mapping[str, tuple[float, float]]:
        """Return loss [dB] and share of the field of each cover that rays pass."""
        fan = fan_of(sensor, vehicle)
        inside = field_of(sensor, fan)
        shares = {name: float(met[inside].mean()) for name, met in fan.through.items()}
        return {name: (vehicle.covers[name], share) for name, share in shares.items() if share}

    def field_picture(self, sensor: Sensor, vehicle: Vehicle | None) -> FieldPicture:
        """Return the expected detections of a reference car by range and azimuth."""
        radar, fan = radar_of(sensor), fan_of(sensor, vehicle)

        def measured(centers: Floats) -> tuple[Floats, Floats]:
            offsets = centers - np.asarray(sensor.pose.position)
            distance = np.sqrt((offsets * offsets).sum(axis=1))
            angles = angles_of(sensor, offsets)
            free, loss = seen_through(fan, angles, distance)
            m = target_detections(radar, angles, distance, loss)
            return np.where(free, m, 0.0), target_detections(radar, angles, distance, None)

        target = TARGET, SIZES[TARGET][2] / 2.0
        return field_picture_of(sensor, radar.window, radar.max_range, target, measured)


def _mode_text(mode: RadarMode) -> str:
    """Return the figures of a mode in one line."""
    left, right = math.degrees(mode.azimuths[0]), math.degrees(mode.azimuths[-1])
    low, high = math.degrees(mode.elevations[0]), math.degrees(mode.elevations[-1])
    cells = [] if mode.range_resolution is None else [f"{mode.range_resolution:g} m"]
    for angle in (mode.azimuth_resolution, mode.elevation_resolution):
        cells += [] if angle is None else [f"{math.degrees(angle):g} deg"]
    field = f"{left:g} to {right:g} x {low:g} to {high:g} deg"
    size = f", cells {' x '.join(cells)}" if cells else ""
    return f"{mode.min_range:g} to {mode.max_range:g} m, {field}{size}"


RADAR = RadarKind()
