"""Several studies side by side: who wins where, in words, figures and colours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..engine import advice, sight
from ..figures import change, joined, number, percent, up_first
from ..markup import Markup, escaped, table
from ..pictures.ground_maps import difference_map
from ..pictures.of_reviewed import named_still_of
from ..pictures.svg import STYLE, figure, grid
from ..reviewed import Reviewed
from ..section import Section
from ..winning import CloseRow, close_rows, leads

SIDES = {"front": "ahead", "rear": "behind", "left": "left", "right": "right"}
STEP_M = 1.0
"""Of the maps."""
GROUPS = {"rig": "", "zone": "By zone", "class": "By class"}


def versus(each: tuple[Reviewed, ...]) -> Section:
    """Return the comparison; nothing of a single study."""
    if len(each) < 2:
        return Section("summary", "Who wins where", "")
    rows = close_rows({one.key: one.after for one in each})
    inside = "".join(
        [
            f'<ul class="brief">{"".join(f"<li>{line}</li>" for line in _brief(each, rows))}</ul>',
            _pictures(each),
            _difference_maps(each),
            _table(each, rows, "entropy", "Perception entropy in nats: lower is better"),
            _table(each, rows, "coverage", "Seen of where objects are: higher is better"),
            _blind(each),
            _losses(each),
        ]
    )
    return Section("summary", "Who wins where", inside, styles=(STYLE,))


def _brief(each: Sequence[Reviewed], rows: Sequence[CloseRow]) -> Iterator[str]:
    """Yield who wins overall, who wins where, and what is not alike."""
    yield _overall(each, rows)
    for one, where in leads([one.key for one in each], rows).items():
        if where:
            yield f"{_named(each, one)} is better {joined([escaped(place) for place in where])}."
    vehicles = {one.found.vehicle_line for one in each}
    if len(vehicles) > 1:
        yield "Their vehicles differ."
    if error := max(one.after.stderr for one in each):
        yield f"They are scored on samples: standard error up to {error:.4f} nats."


def _overall(each: Sequence[Reviewed], rows: Sequence[CloseRow]) -> str:
    row = next(row for row in rows if row.group == "rig" and row.measure == "entropy")
    if row.winner is None:
        return f"Overall they are alike, at {number(row.values[0] or 0.0)} nats."
    others = sorted(v for k, v in enumerate(row.values) if k != row.winner and v is not None)
    best = row.values[row.winner] or 0.0
    name = _named(each, each[row.winner].key)
    next_one = f"the next has {number(others[0])}"
    return f"Overall {name} is better: {number(best)} nats, lower is better; {next_one}."


def _named(each: Sequence[Reviewed], key: str) -> str:
    one = next(one for one in each if one.key == key)
    return (
        f'<span class="whose-{key}"><span class="swatch"></span> <b>{escaped(one.name)}</b></span>'
    )


def _pictures(each: Sequence[Reviewed]) -> str:
    """The vehicles with their sensors."""
    drawn = [f"<div>{_named(each, one.key)}{_still(one)}</div>" for one in each]
    return f'<div class="maps">{"".join(drawn)}</div>'


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


def _table(each: Sequence[Reviewed], rows: Sequence[CloseRow], measure: str, title: str) -> str:
    body: list[list[str | Markup]] = []
    for group, heading in GROUPS.items():
        inside = [row for row in rows if (row.group, row.measure) == (group, measure)]
        body += [[heading]] if heading and inside else []
        for row in inside:
            name = up_first(advice.WHERE.get(row.name, row.name)) or "Overall"
            body.append([name, *(_cell(each, row, k) for k in range(len(each)))])
    return table(title, _heads(each, ""), body)


def _cell(each: Sequence[Reviewed], row: CloseRow, k: int) -> str | Markup:
    value, first = row.values[k], row.values[0]
    if value is None:
        return "none"
    entropy = row.measure == "entropy"
    text = number(value) if entropy else percent(value)
    if k and first is not None:
        less = change(value - first) if entropy else change(100.0 * (value - first), 1)
        text = f"{text} ({less})"
    if k != row.winner:
        return text
    best = '<span class="hidden"> best</span>'
    return Markup(f'<span class="wins whose-{each[k].key}-ink">{escaped(text)}{best}</span>')


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


def _losses(each: Sequence[Reviewed]) -> str:
    """What the loss of one sensor costs, of every study."""
    rows = [
        ["Worst loss", *(_loss(one, max) for one in each)],
        ["Least loss", *(_loss(one, min) for one in each)],
    ]
    return table("When one sensor fails: rise of entropy in nats", _heads(each, ""), rows)


def _loss(one: Reviewed, which: object) -> str:
    scores = one.after.per_sensor
    pick = max if which is max else min
    name = pick(scores, key=lambda name: scores[name].lost)
    return f"{change(scores[name].lost)} ({name})"
