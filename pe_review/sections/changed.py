"""What differs between studies: a row for each sensor and each place it has, aligned."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..engine import catalog, pe
from ..figures import change, count, joined, number
from ..markup import Markup, escaped, table
from ..prices import currency_of, money, price_of
from ..reviewed import Reviewed

HEADS = (
    *("Sensor", "Study", "Model", "Price", "x [m]", "y [m]", "z [m]"),
    *("Roll [°]", "Pitch [°]", "Yaw [°]"),
)
LEAST_M, LEAST_DEG = 0.0005, 0.005
"""Smaller differences are those of rounding, and do not show in the digits below."""
METRE_DIGITS, DEGREE_DIGITS = 3, 2
NAMED = 6
"""So many sensors that differ are named above the table."""


@dataclass(frozen=True, slots=True)
class MountedAs:
    """One way in which a sensor is mounted: the model, and figures as the table shows them.

    `values` are the model's own, its fusion group and AP curve, to compare with others.
    """

    model: str
    values: str
    price: float | None
    position: tuple[float, ...]
    rotation: tuple[float, ...]


def changed(each: Sequence[Reviewed]) -> str:
    """Return the sensors of all studies in one table, differences to the first study marked."""
    names = list(dict.fromkeys(sensor.name for one in each for sensor in one.rig))
    ways = {name: _ways(each, name) for name in names}
    differing = [name for name in names if len(ways[name]) > 1]
    found = [row for name in names for row in _rows(each, name, ways[name])]
    heads, rows = _without_empty(HEADS, found)
    note = (
        "Where a figure differs from that of the study in the sensor's first row, it is bold and "
        "the difference stands in brackets. Ground frame: x is forward, y left, z up; positive "
        "pitch is nose down; the origin is on the ground under the vehicle's middle."
    )
    return (
        f"<h3>What differs</h3><p>{_words(names, differing)}</p>"
        f"{table('Sensors of all studies', heads, rows, css='aligned')}"
        f'<p class="note">{note}{_prices_note(each)}</p>'
    )


def _without_empty(
    heads: Sequence[str], rows: Sequence[Sequence[str | Markup]]
) -> tuple[Sequence[str], list[Sequence[str | Markup]]]:
    """Leave the column of prices out where no study gives any."""
    price = heads.index("Price")
    if any(row[price] for row in rows):
        return heads, list(rows)
    return _but(heads, price), [_but(row, price) for row in rows]


def _but(row: Sequence[str | Markup], place: int) -> list[str | Markup]:
    return [*row[:place], *row[place + 1 :]]


def _words(names: Sequence[str], differing: Sequence[str]) -> str:
    if not differing:
        return "All sensors are the same models at the same places."
    each = [f"<b>{escaped(name)}</b>" for name in differing[:NAMED]]
    more = len(differing) - NAMED
    named = joined(each) if more <= 0 else f"{', '.join(each)} and {more} more"
    if len(names) == 1:
        return f"The one sensor differs: {named}."
    whole = "All" if len(differing) == len(names) else f"Of {count(len(names), 'sensor')}"
    return f"{whole} {len(differing)} differ: {named}."


def _ways(each: Sequence[Reviewed], name: str) -> dict[MountedAs | None, list[Reviewed]]:
    """Return in how many ways a sensor is mounted, and in which studies; None: not at all."""
    found: dict[MountedAs | None, list[Reviewed]] = {}
    for one in each:
        sensor = next((s for s in one.rig if s.name == name), None)
        found.setdefault(None if sensor is None else _way(one.found, sensor), []).append(one)
    return found


def _way(study: pe.Study, sensor: pe.Sensor) -> MountedAs:
    position = tuple(round(v, METRE_DIGITS) + 0.0 for v in sensor.pose.position)
    rotation = tuple(round(v, DEGREE_DIGITS) + 0.0 for v in sensor.pose.rotation_deg)
    values = repr((catalog.to_table(sensor.model), sensor.fusion, sensor.curve))
    return MountedAs(sensor.model.name, values, price_of(study, sensor), position, rotation)


def _rows(
    each: Sequence[Reviewed], name: str, ways: dict[MountedAs | None, list[Reviewed]]
) -> Iterator[list[str | Markup]]:
    """Yield a row for each way in which a sensor is mounted."""
    first = next(way for way in ways if way is not None)
    for row, (way, those) in enumerate(ways.items()):
        head = name if not row else Markup(f'<span class="hidden">{escaped(name)}</span>')
        where = _studies(those) if len(those) < len(each) else "all"
        if way is None:
            yield [head, where, Markup("<b>not there</b>"), *[""] * (len(HEADS) - 3)]
        else:
            yield [head, where, *_figures(way, first, currency_of(those[0].found))]


def _figures(way: MountedAs, first: MountedAs, currency: str) -> Iterator[str | Markup]:
    other = way.model == first.model and way.values != first.values
    model = f"{way.model} (other values)" if other else way.model
    yield _text(model, other or way.model != first.model)
    yield _text("" if way.price is None else money(way.price, currency), way.price != first.price)
    for value, start in zip(way.position, first.position, strict=True):
        yield _figure(value, value - start, METRE_DIGITS, LEAST_M)
    for value, start in zip(way.rotation, first.rotation, strict=True):
        turned = math.remainder(value - start, 360.0)
        yield _figure(value, turned, DEGREE_DIGITS, LEAST_DEG)


def _text(text: str, differs: bool) -> str | Markup:
    return Markup(f"<b>{escaped(text)}</b>") if differs and text else text


def _figure(value: float, less: float, digits: int, least: float) -> str | Markup:
    if abs(less) < least:
        return number(value, digits)
    moved = f'<small class="moved">({change(less, digits)})</small>'
    return Markup(f"<b>{number(value, digits)}</b> {moved}")


def _studies(those: Sequence[Reviewed]) -> Markup:
    each = (
        f'<span class="whose-{one.key}"><span class="swatch"></span> {escaped(one.name)}</span>'
        for one in those
    )
    return Markup("<br>".join(each))


def _prices_note(each: Sequence[Reviewed]) -> str:
    sensors = [(one.found, sensor) for one in each for sensor in one.rig]
    missing = sum(price_of(study, sensor) is None for study, sensor in sensors)
    if not missing:
        return ""
    if missing == len(sensors):
        return " The studies give no prices."
    return " Where a price is empty, the study gives none."
