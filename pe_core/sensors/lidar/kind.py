"""The LiDAR as a kind: its row of the registry, its table in degrees, and its figures in text."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputError, shown
from ...base.plugins import shipped
from ...base.values import A_PATH, Number, degrees_in_file, listed, vector
from ...metric.entropy import POINTPILLARS, ApCurve
from ..field_of_view import NEAREST, limited
from ..kind import Kind, derived_object_curves
from ..weather import Weather, lidar_range
from .definition import count_beams, count_on_objects, count_on_parts
from .field_of_view import beam_patch, beams_to, reason_missed, sample_beams
from .kernel_objects import LidarObjects
from .kernel_voxels import LidarGrid, LidarGround, LidarSample
from .model import RANGE, STEPS, Lidar

FITTED = {
    "car": ApCurve(0.237, -0.516),
    "pedestrian": ApCurve(0.163, -0.306),
    "cyclist": ApCurve(0.143, -0.022),
}
"""Fits of AP to the beams of an HDL-64E that end on the box (`fit_ap_curve` on docs/objects/*.csv):
PointRCNN's detections in KITTI's tracking sequences (from the public AB3DMOT repository), AP at 40
recalls by KITTI's overlaps (0.7 for cars, 0.5 for the others). The detector was trained on drives
that overlap with these, so its AP is rather high."""
PLOT_ROWS = 24
BAR_WIDTH = 48
KEYS = frozenset(
    {
        "angles",
        "elevations_deg",
        "azimuth_count",
        "azimuth_step_deg",
        "max_range_m",
        "min_range_m",
        "azimuth_offsets_deg",
        "horizontal_fov_deg",
    }
)
GAP_DEG = 30.0
"""A LiDAR whose horizontal field of view leaves out no more than this measures all around."""
DEGREES = Number(cap=1e6, unit="degrees", noun="angle")
STEP_DEG = Number(0.001, 360.0, unit="degrees", noun="angle")


def read(name: str, table: Mapping[str, Any], folder: Path) -> Lidar:
    """Build a LiDAR from its table; the path of a file of `angles` is relative to `folder`."""
    elevations, offsets = _channels(name, table, folder)
    if "azimuth_count" in table:
        azimuths = STEPS.checked(name, "azimuth_count", table["azimuth_count"])
    else:  # 360 degrees over the nominal step, rounded
        step = STEP_DEG.checked(name, "azimuth_step_deg", table.get("azimuth_step_deg"))
        azimuths = round(360.0 / step)
    fov = table.get("horizontal_fov_deg", (-180.0, 180.0))
    low, high = map(math.radians, vector(name, "horizontal_fov_deg", fov, count=2, rule=DEGREES))
    return Lidar(
        name,
        elevations,
        azimuths,
        RANGE.checked(name, "max_range_m", table.get("max_range_m")),
        azimuth_offsets=offsets,  # type: ignore[arg-type]
        horizontal_fov=(low, high),
        min_range=table.get("min_range_m", NEAREST),
    )


def write(model: Lidar) -> dict[str, Any]:
    """Return a LiDAR's table."""
    table: dict[str, Any] = {
        "azimuth_count": model.azimuth_count,
        "max_range_m": model.max_range,
        "horizontal_fov_deg": [degrees_in_file(a) for a in model.horizontal_fov],
        "elevations_deg": [degrees_in_file(a) for a in model.elevations.tolist()],
    }
    if any(offsets := model.azimuth_offsets.tolist()):
        table["azimuth_offsets_deg"] = [degrees_in_file(a) for a in offsets]
    if model.min_range > NEAREST:
        table["min_range_m"] = model.min_range
    return table


def _channels(
    name: str, table: Mapping[str, Any], folder: Path
) -> tuple[np.ndarray, np.ndarray | None]:
    """Elevations (C,) and, if the table has them, azimuth offsets (C,) [rad]."""
    if "angles" in table:
        file = A_PATH.checked(name, "angles", table["angles"])
        for key in ("elevations_deg", "azimuth_offsets_deg"):
            if key in table:
                raise InputError(name, "angles", f"either a file of angles or {key}", "both")
        try:
            channels = shipped("reader.angles")(folder / file)
        except InputError as error:  # a study replaces the source; the field keeps the file's name
            raise error.within(name, f"angles: {error.source}") from None
        return (
            np.array([math.radians(c.elevation_deg) for c in channels]),
            np.array([math.radians(c.azimuth_offset_deg) for c in channels]),
        )
    elevations = _radians(name, table, "elevations_deg")
    if "azimuth_offsets_deg" not in table:
        return elevations, None
    return elevations, _radians(name, table, "azimuth_offsets_deg")


def _radians(name: str, table: Mapping[str, Any], key: str) -> np.ndarray:
    values = listed(table.get(key))
    if not values:
        raise InputError(name, key, "a list of angles", shown(table.get(key)))
    return np.array([math.radians(DEGREES.checked(name, key, v)) for v in values])


def figures(model: Lidar) -> list[str]:
    """Return the channels, azimuths, number of beams and range, a line each."""
    low = math.degrees(model.elevations.min())
    high = math.degrees(model.elevations.max())
    left, right = (math.degrees(a) for a in model.horizontal_fov)
    min_range = f"{model.min_range:g} to " if model.min_range > 0.0 else ""
    return [
        f"channels        {len(model.elevations)}, {low:g} to {high:g} deg",
        f"azimuths        {len(model.azimuth_steps)}, {left:g} to {right:g} deg, "
        f"every {math.degrees(model.azimuth_step):.4g} deg",
        f"beams a frame   {model.beam_count}",
        f"range           {min_range}{model.max_range:g} m",
    ]


def summary(model: Lidar) -> str:
    """Return the number of channels, the field of view across and up, and the range."""
    across = math.degrees(model.horizontal_fov[1] - model.horizontal_fov[0])
    up = math.degrees(model.elevations.max() - model.elevations.min())
    fov = f"{min(across, 360.0):.0f} x {up:.0f} deg"
    return f"{len(model.elevations)} channels, {fov}, {model.max_range:g} m"


def plot(model: Lidar) -> list[str]:
    """Return a histogram of the elevations in text, top first: one mark is one channel."""
    counts, edges = np.histogram(np.degrees(model.elevations), bins=PLOT_ROWS)
    scale = min(1.0, BAR_WIDTH / counts.max())
    return [
        f"{(edges[i] + edges[i + 1]) / 2:8.2f} deg |{'#' * math.ceil(counts[i] * scale)}"
        for i in reversed(range(PLOT_ROWS))
    ]


def in_weather(model: Lidar, weather: Weather) -> Lidar:
    """Return a LiDAR under a weather: its range, and which of its beams return."""
    if weather.returns not in ("", model.returns):
        model = replace(model, returns=weather.returns)
    whole: Lidar = limited(model, lidar_range(model.max_range, weather))
    return whole


def sees_all_around(lidar: Lidar) -> bool:
    """Whether a LiDAR's field of view has no horizontal gap wider than GAP_DEG."""
    low, high = lidar.horizontal_fov
    return bool(high - low >= math.radians(360.0 - GAP_DEG))


LIDAR = Kind(
    name="lidar",
    label="LiDAR",
    plural="LiDARs",
    unit="beams",
    model=Lidar,
    curve=POINTPILLARS,
    object_curves=derived_object_curves(POINTPILLARS) | FITTED,
    counts_points=True,
    shows_parts=True,
    keys=KEYS,
    measure=count_beams,
    measure_objects=count_on_objects,
    measure_parts=count_on_parts,
    read=read,
    write=write,
    in_weather=in_weather,
    stand_off_m=0.15,
    outward=lambda model: not sees_all_around(model),
    lowest_ray=lambda model: -float(model.elevations.min()),
    data_sheet=figures,
    summary=summary,
    plot=plot,
    rays=sample_beams,
    rays_to=beams_to,
    missed=reason_missed,
    view=beam_patch,
    on_grid=LidarGrid,
    on_sample=LidarSample,
    on_ground=LidarGround,
    on_objects=LidarObjects,
)
