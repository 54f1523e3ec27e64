"""The ultrasonic sensor as a kind: its row of the registry, its table, and its figures in text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import Floats
from ...base.degrees import degrees_in_file
from ...base.values import Number
from ...metric.entropy import AP_MIN, ApCurve
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..field_of_view import NEAREST, FieldPicture
from ..kind import OUT_OF_RANGE, OUT_OF_VIEW, SIZES, Kind
from ..ray_fan import RayFan, angles_of, field_picture_of
from .definition import (
    RANGE,
    RIGHT_ANGLE,
    RULES,
    Ultrasonic,
    fan_of,
    in_cone,
    measure_objects,
    returns_echo,
    ultrasonic_of,
)

NO_AP = ApCurve(1e-12, AP_MIN)
"""AP 0.001 whatever is measured: adds nothing to an entropy. No AP of a detector on ultrasonic
sensors was found; a study may have its own curve."""
DEGREES = Number(0.0, 180.0, above=True, unit="degrees", noun="angle")


class _AnyClass(Mapping[str, ApCurve]):
    """`NO_AP` for a class of any name."""

    def __getitem__(self, name: str) -> ApCurve:
        return NO_AP

    def __iter__(self) -> Iterator[str]:
        return iter(SIZES)

    def __len__(self) -> int:
        return len(SIZES)


def read(name: str, table: Mapping[str, Any], folder: Path) -> Ultrasonic:
    """Build an ultrasonic sensor from its table."""
    angles = {
        key: math.radians(DEGREES.checked(name, f"{key}_deg", table.get(f"{key}_deg", default)))
        for key, default in (("hfov", None), ("vfov", None), ("max_incidence", 90.0))
    }
    reach = RANGE.checked(name, "max_range_m", table.get("max_range_m"))
    return Ultrasonic(name, reach, min_range=table.get("min_range_m", NEAREST), **angles)


def write(model: Ultrasonic) -> dict[str, Any]:
    """Return the table of an ultrasonic sensor."""
    table: dict[str, Any] = {
        "hfov_deg": degrees_in_file(model.hfov),
        "vfov_deg": degrees_in_file(model.vfov),
        "max_range_m": model.max_range,
    }
    if model.min_range > NEAREST:
        table["min_range_m"] = model.min_range
    if model.max_incidence < RIGHT_ANGLE:
        table["max_incidence_deg"] = degrees_in_file(model.max_incidence)
    return table


def figures(model: Ultrasonic) -> list[str]:
    """Return the cone and the range, a line each."""
    lines = [
        f"cone            {math.degrees(model.hfov):g} x {math.degrees(model.vfov):g} deg",
        f"range           {model.min_range:g} to {model.max_range:g} m",
    ]
    if model.max_incidence < RIGHT_ANGLE:
        lines.append(f"incidence       up to {math.degrees(model.max_incidence):g} deg")
    return lines


def summary(model: Ultrasonic) -> str:
    """Return the cone and the range in one line."""
    cone = f"{math.degrees(model.hfov):.0f} x {math.degrees(model.vfov):.0f} deg"
    return f"{cone}, {model.max_range:g} m"


def missed(sensor: Sensor, center: Floats, side: float) -> str:
    """Return one of: out of range, out of view."""
    offset = np.asarray(center)[None] - np.asarray(sensor.pose.position)
    inside = in_cone(ultrasonic_of(sensor), *angles_of(sensor, offset))[0]
    return OUT_OF_RANGE if inside else OUT_OF_VIEW


def field_picture(sensor: Sensor, vehicle: Vehicle | None) -> FieldPicture:
    """Return where a thin post at the sensor's height returns an echo."""
    model, position = ultrasonic_of(sensor), np.asarray(sensor.pose.position)
    fans = fan_of(sensor, vehicle), RayFan.free(model.window)

    def measured(centers: Floats) -> tuple[Floats, Floats]:
        with_body, without = (returns_echo(sensor, fan, centers - position) for fan in fans)
        return with_body.astype(float), without.astype(float)

    target = "post", float(position[2])
    return field_picture_of(sensor, model.window, model.max_range, target, measured)


ULTRASONIC = Kind(
    name="ultrasonic",
    label="Ultrasonic",
    plural="Ultrasonic Sensors",
    unit="echoes",
    model=Ultrasonic,
    curve=NO_AP,
    object_curves=_AnyClass(),
    counts_points=True,
    lowest_m=0.01,  # flat ground returns no echo
    keys=frozenset({"hfov_deg", "vfov_deg", "max_range_m", "min_range_m", "max_incidence_deg"}),
    occlusion_text="cone occluded",
    measure_objects=measure_objects,
    read=read,
    write=write,
    data_sheet=figures,
    summary=summary,
    missed=missed,
    field_picture=field_picture,
    **RULES.functions,
)
