"""Each sensor: where it sits, what it sees alone, what is lost without it, the view it has."""

from __future__ import annotations

from collections.abc import Iterable

from ..engine import graphics, kinds, pe
from ..figures import change, number, percent
from ..markup import Markup, escaped, table
from ..pictures.all_round import lidar_picture
from ..pictures.marked import range_key
from ..pictures.svg import STYLE, figure, hexadecimal
from ..pictures.through_lens import camera_picture
from ..reviewed import Reviewed
from ..section import Section

PLACE = ("sensor", "model", "x [m]", "y [m]", "z [m]", "roll [°]", "pitch [°]", "yaw [°]")
WORTH = (
    *("sensor", "entropy alone [nats]", "seen alone", "entropy rises without it"),
    *("stopped by the vehicle", "by which part"),
)
PARTS, LEAST = 3, 0.0005
"""Parts of the vehicle that are named, and the least share that one of them stops."""
SIZES = (
    "People are 1.75 m tall, cars 4.5 m long, 1.8 m wide and 1.5 m high; figures and rings are "
    "their distance from the sensor along the ground."
)


def sensors(one: Reviewed) -> Section:
    """Return what there is to know of each sensor; tables of several studies stand in one."""
    tables = f"{places_of(one)}{_worth(one)}" if one.beside == 1 else ""
    inside = f"{tables}{one.once('views', lambda: _views(one))}"
    return Section("sensors", "Each sensor", inside, styles=(STYLE,))


def places_of(one: Reviewed) -> str:
    """Tell where they sit, in the ground frame and from the rear axle."""
    words = (
        "x is forward, y left, z up; positive pitch is nose down. The origin is on the ground "
        "under the vehicle's middle."
    )
    ground = table("Where they sit, ground frame", PLACE, _rows(one.rig, (0.0, 0.0)))
    axle = one.found.reference
    if axle is None:
        note = "The study has no [reference], so nothing is told from the rear axle."
        return f'{ground}<p class="note">{words} {note}</p>'
    origin = axle.rear_axle_x, axle.rear_axle_z
    caption = (
        f"Where they sit, from the middle of the rear axle (x {number(origin[0], 3)} m, "
        f"z {number(origin[1], 3)} m)"
    )
    from_axle = table(caption, PLACE, _rows(one.rig, origin))
    return f'{ground}{from_axle}<p class="note">{words}</p>'


def _rows(rig: pe.Rig, origin: tuple[float, float]) -> Iterable[list[str]]:
    for sensor in rig:
        x, y, z = sensor.pose.position
        place = (x - origin[0], y, z - origin[1])
        angles = (number(angle, 2) for angle in sensor.pose.rotation_deg)
        yield [sensor.name, sensor.model.name, *(number(v, 3) for v in place), *angles]


def _worth(one: Reviewed) -> str:
    """What each is worth, and what the vehicle takes of it."""
    rows = []
    for name, score in one.after.per_sensor.items():
        share = f"{percent(score.stopped / score.beams)}" if score.beams else "not told"
        figures = number(score.entropy), percent(score.coverage), change(score.lost)
        rows.append([name, *figures, share, _by_part(score)])
    note = "Of a camera it is its picture that is hidden, of a LiDAR its beams that are stopped."
    shown = table("What each is worth, and what the vehicle takes of it", WORTH, rows)
    return f'{shown}<p class="note">{note}</p>'


def _by_part(score: pe.SensorScore) -> str:
    """Parts that stop most of it."""
    if not score.stopped:
        return "none"
    shares = {name: count / score.beams for name, count in score.stopped_by.items()}
    told = sorted((name for name in shares if shares[name] >= LEAST), key=lambda n: -shares[n])
    return ", ".join(f"{name} {percent(shares[name])}" for name in told[:PARTS]) or "little"


def _views(one: Reviewed) -> str:
    """The view that each has."""
    shown = "".join(_view(one, place, sensor) for place, sensor in enumerate(one.rig))
    return f'<h3>What they look at</h3><p>{SIZES}</p><div class="views">{shown}</div>'


def _view(one: Reviewed, place: int, sensor: pe.Sensor) -> str:
    color = hexadecimal(graphics.sensor_color_on_paper(place))
    name = escaped(sensor.name)
    head = (
        f'<h3><span class="swatch" style="background:{color}"></span> {place + 1} {name} '
        f"<small>{escaped(sensor.model.name)}</small></h3>"
    )
    return f'<div class="view">{head}{_picture(one, sensor)}</div>'


def _picture(one: Reviewed, sensor: pe.Sensor) -> Markup | str:
    vehicle, model = one.shown_vehicle[0], sensor.model
    if isinstance(model, kinds.Camera):
        alt = f"What {sensor.name} sees: people on the left and cars on the right"
        return figure(camera_picture(sensor, vehicle).svg(alt), _camera_words(model))
    if isinstance(model, kinds.Lidar):
        alt = f"Ranges of {sensor.name} all round: people left of ahead and cars right of it"
        drawing = lidar_picture(sensor, vehicle).svg(alt) + range_key(model.max_range)
        return figure(Markup(drawing), _lidar_words(model))
    return "<p>No picture is drawn of this kind.</p>"


def _camera_words(model: kinds.Camera) -> str:
    lens = model.projection.model.replace("_", " ")
    return f"{model.width} × {model.height} px, {lens} lens, through its own projection."


def _lidar_words(model: kinds.Lidar) -> str:
    least = f"{number(model.min_range, 1)} to " if model.min_range >= 0.1 else ""
    return (
        f"A row a channel ({len(model.elevations)}), a column an azimuth; "
        f"range {least}{model.max_range:g} m."
    )
