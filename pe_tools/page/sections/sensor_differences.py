"""How the sensors of several studies differ: one table, a row for each mounting of a sensor."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import pe_core as pe
from pe_core import catalog
from pe_core.base.errors import plural

from ..markup import Markup, escaped, joined, number, signed, table
from ..report_context import ReportContext
from .bill_of_materials import currency_of, price_of, price_text

HEADS = (
    *("Sensor", "Study", "Model", "Price", "x [m]", "y [m]", "z [m]"),
    *("Roll [°]", "Pitch [°]", "Yaw [°]"),
)
MIN_DIFFERENCE_M, MIN_DIFFERENCE_DEG = 0.0005, 0.005
"""Smaller differences are rounding errors, and do not show in the digits below."""
METRE_DIGITS, DEGREE_DIGITS = 3, 2
MAX_NAMED = 6
"""Sensors that the sentence above the table names."""


@dataclass(frozen=True, slots=True)
class MountedPose:
    """Model and pose of a sensor as the table shows them, rounded.

    `values` holds the model's parameters, its fusion group and AP curve as text, for comparison.
    """

    model: str
    values: str
    price: float | None
    position: tuple[float, ...]
    rotation: tuple[float, ...]


StudiesByPose = dict[MountedPose | None, list[ReportContext]]
"""The studies that mount a sensor in a certain way; None: studies without this sensor."""


def sensor_differences(contexts: Sequence[ReportContext]) -> str:
    """Return the sensors of all studies in one table; differences to the first study are marked."""
    names = list(dict.fromkeys(sensor.name for context in contexts for sensor in context.rig))
    mountings = {name: _mountings(contexts, name) for name in names}
    differing = [name for name in names if len(mountings[name]) > 1]
    all_rows = [row for name in names for row in _sensor_rows(contexts, name, mountings[name])]
    heads, rows = _without_empty_price(HEADS, all_rows)
    note = (
        "Values that differ from the sensor's first row are bold, with the difference in brackets. "
        "Ground frame: x is forward, y left, z up; positive pitch is nose down; the origin is on "
        "the ground under the vehicle's centre."
    )
    return (
        f"<h3>Differences between the rigs</h3><p>{_summary_sentence(names, differing)}</p>"
        f"{table('Sensors of all studies', heads, rows, css='aligned')}"
        f'<p class="note">{note}{_price_note(contexts)}</p>'
    )


def _without_empty_price(
    heads: Sequence[str], rows: Sequence[Sequence[str | Markup]]
) -> tuple[Sequence[str], list[Sequence[str | Markup]]]:
    """Remove the column of prices if no study gives any."""
    price = heads.index("Price")
    if any(row[price] for row in rows):
        return heads, list(rows)
    return _without_column(heads, price), [_without_column(row, price) for row in rows]


def _without_column(row: Sequence[str | Markup], column: int) -> list[str | Markup]:
    return [*row[:column], *row[column + 1 :]]


def _summary_sentence(names: Sequence[str], differing: Sequence[str]) -> str:
    if not differing:
        return "All sensors have the same models and poses."
    listed = [f"<b>{escaped(name)}</b>" for name in differing[:MAX_NAMED]]
    more = len(differing) - MAX_NAMED
    text = joined(listed) if more <= 0 else f"{', '.join(listed)} and {more} more"
    if len(names) == 1:
        return f"The only sensor differs: {text}."
    whole = "All" if len(differing) == len(names) else f"Of {plural(len(names), 'sensor')}"
    return f"{whole} {len(differing)} differ: {text}."


def _mountings(contexts: Sequence[ReportContext], name: str) -> StudiesByPose:
    """Return the different mountings of a sensor, each with its studies."""
    mountings: StudiesByPose = {}
    for context in contexts:
        sensor = next((s for s in context.rig if s.name == name), None)
        mounting = None if sensor is None else _mounting_of(context.study, sensor)
        mountings.setdefault(mounting, []).append(context)
    return mountings


def _mounting_of(study: pe.Study, sensor: pe.Sensor) -> MountedPose:
    position = tuple(round(v, METRE_DIGITS) + 0.0 for v in sensor.pose.position)
    rotation = tuple(round(v, DEGREE_DIGITS) + 0.0 for v in sensor.pose.rotation_deg)
    values = repr((catalog.to_table(sensor.model), sensor.fusion, sensor.curve))
    return MountedPose(sensor.model.name, values, price_of(study, sensor), position, rotation)


def _sensor_rows(
    contexts: Sequence[ReportContext], name: str, mountings: StudiesByPose
) -> Iterator[list[str | Markup]]:
    """Yield a row for each mounting of a sensor."""
    first = next(mounting for mounting in mountings if mounting is not None)
    for row, (mounting, mounted_in) in enumerate(mountings.items()):
        head = name if not row else Markup(f'<span class="hidden">{escaped(name)}</span>')
        where = _study_names(mounted_in) if len(mounted_in) < len(contexts) else "all"
        if mounting is None:
            yield [head, where, Markup("<b>not mounted</b>"), *[""] * (len(HEADS) - 3)]
        else:
            yield [head, where, *_cells(mounting, first, currency_of(mounted_in[0].study))]


def _cells(mounting: MountedPose, first: MountedPose, currency: str) -> Iterator[str | Markup]:
    """Yield model, price, position and rotation, marked where they differ from the first row."""
    same_name = mounting.model == first.model
    modified = same_name and mounting.values != first.values
    model = f"{mounting.model} (other values)" if modified else mounting.model
    yield _text_cell(model, modified or not same_name)
    price = "" if mounting.price is None else price_text(mounting.price, currency)
    yield _text_cell(price, mounting.price != first.price)
    for value, start in zip(mounting.position, first.position, strict=True):
        yield _number_cell(value, value - start, METRE_DIGITS, MIN_DIFFERENCE_M)
    for value, start in zip(mounting.rotation, first.rotation, strict=True):
        turned = math.remainder(value - start, 360.0)
        yield _number_cell(value, turned, DEGREE_DIGITS, MIN_DIFFERENCE_DEG)


def _text_cell(text: str, differs: bool) -> str | Markup:
    return Markup(f"<b>{escaped(text)}</b>") if differs and text else text


def _number_cell(
    value: float, difference: float, digits: int, min_difference: float
) -> str | Markup:
    if abs(difference) < min_difference:
        return number(value, digits)
    moved = f'<small class="moved">({signed(difference, digits)})</small>'
    return Markup(f"<b>{number(value, digits)}</b> {moved}")


def _study_names(contexts: Sequence[ReportContext]) -> Markup:
    swatch = '<span class="swatch"></span>'
    names = (f'<span class="whose-{c.key}">{swatch} {escaped(c.name)}</span>' for c in contexts)
    return Markup("<br>".join(names))


def _price_note(contexts: Sequence[ReportContext]) -> str:
    sensors = [(context.study, sensor) for context in contexts for sensor in context.rig]
    missing = sum(price_of(study, sensor) is None for study, sensor in sensors)
    if not missing:
        return ""
    if missing == len(sensors):
        return " The studies give no prices."
    return " Where a price is empty, the study gives none."
