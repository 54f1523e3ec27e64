"""The comparison of several studies: which rig is better where, as text, tables and maps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import pe_core as pe
from pe_core.scoring import sight

from ... import advice
from ..markup import Markup, capitalized, escaped, number, percent, signed, table
from ..pictures.ground_plan import difference_map
from ..pictures.svg import STYLE, figure, figure_grid
from ..pictures.vehicle_picture import labelled_picture_of
from ..report_context import ReportContext, Section
from .overview import hidden_sensor_lines
from .sensor_differences import sensor_differences

SIDES = {"front": "ahead", "rear": "behind", "left": "left", "right": "right"}
STEP_M = 1.0
"""Cell size of the difference maps."""
DIGITS = {"entropy": 2, "coverage": 1, "ap": 3}
MEASURES = {
    "entropy": "Perception entropy in nats: lower is better",
    "coverage": "Coverage: share of expected objects that is seen, higher is better",
    "ap": "Expected AP: higher is better",
}
"""Measures that have a table of their own, with its caption."""
PAGE_NOTATION = advice.Notation(number, plus_minus="±")
NOT_MOUNTED = "not mounted"
TITLE = "Comparison"
GROUPS = {"rig": "", "zone": "By zone", "class": "By class"}


def comparison(contexts: tuple[ReportContext, ...]) -> Section:
    """Return the comparison of several studies; an empty section for a single one."""
    if len(contexts) < 2:
        return Section("summary", TITLE, "")
    rows = advice.compare({context.key: context.after for context in contexts})
    lines = "".join(f"<li>{line}</li>" for line in _summary_lines(contexts, rows))
    inside = "".join(
        [
            f'<ul class="brief">{lines}</ul>',
            sensor_differences(contexts),
            _pictures(contexts),
            _difference_maps(contexts),
            *(_measure_table(contexts, rows, measure) for measure in MEASURES),
            _voxel_ap_table(contexts),
            _pairwise_table(contexts, rows),
            _blind_ground_table(contexts),
            _contribution_table(contexts),
        ]
    )
    return Section("summary", TITLE, inside, styles=(STYLE,))


def _summary_lines(
    contexts: Sequence[ReportContext], rows: Sequence[advice.ComparedRow]
) -> Iterator[str]:
    """Yield which rig is better overall and where, and what limits the comparison."""
    names = [_study_name(contexts, context.key) for context in contexts]
    yield from advice.ranking(names, rows, PAGE_NOTATION)
    yield from advice.win_words(names, [_escaped_row(row) for row in rows])
    for context in contexts:
        yield from (
            f"{_study_name(contexts, context.key)}: {line}."
            for line in hidden_sensor_lines(context)
        )
    vehicles = {context.study.vehicle_line for context in contexts}
    if len(vehicles) > 1:
        yield "The vehicles differ."
    if note := advice.hardware_note([s.model for s in context.rig] for context in contexts):
        yield escaped(note)
    if note := advice.curve_note(context.study.model for context in contexts):
        yield f"{escaped(note)}."
    if error := max(context.after.stderr for context in contexts):
        yield (
            f"Scores are based on samples, with a standard error up to {error:.4f} nats. ± is the "
            "standard error of a difference, which is smaller where studies share the sample."
        )


def _escaped_row(row: advice.ComparedRow) -> advice.ComparedRow:
    """Return a row with its name escaped for HTML."""
    return replace(row, name=escaped(row.name))


def _study_name(contexts: Sequence[ReportContext], key: str) -> str:
    name = next(escaped(context.name) for context in contexts if context.key == key)
    return f'<span class="whose-{key}"><span class="swatch"></span> <b>{name}</b></span>'


def _pictures(contexts: Sequence[ReportContext]) -> str:
    """Return pictures of the vehicles with their sensors."""
    pictures = [
        f"<div>{_study_name(contexts, context.key)}{_vehicle_picture(context)}</div>"
        for context in contexts
    ]
    return str(figure_grid([Markup(picture) for picture in pictures], 17.0))


def _vehicle_picture(context: ReportContext) -> Markup:
    return labelled_picture_of(context, f"{context.name}: the vehicle with its sensors")


def _difference_maps(contexts: Sequence[ReportContext]) -> str:
    """Return a map for each other study: where the first study is better, and where the other."""
    first, *others = contexts
    maps = [
        figure(_difference_map_of(first, context), _color_caption(contexts, first, context))
        for context in others
    ]
    grid = figure_grid(maps, 30.0)
    narrow = f'<div class="narrow">{grid}</div>' if len(maps) == 1 else grid
    return f"<h3>Maps of the difference</h3>{narrow}"


def _difference_map_of(first: ReportContext, other: ReportContext) -> Markup:
    alt = f"Map of the difference in entropy between {first.name} and {other.name}"
    ends = ("8 nats less here", "8 nats less here")
    return difference_map(_ground_sight(other), _ground_sight(first), first.vehicle, alt, ends)


def _color_caption(
    contexts: Sequence[ReportContext], first: ReportContext, other: ReportContext
) -> Markup:
    """Return the meaning of the map's colours, which are those of the first two studies."""
    blue, orange = _study_name(contexts, first.key), _study_name(contexts, other.key)
    return Markup(f"Blue: {blue} is better there. Orange: {orange} is better there.")


def _ground_sight(context: ReportContext) -> sight.GroundSight:
    return context.cached("ground", lambda: context.sight.ground(context.rig, step=STEP_M))


