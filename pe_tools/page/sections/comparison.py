"""Several studies side by side: which rig is better where, how the sensors differ, what they cost.
Prices come from the study's choices (``[[selection.choice]]``); the catalogue has none."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import pe_core as pe
from pe_core import catalog
from pe_core.base.values import error_text
from pe_core.search import FIGURES

from ... import advice
from ...templating import Markup
from ..markup import escaped, macros
from ..pictures.ground_plan import difference_map
from ..pictures.vehicle_picture import labelled_picture
from ..report_context import ReportContext
from .score import hidden_sensor_lines

SIDES = {"front": "ahead", "rear": "behind", "left": "left", "right": "right"}
METRE_DIGITS = 3
DEGREE_DIGITS = 2
MAP_ENDS = ("8 nats less here", "8 nats less here")


def price_of(study: pe.Study, sensor: pe.Sensor) -> float | None:
    """Return the price of a sensor in the study's currency; None if the study gives none. A choice
    that names the sensor has precedence over other choices that offer its model."""
    choices = study.selection.choices
    naming = [choice for choice in choices if sensor.name in (choice.sensors or ())]
    for choice in (*naming, *choices):
        for option in choice.options:
            if option.model.name == sensor.model.name:
                return option.price
    return None


def comparison(contexts: tuple[ReportContext, ...]) -> dict[str, Any] | None:
    """Return the comparison of several studies; None for a single one."""
    if len(contexts) < 2:
        return None
    first, *others = contexts
    rows = advice.compare({context.key: context.after for context in contexts})
    known = [(c, c.outcome.figures_after) for c in contexts]
    if all(figures is not None for _, figures in known):
        told = {context.key: context.study.key_figures(own) for context, own in known}
        rows = (*rows, *advice.compare_figures(told))
    return {
        "names": [macros().bold_study(context) for context in contexts],
        "rows": rows,
        "measures": FIGURES,
        "overall": next(row for row in rows if (row.group, row.measure) == ("rig", "entropy")),
        "lines": [Markup(line) for line in _summary_lines(contexts, rows)],
        **sensor_differences(contexts),
        "pictures": [
            labelled_picture(context, f"{context.name}: the vehicle with its sensors")
            for context in contexts
        ],
        "maps": [
            difference_map(
                other.ground,
                first.ground,
                first.vehicle,
                f"Map of the difference in entropy between {first.name} and {other.name}",
                ends=MAP_ENDS,
            )
            for other in others
        ],
        "blind": [context.outlook.blind for context in contexts],
        "sides": SIDES,
    }


def _summary_lines(
    contexts: Sequence[ReportContext], rows: Sequence[advice.ComparedRow]
) -> Iterator[str]:
    """Yield, as HTML, which rig is better overall and where, and what limits the comparison."""
    names = [macros().bold_study(context) for context in contexts]
    if apart := advice.disagreement(names, rows):
        yield apart
    yield from (line.replace(" +- ", " ± ") for line in advice.ranking(names, rows))
    worth = advice.worth_rows(
        contexts[0].study,
        [context.rig for context in contexts],
        one_vehicle=len({context.study.vehicle_line for context in contexts}) == 1,
    )
    yield from advice.worth_lines(names, rows, worth)
    for name, context in zip(names, contexts, strict=True):
        yield from (f"{name}: {line}." for line in hidden_sensor_lines(context))
    if len({context.study.vehicle_line for context in contexts}) > 1:
        yield "The vehicles differ."
    if note := advice.hardware_note([s.model for s in context.rig] for context in contexts):
        yield escaped(note)
    if note := advice.curve_note(context.study for context in contexts):
        yield f"{escaped(note)}."
    if error := max(context.after.stderr for context in contexts):
        yield (
            "Scores are based on samples, with a standard error up to "
            f"{error_text(error)} nats. ± is the standard error of a difference, which is "
            "smaller where studies share the sample."
        )


def sensor_differences(contexts: Sequence[ReportContext]) -> dict[str, Any]:
    """Return the mountings of each sensor, and how they differ from its first one."""
    names = dict.fromkeys(sensor.name for context in contexts for sensor in context.rig)
    sensors = {name: _mountings(contexts, name) for name in names}
    prices = [price_of(context.study, sensor) for context in contexts for sensor in context.rig]
    return {
        "sensors": sensors,
        "differing": [name for name, mountings in sensors.items() if len(mountings) > 1],
        "has_prices": any(price is not None for price in prices),
        "lacks_prices": any(price is None for price in prices),
        "turn": lambda a, b: math.remainder(a - b, 360.0),
    }


class SensorMounting(NamedTuple):
    """Model and pose of a sensor as the table shows them, rounded. `values` holds the model's
    parameters, its fusion group and AP curve as text, for comparison."""

    model: str
    values: str
    price: float | None
    position: tuple[float, ...]
    rotation: tuple[float, ...]


def _mountings(
    contexts: Sequence[ReportContext], name: str
) -> dict[SensorMounting | None, list[ReportContext]]:
    """Return the studies of each different mounting of a sensor; None: those without it."""
    by_mounting: dict[SensorMounting | None, list[ReportContext]] = {}
    for context in contexts:
        sensor = next((s for s in context.rig if s.name == name), None)
        mounting = None
        if sensor is not None:
            position = tuple(round(v, METRE_DIGITS) + 0.0 for v in sensor.pose.position)
            rotation = tuple(round(v, DEGREE_DIGITS) + 0.0 for v in sensor.pose.rotation_deg)
            values = repr((catalog.to_table(sensor.model), sensor.fusion, sensor.curve))
            price = price_of(context.study, sensor)
            mounting = SensorMounting(sensor.model.name, values, price, position, rotation=rotation)
        by_mounting.setdefault(mounting, []).append(context)
    return by_mounting
