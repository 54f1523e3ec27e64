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
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..field_of_view import NEAREST
from ..kind import OUT_OF_RANGE, OUT_OF_VIEW, SIZES
from ..ray_fan import angles_of
from ..ray_fan_kind import FanKind
from ..ray_fan_view import FieldPicture, field_picture_of, free_fan
from .definition import fan_of, in_cone, measure_objects, returns_echo
from .kernels import RULES
from .model import RANGE, RIGHT_ANGLE, Ultrasonic, ultrasonic_of

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


class UltrasonicKind(FanKind):
    """Ultrasonic sensors: m is 1 where an echo comes back, else 0."""

    name, label, plural = "ultrasonic", "Ultrasonic", "Ultrasonic Sensors"
    unit = "echoes"
    model = Ultrasonic
    curve = NO_AP
    object_curves = _AnyClass()
    counts_points = True
    lowest_m = 0.01
    """Flat ground returns no echo."""
    keys = frozenset({"hfov_deg", "vfov_deg", "max_range_m", "min_range_m", "max_incidence_deg"})
    occlusion_text = "cone occluded"
    rules = RULES

    def measure_objects(
        self, sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
    ) -> Floats:
        """Return 1 for each object that returns an echo."""
        return measure_objects(sensor, objects, vehicle, traffic)

    def read(self, name: str, table: Mapping[str, Any], folder: Path) -> Ultrasonic:
        """Build an ultrasonic sensor from its table."""
        angles = {
            key: math.radians(DEGREES.checked(name, f"{key}_deg", table.get(f"{key}_deg", default)))
            for key, default in (("hfov", None), ("vfov", None), ("max_incidence", 90.0))
        }
        reach = RANGE.checked(name, "max_range_m", table.get("max_range_m"))
        return Ultrasonic(name, reach, min_range=table.get("min_range_m", NEAREST), **angles)

    def write(self, model: Ultrasonic) -> dict[str, Any]:
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

    def data_sheet(self, model: Ultrasonic) -> list[str]:
        """Return the cone and the range, a line each."""
        lines = [
            f"cone            {math.degrees(model.hfov):g} x {math.degrees(model.vfov):g} deg",
            f"range           {model.min_range:g} to {model.max_range:g} m",
        ]
        if model.max_incidence < RIGHT_ANGLE:
            lines.append(f"incidence       up to {math.degrees(model.max_incidence):g} deg")
        return lines

    def summary(self, model: Ultrasonic) -> str:
        """Return the cone and the range in one line."""
        cone = f"{math.degrees(model.hfov):.0f} x {math.degrees(model.vfov):.0f} deg"
        return f"{cone}, {model.max_range:g} m"

    def missed(self, sensor: Sensor, center: Floats, side: float) -> str:
        """Return one of: out of range, out of view."""
        offset = np.asarray(center)[None] - np.asarray(sensor.pose.position)
        inside = in_cone(ultrasonic_of(sensor), *angles_of(sensor, offset))[0]
        return OUT_OF_RANGE if inside else OUT_OF_VIEW

    def field_picture(self, sensor: Sensor, vehicle: Vehicle | None) -> FieldPicture:
        """Return where a thin post at the sensor's height returns an echo."""
        fan, model = fan_of(sensor, vehicle), ultrasonic_of(sensor)
        free = free_fan(model.window)
        position = np.asarray(sensor.pose.position)

        def measured(centers: Floats) -> tuple[Floats, Floats]:
            offsets = centers - position
            with_body, without = (returns_echo(sensor, f, offsets) for f in (fan, free))
            return with_body.astype(float), without.astype(float)

        target = "post", float(position[2])
        return field_picture_of(sensor, model.window, model.max_range, target, measured)


ULTRASONIC = UltrasonicKind()
