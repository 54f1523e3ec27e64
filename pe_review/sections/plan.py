"""The dimensioned plan: the vehicle's size, and where the sensors sit on it."""

from __future__ import annotations

from collections.abc import Iterator

from ..engine import pe
from ..figures import number
from ..markup import Markup, table
from ..pictures.dimensions import side_view, top_view
from ..pictures.svg import STYLE, figure, grid
from ..reviewed import Reviewed
from ..section import Section

DIGITS = 3


def plan(one: Reviewed) -> Section:
    """Return side and top view with dimensions; nothing without a vehicle."""
    vehicle = one.shown_vehicle[0]
    if vehicle is None:
        return Section("plan", "Dimensions", "")
    axle = one.found.reference
    axle_x = None if axle is None else axle.rear_axle_x
    size = vehicle.bounds[1] - vehicle.bounds[0]
    length, width = (number(v) for v in size[:2].tolist())
    height = number(float(vehicle.bounds[1][2]))
    drawn = [
        figure(
            side_view(one.rig, vehicle, f"Side view of {one.name} with dimensions"),
            f"<b>From the right</b>: {length} m long, {height} m high over the ground",
        ),
        figure(
            top_view(one.rig, vehicle, axle_x, f"Top view of {one.name} with dimensions"),
            f"<b>From above</b>: {width} m wide; ahead is to the right",
        ),
    ]
    inside = f"{grid(drawn, 24.0)}{_table(one, vehicle, axle_x)}{_axles(axle)}"
    return Section("plan", "Dimensions", inside, styles=(STYLE,))


def _table(one: Reviewed, vehicle: pe.Vehicle, axle_x: float | None) -> str:
    heads = ["Sensor", "over the ground", "behind the foremost point"]
    heads += ["forward of the rear axle"] if axle_x is not None else []
    heads += ["beside the middle"]
    return table("Where sensors sit, in metres", heads, _rows(one, vehicle, axle_x))


def _rows(one: Reviewed, vehicle: pe.Vehicle, axle_x: float | None) -> Iterator[list[str]]:
    front = float(vehicle.bounds[1][0])
    for k, sensor in enumerate(one.rig):
        x, y, z = sensor.pose.position
        row = [f"{k + 1} {sensor.name}", number(z, DIGITS), number(front - x, DIGITS)]
        row += [number(x - axle_x, DIGITS)] if axle_x is not None else []
        side = "" if abs(y) < 0.5 * 10.0**-DIGITS else " left" if y > 0.0 else " right"
        yield [*row, f"{number(abs(y), DIGITS)}{side}"]


def _axles(axle: pe.Reference | None) -> Markup:
    if axle is None:
        words = "The study has no [reference]: where the axles are is not known."
    else:
        base = f", wheelbase {number(axle.wheelbase, DIGITS)} m" if axle.wheelbase else ""
        words = f"Rear axle {number(axle.rear_axle_z, DIGITS)} m over the ground{base}."
    return Markup(f'<p class="note">{words} Dimensions are those of the mesh.</p>')
