"""The sensors of a rig: dimensioned drawings, positions, contributions, and what each one sees."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import pe_core as pe

from ... import graphics
from ..markup import Markup, escaped, number, percent, signed, table
from ..pictures.dimension_drawing import side_view, top_view
from ..pictures.sensor_views import sensor_view
from ..pictures.svg import STYLE, figure, figure_grid, hexadecimal
from ..report_context import ReportContext, Section

DIGITS = 3
POSITION_HEADS = ("sensor", "model", "x [m]", "y [m]", "z [m]", "roll [°]", "pitch [°]", "yaw [°]")
CONTRIBUTION_HEADS = (
    *("sensor", "entropy alone [nats]", "coverage alone", "rise of entropy without it"),
    *("occluded by the vehicle", "occluding parts"),
)
MAX_PARTS, MIN_SHARE = 3, 0.0005
"""Parts of the vehicle that a row names, and the smallest share that such a part occludes."""
FIGURE_SIZES = (
    "Persons are 1.75 m tall; cars are 4.5 m long, 1.8 m wide and 1.5 m high. Numbers and rings "
    "are distances from the sensor along the ground."
)


def dimensions(context: ReportContext) -> Section:
    """Return side and top view with dimensions; an empty section without a vehicle."""
    vehicle = context.display_vehicle[0]
    if vehicle is None:
        return Section("plan", "Dimensions", "")
    axle = context.study.reference
    axle_x = None if axle is None else axle.rear_axle_x
    size = vehicle.bounds[1] - vehicle.bounds[0]
    length, width = (number(v) for v in size[:2].tolist())
    height = number(float(vehicle.bounds[1][2]))
    views = [
        figure(
            side_view(context.rig, vehicle, f"Side view of {context.name} with dimensions"),
            f"<b>From the right</b>: {length} m long, {height} m high above the ground",
        ),
        figure(
            top_view(context.rig, vehicle, axle_x, f"Top view of {context.name} with dimensions"),
            f"<b>From above</b>: {width} m wide; ahead is to the right",
        ),
    ]
    tables = f"{_dimension_table(context, vehicle, axle_x)}{_axle_note(axle)}"
    inside = f"{figure_grid(views, 24.0)}{tables}"
    return Section("plan", "Dimensions", inside, styles=(STYLE,))


def _dimension_table(context: ReportContext, vehicle: pe.Vehicle, axle_x: float | None) -> str:
    heads = ["Sensor", "above the ground", "behind the foremost point"]
    heads += ["forward of the rear axle"] if axle_x is not None else []
    heads += ["from the centre line"]
    caption = "Positions of the sensors, in metres"
    return table(caption, heads, _dimension_rows(context, vehicle, axle_x))


def _dimension_rows(
    context: ReportContext, vehicle: pe.Vehicle, axle_x: float | None
) -> Iterator[list[str]]:
    front = float(vehicle.bounds[1][0])
    for k, sensor in enumerate(context.rig):
        x, y, z = sensor.pose.position
        row = [f"{k + 1} {sensor.name}", number(z, DIGITS), number(front - x, DIGITS)]
        row += [number(x - axle_x, DIGITS)] if axle_x is not None else []
        side = "" if abs(y) < 0.5 * 10.0**-DIGITS else " left" if y > 0.0 else " right"
        yield [*row, f"{number(abs(y), DIGITS)}{side}"]


def _axle_note(axle: pe.Reference | None) -> Markup:
    if axle is None:
        text = "The study has no [reference]: the position of the axles is not known."
    else:
        base = f", wheelbase {number(axle.wheelbase, DIGITS)} m" if axle.wheelbase else ""
        text = f"The rear axle is {number(axle.rear_axle_z, DIGITS)} m above the ground{base}."
    return Markup(f'<p class="note">{text} Dimensions are those of the mesh.</p>')


def sensor_details(context: ReportContext) -> Section:
    """Return positions, contributions and views of the sensors.

    On a page of several studies, the comparison contains the tables.
    """
    tables = ""
    if context.study_count == 1:
        tables = f"{position_tables(context)}{_contribution_table(context)}"
    inside = f"{tables}{context.cached('views', lambda: _views(context))}"
    return Section("sensors", "Sensors", inside, styles=(STYLE,))


def position_tables(context: ReportContext) -> str:
    """Return tables of the poses, in the ground frame and relative to the rear axle."""
    frame = (
        "x is forward, y left, z up; positive pitch is nose down. The origin is on the ground "
        "under the vehicle's centre."
    )
    rows = _position_rows(context.rig, (0.0, 0.0))
    ground = table("Poses in the ground frame", POSITION_HEADS, rows)
    axle = context.study.reference
    if axle is None:
        note = "The study has no [reference], so there is no table relative to the rear axle."
        return f'{ground}<p class="note">{frame} {note}</p>'
    origin = axle.rear_axle_x, axle.rear_axle_z
    caption = (
        f"Poses relative to the centre of the rear axle (x {number(origin[0], 3)} m, "
        f"z {number(origin[1], 3)} m)"
    )
    from_axle = table(caption, POSITION_HEADS, _position_rows(context.rig, origin))
    return f'{ground}{from_axle}<p class="note">{frame}</p>'


def _position_rows(rig: pe.Rig, origin: tuple[float, float]) -> Iterable[list[str]]:
    for sensor in rig:
        x, y, z = sensor.pose.position
        position = (x - origin[0], y, z - origin[1])
        angles = (number(angle, 2) for angle in sensor.pose.rotation_deg)
        yield [sensor.name, sensor.model.name, *(number(v, 3) for v in position), *angles]


def _contribution_table(context: ReportContext) -> str:
    """Return what each sensor contributes to the rig, and what the vehicle occludes of it."""
    rows = []
    for name, score in context.after.per_sensor.items():
        occluded = f"{percent(score.occluded / score.beams, 1)}" if score.beams else "not known"
        values = number(score.entropy), percent(score.coverage, 1), signed(score.lost)
        rows.append([name, *values, occluded, _occluding_parts(score)])
    note = "Occluded is the share of a sensor's beams or pixels that meet the vehicle itself."
    contributions = table("Contribution of each sensor", CONTRIBUTION_HEADS, rows)
    return f'{contributions}<p class="note">{note}</p>'


def _occluding_parts(score: pe.SensorScore) -> str:
    """Return the parts of the vehicle that occlude most of a sensor."""
    if not score.occluded:
        return "none"
    shares = {name: count / score.beams for name, count in score.occluded_by.items()}
    names = sorted((name for name in shares if shares[name] >= MIN_SHARE), key=lambda n: -shares[n])
    parts = (f"{name} {percent(shares[name], 1)}" for name in names[:MAX_PARTS])
    return ", ".join(parts) or "little"


def _views(context: ReportContext) -> str:
    """Return a figure of what each sensor sees."""
    colors = graphics.sensor_colors_on_paper(context.rig)
    views = "".join(
        _view(context, number, sensor, hexadecimal(colors[sensor.name]))
        for number, sensor in enumerate(context.rig)
    )
    return f'<h3>Sensor views</h3><p>{FIGURE_SIZES}</p><div class="views">{views}</div>'


def _view(context: ReportContext, number: int, sensor: pe.Sensor, color: str) -> str:
    head = (
        f'<h3><span class="swatch" style="background:{color}"></span> {number + 1} '
        f"{escaped(sensor.name)} <small>{escaped(sensor.model.name)}</small></h3>"
    )
    seen = sensor_view(sensor.kind).figure(sensor, context.display_vehicle[0])
    return f'<div class="view">{head}{seen}</div>'