def _heads(contexts: Sequence[ReportContext], first: str) -> list[str | Markup]:
    return [first, *(Markup(_study_name(contexts, context.key)) for context in contexts)]


def _measure_table(
    contexts: Sequence[ReportContext], rows: Sequence[advice.ComparedRow], measure: str
) -> str:
    body: list[list[str | Markup]] = []
    for group, heading in GROUPS.items():
        inside = [row for row in rows if (row.group, row.measure) == (group, measure)]
        body += [[heading]] if heading and inside else []
        for row in inside:
            name = capitalized(advice.WHERE.get(row.name, row.name)) or "Overall"
            body.append([name, *(_cell(contexts, row, k) for k in range(len(contexts)))])
    return table(MEASURES[measure], _heads(contexts, ""), body) if body else ""


def _voxel_ap_table(contexts: Sequence[ReportContext]) -> str:
    """Return the expected AP by class of studies on voxels; scores on objects have their own."""
    if any(context.study.targets.are_objects for context in contexts):
        return ""
    by_class = [context.cached("ap", partial(_expected_ap, context)) for context in contexts]
    rows = [
        [capitalized(n), *(number(each[n], 3) if n in each else "none" for each in by_class)]
        for n in by_class[0]
    ]
    title = "Expected AP of voxels by class, without traffic: higher is better"
    return table(title, _heads(contexts, ""), rows)


def _expected_ap(context: ReportContext) -> dict[str, float]:
    return context.sight.expected_ap(context.rig)


def _cell(contexts: Sequence[ReportContext], row: advice.ComparedRow, k: int) -> str | Markup:
    value, difference = row.values[k], row.differences[k]
    if value is None:
        return "none"
    text = escaped(_value_text(row.measure, value))
    if row.best[k]:
        best = '<span class="hidden"> best</span>'
        text = f'<span class="wins whose-{contexts[k].key}-ink">{text}{best}</span>'
    if k and difference is not None:
        css = {-1: "better", 1: "worse"}.get(row.sense(k), "noise")
        text += f' <span class="{css}">({escaped(_signed_text(row.measure, difference))})</span>'
    return Markup(text)


def _value_text(measure: str, value: float) -> str:
    return percent(value, 1) if measure == "coverage" else number(value, DIGITS[measure])


def _signed_text(measure: str, value: float) -> str:
    return signed(100.0 * value if measure == "coverage" else value, DIGITS[measure])


def _pairwise_table(contexts: Sequence[ReportContext], rows: Sequence[advice.ComparedRow]) -> str:
    """Return the differences of all pairs, for three studies or more."""
    if len(contexts) < 3:
        return ""
    row = next(row for row in rows if (row.group, row.measure) == ("rig", "entropy"))
    body = [
        [
            Markup(_study_name(contexts, context.key)),
            *(_pairwise_cell(row, i, j) for j in range(len(contexts))),
        ]
        for i, context in enumerate(contexts)
    ]
    title = (
        "Entropy of the row minus entropy of the column, in nats; bold if the difference is clear "
        f"(more than {number(row.factor, 1)} standard errors, corrected for the number of pairs)"
    )
    return table(title, _heads(contexts, ""), body)


def _pairwise_cell(row: advice.ComparedRow, i: int, j: int) -> str | Markup:
    a, b = row.values[i], row.values[j]
    if i == j or a is None or b is None:
        return ""
    error = row.errors[i][j]
    plus_minus = f" ± {number(max(error, 0.01))}" if error else ""
    text = escaped(f"{signed(a - b)}{plus_minus}")
    return Markup(f"<b>{text}</b>") if row.differ(i, j) else Markup(text)


def _blind_ground_table(contexts: Sequence[ReportContext]) -> str:
    """Return how far the ground next to the body is blind, by side."""
    rows = [
        [capitalized(words), *(_blind_extent(context, side) for context in contexts)]
        for side, words in SIDES.items()
    ]
    height = max(context.outlook.blind.height for context in contexts)
    title = f"Extent of blind ground at the body, for objects {height:g} m tall"
    return table(title, _heads(contexts, ""), rows)


def _blind_extent(context: ReportContext, side: str) -> str:
    blind = context.outlook.blind
    end = blind.zone[side]
    if end is None:
        return f"more than {blind.within:g} m"
    return "none" if end == 0.0 else f"{number(sight.shown_end(end), 1)} m"


def _contribution_table(contexts: Sequence[ReportContext]) -> str:
    """Return the contribution of each sensor in each study, in one table."""
    names = list(dict.fromkeys(sensor.name for context in contexts for sensor in context.rig))
    rows: list[list[str]] = []
    for heading, cell in CONTRIBUTIONS.items():
        rows.append([heading])
        for name in names:
            scores = [context.after.per_sensor.get(name) for context in contexts]
            rows.append([name, *(NOT_MOUNTED if s is None else cell(s) for s in scores)])
    return table("Contribution of each sensor", _heads(contexts, ""), rows)


def _occluded_share(score: pe.SensorScore) -> str:
    return percent(score.occluded / score.beams, 1) if score.beams else "not known"


CONTRIBUTIONS: dict[str, Callable[[pe.SensorScore], str]] = {
    "Rise of entropy without the sensor [nats]": lambda score: signed(score.lost),
    "Coverage of the sensor alone": lambda score: percent(score.coverage, 1),
    "Occluded by the vehicle, of its pixels or beams": _occluded_share,
}
"""Rows of the table of contributions, by heading."""
