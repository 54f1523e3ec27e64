"""The sensors of a rig: dimensioned drawings, positions, contributions, and what each one sees."""

from __future__ import annotations

from typing import Any

import pe_core as pe

from ..markup import number, percent
from ..pictures.dimension_drawing import side_view, top_view
from ..pictures.sensor_views import sensor_view
from ..pictures.vehicle_picture import sensor_key
from ..report_context import ReportContext

DIGITS = 3
MAX_PARTS, MIN_SHARE = 3, 0.0005
"""Parts of the vehicle that a row names, and the smallest share that such a part occludes."""


def dimensions(context: ReportContext) -> dict[str, Any] | None:
    """Return side and top view with dimensions; None without a vehicle."""
    vehicle, axle = context.display_vehicle[0], context.study.reference
    if vehicle is None:
        return None
    axle_x = None if axle is None else axle.rear_axle_x
    length, width, _ = (vehicle.bounds[1] - vehicle.bounds[0]).tolist()
    front, height = float(vehicle.bounds[1][0]), float(vehicle.bounds[1][2])
    rows = []
    for k, sensor in enumerate(context.rig, 1):
        x, y, z = sensor.pose.position
        side = "" if abs(y) < 0.5 * 10.0**-DIGITS else " left" if y > 0.0 else " right"
        from_axle = [] if axle_x is None else [number(x - axle_x, DIGITS)]
        row = [f"{k} {sensor.name}", number(z, DIGITS), number(front - x, DIGITS), *from_axle]
        rows.append([*row, f"{number(abs(y), DIGITS)}{side}"])
    heads = ["Sensor", "above the ground", "behind the foremost point"]
    heads += [] if axle_x is None else ["forward of the rear axle"]
    return {
        "side": side_view(context.rig, vehicle, f"Side view of {context.name} with dimensions"),
        "top": top_view(
            context.rig, vehicle, axle_x, f"Top view of {context.name} with dimensions"
        ),
        **{"length": length, "width": width, "height": height, "axle": axle},
        "heads": [*heads, "from the centre line"],
        "rows": rows,
    }


def sensor_details(context: ReportContext) -> dict[str, Any]:
    """Return the parts that occlude each sensor, and what each one sees."""
    return {
        "occluding_parts": {
            name: _occluding_parts(score) for name, score in context.after.per_sensor.items()
        },
        "key": sensor_key(context.rig),
        "views": [
            sensor_view(sensor.kind).figure(sensor, context.display_vehicle[0])
            for sensor in context.rig
        ],
    }


def _occluding_parts(score: pe.SensorScore) -> str:
    """Return the parts of the vehicle that occlude most of a sensor."""
    if not score.occluded:
        return "none"
    shares = {name: count / score.beams for name, count in score.occluded_by.items()}
    names = sorted((name for name in shares if shares[name] >= MIN_SHARE), key=lambda n: -shares[n])
    parts = (f"{name} {percent(shares[name], 1)}" for name in names[:MAX_PARTS])
    return ", ".join(parts) or "little"
