"""Several studies side by side: who wins where, in words, figures and colours."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from ..engine import advice, pe, sight
from ..figures import change, number, percent, up_first
from ..markup import Markup, escaped, table
from ..pictures.ground_maps import difference_map
from ..pictures.of_reviewed import named_still_of
from ..pictures.svg import STYLE, figure, grid
from ..reviewed import Reviewed
from ..section import Section
from .changed import changed
from .head import hidden

SIDES = {"front": "ahead", "rear": "behind", "left": "left", "right": "right"}
STEP_M = 1.0
"""Of the maps."""
DIGITS = {"entropy": 2, "coverage": 1, "ap": 3}
ON_PAGE = advice.Notation(number, percent, "±")
GROUPS = {"rig": "", "zone": "By zone", "class": "By class"}


def versus(each: tuple[Reviewed, ...]) -> Section:
    """Return the comparison; nothing of a single study."""
    if len(each) < 2:
        return Section("summary", "Who wins where", "")
    rows = advice.compare({one.key: one.after for one in each})
    inside = "".join(
        [
            f'<ul class="brief">{"".join(f"<li>{line}</li>" for line in _brief(each, rows))}</ul>',
            changed(each),
            _pictures(each),
            _difference_maps(each),
            _table(each, rows, "entropy", "Perception entropy in nats: lower is better"),
            _table(each, rows, "coverage", "Seen of where objects are: higher is better"),
            _table(each, rows, "ap", "Expected AP: higher is better"),
            _pairs(each, rows),
            _blind(each),
            _worth(each),
        ]
    )
    return Section("summary", "Who wins where", inside, styles=(STYLE,))


def _brief(each: Sequence[Reviewed], rows: Sequence[advice.ComparedRow]) -> Iterator[str]:
    """Yield which is better overall, which is better where, and what is not alike."""
    names = [_named(each, one.key) for one in each]
    yield from advice.ranking(names, rows, ON_PAGE)
    yield from advice.win_words(names, [_escaped(row) for row in rows])
    for one in each:
        yield from (f"{_named(each, one.key)}: {line}." for line in hidden(one))
    vehicles = {one.found.vehicle_line for one in each}
    if len(vehicles) > 1:
        yield "Their vehicles differ."
    if error := max(one.after.stderr for one in each):
        yield (
            f"They are scored on samples: standard error up to {error:.4f} nats; ± is the standard "
            "error of a difference, smaller where studies share the sample."
        )


def _escaped(row: advice.ComparedRow) -> advice.ComparedRow:
    """Return a row whose name may stand in HTML."""
    return replace(row, name=escaped(row.name))


def _named(each: Sequence[Reviewed], key: str) -> str:
    one = next(one for one in each if one.key == key)
    return (
        f'<span class="whose-{key}"><span class="swatch"></span> <b>{escaped(one.name)}</b></span>'
    )


def _pictures(each: Sequence[Reviewed]) -> str:
    """The vehicles with their sensors."""
    drawn = [f"<div>{_named(each, one.key)}{_still(one)}</div>" for one in each]
    return str(grid([Markup(each) for each in drawn], 17.0))


def _still(one: Reviewed) -> Markup:
    return named_still_of(one, f"{one.name}: the vehicle with its sensors")


def _difference_maps(each: Sequence[Reviewed]) -> str:
    """Maps of where the first is better than each of the others, in the colours of two studies."""
    first, *others = each
    drawn = [figure(_difference(first, one), _colors(each, first, one)) for one in others]
    shown = grid(drawn, 30.0)
    narrow = f'<div class="narrow">{shown}</div>' if len(drawn) == 1 else shown
    return f"<h3>Where they differ</h3>{narrow}"


def _difference(first: Reviewed, other: Reviewed) -> Markup:
    alt = f"Map of the difference in entropy between {first.name} and {other.name}"
    ends = ("8 nats less here", "8 nats less here")
    return difference_map(_ground(other), _ground(first), first.vehicle, alt, ends)


def _colors(each: Sequence[Reviewed], first: Reviewed, other: Reviewed) -> Markup:
    """Say what the map's colours mean; those of the first two studies are the map's own."""
    blue, orange = _named(each, first.key), _named(each, other.key)
    return Markup(f"Blue: {blue} is better there. Orange: {orange} is better there.")


def _ground(one: Reviewed) -> sight.GroundSight:
    return one.once("ground", lambda: one.sight.ground(one.rig, step=STEP_M))


def _heads(each: Sequence[Reviewed], first: str) -> list[str | Markup]:
    return [first, *(Markup(_named(each, one.key)) for one in each)]


def _table(
    each: Sequence[Reviewed], rows: Sequence[advice.ComparedRow], measure: str, title: str
) -> str:
    body: list[list[str | Markup]] = []
    for group, heading in GROUPS.items():
        inside = [row for row in rows if (row.group, row.measure) == (group, measure)]
        body += [[heading]] if heading and inside else []
        for row in inside:
            name = up_first(advice.WHERE.get(row.name, row.name)) or "Overall"
            body.append([name, *(_cell(each, row, k) for k in range(len(each)))])
    return table(title, _heads(each, ""), body) if body else ""


def _cell(each: Sequence[Reviewed], row: advice.ComparedRow, k: int) -> str | Markup:
    value, less = row.values[k], row.differences[k]
    if value is None:
        return "none"
    text = _figure(row.measure, value)
    if k and less is not None:
        text = f"{text} ({_change(row.measure, less)})"
    if not row.best[k]:
        return text
    best = '<span class="hidden"> best</span>'
    return Markup(f'<span class="wins whose-{each[k].key}-ink">{escaped(text)}{best}</span>')


def _figure(measure: str, value: float) -> str:
    return percent(value) if measure == "coverage" else number(value, DIGITS[measure])


def _change(measure: str, value: float) -> str:
    return change(100.0 * value if measure == "coverage" else value, DIGITS[measure])


def _pairs(each: Sequence[Reviewed], rows: Sequence[advice.ComparedRow]) -> str:
    """Differences of all pairs, of three studies and more."""
    if len(each) < 3:
        return ""
    row = next(row for row in rows if (row.group, row.measure) == ("rig", "entropy"))
    body = [
        [Markup(_named(each, one.key)), *(_pair(row, i, j) for j in range(len(each)))]
        for i, one in enumerate(each)
    ]
    title = (
        "Entropy of the row less that of the column, in nats; bold where the difference is clear "
        f"(more than {number(row.factor, 1)} standard errors, so that all pairs hold together)"
    )
    return table(title, _heads(each, ""), body)


def _pair(row: advice.ComparedRow, i: int, j: int) -> str | Markup:
    a, b = row.values[i], row.values[j]
    if i == j or a is None or b is None:
        return ""
    error = row.errors[i][j]
    told = f" ± {number(max(error, 0.01))}" if error else ""
    text = escaped(f"{change(a - b)}{told}")
    return Markup(f"<b>{text}</b>") if row.differ(i, j) else Markup(text)


def _blind(each: Sequence[Reviewed]) -> str:
    """How far what is half a metre tall is hidden from the body on."""
    rows = [[up_first(words), *(_end(one, side) for one in each)] for side, words in SIDES.items()]
    height = max(one.outlook.blind.height for one in each)
    title = f"Blind ground at the body, for what is {height:g} m tall: how far it reaches"
    return table(title, _heads(each, ""), rows)


def _end(one: Reviewed, side: str) -> str:
    blind = one.outlook.blind
    end = blind.zone[side]
    if end is None:
        return f"more than {blind.within:g} m"
    return "none" if end == 0.0 else f"{number(sight.shown_end(end), 1)} m"


def _worth(each: Sequence[Reviewed]) -> str:
    """Return what each sensor of each study is worth, in one table."""
    names = list(dict.fromkeys(sensor.name for one in each for sensor in one.rig))
    rows: list[list[str]] = []
    for heading, cell in WORTH.items():
        rows.append([heading])
        for name in names:
            own = [one.after.per_sensor.get(name) for one in each]
            rows.append([name, *("not there" if s is None else cell(s) for s in own)])
    return table(
        "What each sensor is worth, and what the vehicle takes of it", _heads(each, ""), rows
    )


def _hidden_share(own: pe.SensorScore) -> str:
    return percent(own.stopped / own.beams) if own.beams else "not counted"


WORTH: dict[str, Callable[[pe.SensorScore], str]] = {
    "Entropy rises without it [nats]": lambda own: change(own.lost),
    "Seen by it alone, of where objects are": lambda own: percent(own.coverage),
    "Hidden by the vehicle, of its picture or beams": _hidden_share,
}
